"""Sections 5 and 8 of docs/compact-stream.md: a level, with its half-edges and slots, and the sectors of its records."""

from compact_coding import ZERO, add, cross, must, sub, unit

NONE = -1

# Half-edges, section 1.


def face_of(h):
    return h // 3


def next_of(h):
    return h - 2 if h % 3 == 2 else h + 1


def prev_of(h):
    return h + 2 if h % 3 == 0 else h - 1


class Level:
    """Vertices, wedges and faces; lists by their numbers."""

    def __init__(self, group_count):
        self.positions = []  # of vertices: whole numbers
        self.first_wedge = []
        self.wedge_counts = []
        self.wedge_vertex = []
        self.corner_vertex = []  # of corners, three a face
        self.corner_wedge = []
        self.twins = []
        self.groups = []  # of faces
        self.made = []
        self.slots = []
        self.group_sizes = [0] * group_count
        self.limits = (0, 0, 0)  # vertices, wedges, faces of the level that the chunk leads to

    vertex_count = property(lambda self: len(self.positions))
    wedge_count = property(lambda self: len(self.wedge_vertex))
    face_count = property(lambda self: len(self.groups))

    @property
    def size(self):
        return self.face_count + self.vertex_count + self.wedge_count + len(self.group_sizes) + 1

    def add_vertex(self, position=ZERO):
        must(self.vertex_count < self.limits[0], "it has more vertices than its header says")
        self.positions.append(position)
        self.first_wedge.append(self.wedge_count)
        self.wedge_counts.append(0)
        return self.vertex_count - 1

    def add_wedge(self, v):
        must(self.wedge_count < self.limits[1], "it has more wedges than its header says")
        if self.wedge_counts[v] == 0:
            self.first_wedge[v] = self.wedge_count
        self.wedge_counts[v] += 1
        self.wedge_vertex.append(v)
        return self.wedge_count - 1

    def wedges_of(self, v):
        return range(self.first_wedge[v], self.first_wedge[v] + self.wedge_counts[v])

    def add_face(self):
        """A face that has nothing yet: its number."""
        must(self.face_count < self.limits[2], "it has more faces than its header says")
        self.corner_vertex += [NONE] * 3
        self.corner_wedge += [NONE] * 3
        self.twins += [NONE] * 3
        self.groups.append(0)
        self.made.append(0)
        self.slots.append(NONE)
        return self.face_count - 1

    def write_face(self, f, vertices, wedges, group, made):
        self.corner_vertex[3 * f : 3 * f + 3] = vertices
        self.corner_wedge[3 * f : 3 * f + 3] = wedges
        self.twins[3 * f : 3 * f + 3] = [NONE] * 3
        self.groups[f] = group
        self.made[f] = made

    def append_slot(self, f):
        group = self.groups[f]
        self.slots[f] = self.group_sizes[group]
        self.group_sizes[group] += 1

    # Half-edges.

    def begin(self, h):  # `from`, which Python has for itself
        return self.corner_vertex[h]

    def to(self, h):
        return self.corner_vertex[next_of(h)]

    def apex(self, h):
        return self.corner_vertex[prev_of(h)]

    def beyond(self, h):
        """The face beyond, or NONE."""
        t = self.twins[h]
        return NONE if t == NONE else t // 3

    def link(self, h, t):
        self.twins[h] = t
        if t != NONE:
            self.twins[t] = h

    def fits(self, h, other):
        wedges = self.corner_wedge
        return (
            wedges[h] == wedges[next_of(other)]
            and wedges[next_of(h)] == wedges[other]
            and self.groups[face_of(h)] == self.groups[face_of(other)]
        )

    def seam(self, h):
        t = self.twins[h]
        return t != NONE and not self.fits(h, t)

    def join(self, halves):
        """Makes twins of half-edges that have none."""
        edges = {}
        for h in sorted(halves):
            a, b = self.begin(h), self.to(h)
            edges.setdefault((min(a, b), max(a, b)), []).append(h)
        for (a, b), members in edges.items():
            if a != b and 2 <= len(members) <= 16:
                self._join_edge([h for h in members if self.begin(h) == a], [h for h in members if self.begin(h) == b])

    def _join_edge(self, forth, back):
        twins = self.twins
        for h in forth:
            for t in back:
                if twins[h] == NONE and twins[t] == NONE and face_of(h) != face_of(t) and self.fits(h, t):
                    self.link(h, t)
        forth = [h for h in forth if twins[h] == NONE]
        back = [h for h in back if twins[h] == NONE]
        if len(forth) == 1 and len(back) == 1 and face_of(forth[0]) != face_of(back[0]):
            self.link(forth[0], back[0])

    # Geometry.

    def face_normal(self, f):
        """(p1 - p0) x (p2 - p0)."""
        p = [self.positions[v] for v in self.corner_vertex[3 * f : 3 * f + 3]]
        return cross(sub(p[1], p[0]), sub(p[2], p[0]))

    def normals(self, of_corner, count):
        """Section 9.1; `of_corner` is corner_vertex or corner_wedge."""
        sums = [ZERO] * count
        for f in range(self.face_count):
            normal = self.face_normal(f)
            for item in of_corner[3 * f : 3 * f + 3]:
                sums[item] = add(sums[item], normal)
        return [unit(s) for s in sums]

    def vertex_normals(self):
        return self.normals(self.corner_vertex, self.vertex_count)

    def wedge_normals(self):
        return self.normals(self.corner_wedge, self.wedge_count)


class Place:
    """An ear or a patch, and the star that takes its place."""

    def __init__(self, halves, closed=False, ear=False, faces=()):
        self.halves = halves  # an ear's border half-edge; a patch's polygon
        self.closed = closed
        self.ear = ear
        self.patch = list(faces)  # numbers, in the order in which they joined
        self.vertex = NONE
        self.joined = False  # to another place, whose vertex it has
        self.star = []
        self.coarse = []  # what the patch's faces were


class CoarseFace:
    """What a face was before a record."""

    def __init__(self, level, f):
        self.vertices = level.corner_vertex[3 * f : 3 * f + 3]
        self.wedges = level.corner_wedge[3 * f : 3 * f + 3]
        self.group = level.groups[f]
        self.slot = level.slots[f]


def write_star(level, place, made):
    """Section 7.2: the faces of a place around its vertex, without wedges there."""
    v = place.vertex
    if place.ear:
        (h,) = place.halves
        star = level.add_face()
        wedges = level.corner_wedge
        corners = [NONE, wedges[next_of(h)], wedges[h]]
        level.write_face(star, [v, level.to(h), level.begin(h)], corners, level.groups[face_of(h)], made)
        level.link(3 * star + 1, h)
        place.star = [star]
        return
    place.coarse = [CoarseFace(level, f) for f in place.patch]
    wedges, twins = level.corner_wedge, level.twins
    outer = [
        (level.begin(h), level.to(h), wedges[h], wedges[next_of(h)], level.groups[face_of(h)], twins[h]) for h in place.halves
    ]
    missing = len(outer) - len(place.patch)
    place.star = (place.patch + [level.add_face() for _ in range(missing)])[: len(outer)]
    moved = {h: 3 * f + 1 for h, f in zip(place.halves, place.star)}
    for f, (a, b, wedge_a, wedge_b, group, _) in zip(place.star, outer):
        level.write_face(f, [v, a, b], [NONE, wedge_a, wedge_b], group, made)
    for f, (*_, twin) in zip(place.star, outer):
        level.link(3 * f + 1, moved.get(twin, twin))
    for f, after in zip(place.star, place.star[1:]):
        level.link(3 * f + 2, 3 * after)
    if place.closed:
        level.link(3 * place.star[-1] + 2, 3 * place.star[0])


OPEN, CLOSED, MOVED, LONE = range(4)


class Sector:
    """Fine faces (their numbers), the coarse faces whose slots they take, and how many corners the polygon has."""

    def __init__(self, fine, coarse, corners):
        self.fine, self.coarse, self.corners = fine, coarse, corners


class Sectors:
    """Section 8.1: the sectors of a place's star."""

    def __init__(self, level, place):
        star = place.star
        self.star, self.closed = star, place.closed
        self.count = len(star)
        self.ring_size = self.count if place.closed else self.count + 1
        must(self.ring_size <= 256, "a star's ring has more than 256 corners")
        self.groups = [level.groups[f] for f in star]
        self.centres = [level.corner_wedge[3 * f] for f in star]
        self.a = [level.corner_wedge[3 * f + 1] for f in star]
        self.b = [level.corner_wedge[3 * f + 2] for f in star]
        ring = [level.corner_vertex[3 * f + 1] for f in star]
        if not place.closed:
            ring.append(level.corner_vertex[3 * star[-1] + 2])
        places = {}
        for i, v in enumerate(ring):
            places.setdefault(v, i)
        self.coarse = place.coarse
        self.coarse_places = [[places[v] for v in face.vertices] for face in place.coarse]
        self.taken = [False] * len(place.coarse)
        self.found = []

    def cut(self, i):
        """Whether spoke i, between faces i - 1 and i, is cut."""
        same = self.centres[i - 1] == self.centres[i] and self.groups[i - 1] == self.groups[i] and self.b[i - 1] == self.a[i]
        return not same

    def find(self):
        cuts = [i for i in range(0 if self.closed else 1, self.count) if self.cut(i)]
        if self.closed and not cuts:
            self._closed()
        else:
            starts = cuts if self.closed else [0] + cuts
            ends = starts[1:] + [starts[0] + self.count if self.closed else self.count]
            runs = [(s, end - s) for s, end in zip(starts, ends)]
            for run in [r for r in runs if r[1] > 1] + [r for r in runs if r[1] == 1]:
                self._sectors_of(run)
        must(all(self.taken), "a face of a patch is in no sector")
        return self.found

    def _closed(self):
        must(len(self.coarse) == self.ring_size - 2, "a closed sector has not as many coarse faces as it needs")
        self._take(range(self.count), range(len(self.coarse)), self.ring_size, lambda place: place, self.a, self.groups[0])

    def _sectors_of(self, run):
        s, m = run
        if m < self.ring_size:
            if m > 1 and self._open(run):
                return self._take_open(run)
            if self._moves(run):
                return self._take_moved(run)
            if m == 1:
                return self._take_open(run)
        for c in range(1, m):
            parts = (s, c), ((s + c) % self.count, m - c)
            if all(map(self._open, parts)):
                return [self._take_open(part) for part in parts]
        must(False, "a star falls into no sectors")

    def _number(self, run, place):
        number = (place - run[0]) % self.ring_size
        return number if number <= run[1] else None

    def _wedges(self, run):
        s, m = run
        return [self.a[(s + j) % self.count] for j in range(m)] + [self.b[(s + m - 1) % self.count]]

    def _numbers(self, run, i):
        return [self._number(run, place) for place in self.coarse_places[i]]

    def _fits(self, run, i):
        face, wedges = self.coarse[i], self._wedges(run)
        return face.group == self.groups[run[0]] and all(
            number is None or wedges[number] == wedge for number, wedge in zip(self._numbers(run, i), face.wedges)
        )

    def _lying(self, run):
        return [i for i in range(len(self.coarse)) if None not in self._numbers(run, i)]

    def _open(self, run):
        return sum(self._fits(run, i) for i in self._lying(run)) == run[1] - 1

    def _moving(self, run):
        found = []
        for i in range(len(self.coarse)):
            numbers = [n for n in self._numbers(run, i) if n is not None]
            if not self.taken[i] and len(numbers) == 2 and abs(numbers[0] - numbers[1]) == 1 and self._fits(run, i):
                found.append(i)
        return found

    def _moves(self, run):
        return len(self._moving(run)) == run[1]

    def _take_open(self, run):
        s, m = run
        faces = [(s + j) % self.count for j in range(m)]
        self._take(faces, self._lying(run), m + 1, lambda place: self._number(run, place), self._wedges(run), self.groups[s])

    def _take_moved(self, run):
        s, m = run
        coarse = self._moving(run)
        lone = [next(j for j, n in enumerate(self._numbers(run, i)) if n is None) for i in coarse]
        places = {self.coarse_places[i][j] for i, j in zip(coarse, lone)}
        must(len(places) == 1, "the faces of a moved sector part from different vertices")

        def number(place):
            of_run = self._number(run, place)
            return m + 1 if of_run is None else of_run

        wedges = self._wedges(run) + [self.coarse[coarse[0]].wedges[lone[0]]]
        self._take([(s + j) % self.count for j in range(m)], coarse, m + 2, number, wedges, self.groups[s])

    def _take(self, fine, coarse, corners, number_of, wedges, group):
        must(corners <= 256, "a polygon has more than 256 corners")
        for i in coarse:
            face = self.coarse[i]
            must(not self.taken[i], "a face of a patch is in two sectors")
            self.taken[i] = True
            must(face.group == group, "a face of a patch is of another group than its sector")
            numbers = [number_of(place) for place in self.coarse_places[i]]
            must(len(set(numbers)) == 3, "a face of a patch has a corner twice")
            same = all(wedges[n] == w for n, w in zip(numbers, face.wedges))
            must(same, "a face of a patch has a wedge that its sector has not")
        self.found.append(Sector([self.star[i] for i in fine], [self.coarse[i] for i in coarse], corners))


def give_slots(level, sectors):
    """Section 8: the fine faces of a record get slots, those of the coarse ones first."""
    appended = []
    for sector in sectors:
        for f, coarse in zip(sector.fine, sector.coarse):
            level.slots[f] = coarse.slot
        appended += sector.fine[len(sector.coarse) :]
    for f in appended:
        level.append_slot(f)
