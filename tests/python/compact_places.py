"""Sections 7.1 and 9.5 of docs/compact-stream.md: the walk over a level that finds the places of a round."""

from compact_coding import (
    Bits, Counters, Mixer, NumberCoder, bucket, cross, cut, div_each, dot, exp2_16, log2_16, must, scaled, shifted, shorten, square, sub,
    total, width,
)  # fmt: skip
from compact_level import NONE, Place, face_of, next_of, prev_of

OPEN, PLAIN, PATCH = range(3)


class PlaceModels:
    """What the walks of a stream's rounds share."""

    def __init__(self):
        self.patches = NumberCoder("patches")
        self.borders = Bits("borders", 3)
        self.fast_faces = Counters("fast faces", 13 * 12)
        self.fast_edges = Counters("fast edges", 8 * 16)
        self.faces = Mixer("faces", [480, 240, 432, 600, 320, 512, 1280], 30)
        self.edges = Mixer("edges", [1152, 256, 1152, 1024, 1024, 2048, 1440, 13824], 6 * 8 * 3)


class Walk:
    """Decides for each face whether it is plain or in a patch."""

    def __init__(self, models, coder, level, round_number, has_seams):
        self.models, self.coder, self.level = models, coder, level
        self.round, self.has_seams = round_number, has_seams
        self.state = bytearray(level.face_count)
        self.across = bytearray(3 * level.face_count)
        self.degree = [0] * level.vertex_count
        for v in level.corner_vertex:
            self.degree[v] += 1
        self.deg = list(self.degree)
        self.open = list(self.degree)
        self.patches = [0] * level.vertex_count
        self._measure()
        self.flats = {}

    def _measure(self):
        """Areas and normals of all faces."""
        self.areas, self.normals = [], []
        for f in range(self.level.face_count):
            m, s = shorten(self.level.face_normal(f), 30)
            self.areas.append(log2_16(square(m)) + 32 * s)
            self.normals.append(shorten(m, 15)[0])
        self.mean_area = cut(sum(self.areas), len(self.areas)) if self.areas else 0

    # The walk, section 7.1.

    def places(self):
        """All places: ears, then patches."""
        count = self.level.face_count
        self.missing = self.models.patches.number(self.coder, cut(16 * count, 6), cut(16 * count, 12))
        must(0 <= self.missing <= count, "a round has more patches than faces")
        found = []
        for first in range(count):
            if not self.missing:
                break
            if self.state[first] == OPEN:
                self._walk_from(first, found)
        must(not self.missing, "the walk finds fewer patches than there are")
        return self._ears() + found

    def _walk_from(self, first, found):
        queue, at = [first], 0
        while at < len(queue) and self.missing:
            f = queue[at]
            at += 1
            if self.state[f] != OPEN:
                continue
            if self._face_begins(f):
                place, polygon = self._grow(f)
                found.append(place)
                self.missing -= 1
            else:
                polygon = range(3 * f, 3 * f + 3)
                self._leave_open(f, PLAIN)
            queue += [b for b in map(self.level.beyond, polygon) if b != NONE]

    def _leave_open(self, f, state):
        self.state[f] = state
        for v in self.level.corner_vertex[3 * f : 3 * f + 3]:
            self.open[v] -= 1
            if state == PATCH:
                self.deg[v] -= 1

    def _grow(self, f):
        """A patch from face f on; its polygon still with the closing edge, too."""
        level, across = self.level, self.across
        polygon, faces = [3 * f, 3 * f + 1, 3 * f + 2], [f]
        self._leave_open(f, PATCH)
        closing, crossed, i = None, 0, 0
        while i < len(polygon):
            h = polygon[i]
            t = level.twins[h]
            if t == NONE:
                if closing is None and self.models.borders(self.coder, 0):
                    closing = i
                    across[h] = 1
                i += 1
            elif self._may_go_on(h, t, polygon) and self._goes_on(h, polygon, f, crossed):
                faces.append(face_of(t))
                self._leave_open(face_of(t), PATCH)
                crossed += self._seam(h)
                polygon[i : i + 1] = [next_of(t), prev_of(t)]
            else:
                across[t] = 1
                i += 1
        for h in polygon:
            self.deg[level.begin(h)] += 2
            self.patches[level.begin(h)] += 1
        if closing is None:
            return Place(polygon, closed=True, faces=faces), polygon
        return Place(polygon[closing + 1 :] + polygon[:closing], faces=faces), polygon

    def _may_go_on(self, h, t, polygon):
        if self.state[face_of(t)] != OPEN or self.across[h] or len(polygon) >= 256:
            return False
        apex = self.level.apex(t)
        return all(self.level.begin(edge) != apex for edge in polygon)

    def _ears(self):
        found = []
        if not self.models.borders(self.coder, 1):
            return found
        missing = self.coder.raw(width(3 * self.level.face_count))
        for h in range(3 * self.level.face_count):
            if not missing:
                break
            if self.level.twins[h] == NONE and not self.across[h] and self.models.borders(self.coder, 2):
                found.append(Place([h], ear=True))
                missing -= 1
        return found

    # Contexts, section 9.5.

    def _age(self, f):
        return min(self.round - self.level.made[f], 4) - 1

    def _size(self, f):
        return bucket(self.areas[f] - self.mean_area, -96, 8, 24)

    def _seam(self, h):
        return 1 if self.has_seams and self.level.seam(h) else 0

    def _length(self, h):
        positions = self.level.positions
        return log2_16(square(sub(positions[self.level.begin(h)], positions[self.level.to(h)])))

    def _flat(self, h):
        t = self.level.twins[h]
        if t == NONE:
            return 0
        edge = min(h, t)
        if edge not in self.flats:
            self.flats[edge] = self._flat_of(self.normals[face_of(h)], self.normals[face_of(t)])
        return self.flats[edge]

    @staticmethod
    def _flat_of(a, b):
        c = dot(a, b)
        if c <= 0:
            return 0
        q = shifted(cross(a, b), 2)
        return bucket(-(log2_16(square(q) + 1) + 64 - 2 * log2_16(c)), 0, 32, 8)

    def _beyond_counts(self, halves):
        """How many faces beyond are plain, or missing, and how many are in patches."""
        states = [PLAIN if b == NONE else self.state[b] for b in map(self.level.beyond, halves)]
        return states.count(PLAIN), states.count(PATCH)

    def _is_open(self, f):
        return f != NONE and self.state[f] == OPEN

    def _face_begins(self, f):
        level = self.level
        halves = range(3 * f, 3 * f + 3)
        corners = level.corner_vertex[3 * f : 3 * f + 3]
        plain, patched = self._beyond_counts(halves)
        lengths = [self._length(h) for h in halves]
        shape = bucket(max(lengths) - cut(sum(lengths), 3), 0, 4, 12)
        if self.coder.fast:
            return self.models.fast_faces(self.coder, (plain + 4 * patched) * 12 + shape)
        flats = [self._flat(h) for h in halves]
        state = (0, 4, 7, 9)[plain] + patched
        degrees = sum(min(self.degree[v], 20) for v in corners)
        new = sum(min(self.deg[v], 64) for v in corners)
        touched = sum(self.patches[v] > 0 for v in corners)
        tight = min(4, *[self.open[v] for v in corners])
        beyond = [b for b in map(level.beyond, halves) if b != NONE]
        ages = sum(map(self._age, beyond))
        seams = min(sum(map(self._seam, halves)), 2)
        flattest = max([flat for h, flat in zip(halves, flats) if self._is_open(level.beyond(h))] + [0])
        areas = sum(self.areas[b] for b in beyond)
        relative = bucket(self.areas[f] - cut(areas, len(beyond)), -48, 8, 12) if beyond else 0
        degree = bucket(degrees, 9, 1, 20)
        others = min(ages // 3, 3)
        age, size = self._age(f), self._size(f)
        contexts = (
            ((seams * 10 + state) * 4 + age) * 4 + others,
            state * 24 + size,
            (relative * 12 + shape) * 3 + (2 if patched else 1 if plain else 0),
            (seams * 20 + degree) * 10 + state,
            (age * 20 + degree) * 4 + others,
            (min(sum(flats) // 3, 7) * 8 + flattest) * 8 + size // 3,
            ((touched * 5 + tight) * 16 + bucket(new, 10, 1, 16)) * 4 + age,
        )
        return self.models.faces.bit(self.coder, contexts, 10 * seams + state)

    def _goes_on(self, h, polygon, first, crossed):
        level = self.level
        t = level.twins[h]
        size = len(polygon)
        corners = min(size - 3, 7)
        length = self._length(h)
        lengths = sum(map(self._length, polygon)) + self._length(next_of(t)) + self._length(prev_of(t)) - length
        relative = bucket(length - cut(lengths, size + 1), -32, 5, 16)
        if self.coder.fast:
            return self.models.fast_edges(self.coder, corners * 16 + relative)
        f, b, c, d = face_of(h), face_of(t), level.apex(t), level.apex(h)
        a, e = level.begin(h), level.to(h)
        plain, patched = self._beyond_counts((next_of(t), prev_of(t)))
        pair = 3 * plain + patched
        seam = 2 * min(crossed, 2) + self._seam(h)
        across = log2_16(square(sub(level.positions[d], level.positions[c])))
        flip = bucket(across - length, -40, 5, 16)
        angle, far = self._angle_and_far(polygon, a, e, c)
        balance = bucket(self.deg[a] + self.deg[e] - self.deg[c] - self.deg[d], -8, 1, 20)
        same = 1 if level.made[f] == level.made[b] else 0
        patches = self.patches
        contexts = (
            (corners * 16 + relative) * 9 + pair,
            relative * 16 + flip,
            (seam * 8 + corners) * 24 + self._size(b),
            ((relative * 4 + self._age(f)) * 4 + self._age(b)) * 4 + 2 * same + (1 if f == first else 0),
            (flip * 8 + self._flat(h)) * 8 + corners,
            (corners * 16 + angle) * 16 + far,
            ((corners * 20 + balance) * 3 + min(patches[c], 2)) * 3 + min(patches[a] + patches[e], 2),
            ((seam * 16 + angle) * 16 + relative) * 9 + pair,
        )
        return self.models.edges.bit(self.coder, contexts, (8 * seam + corners) * 3 + patched)

    def _angle_and_far(self, polygon, a, e, c):
        """How the ends of an edge are seen from the polygon's centre, and how far out the vertex beyond is."""
        positions = self.level.positions
        corners = [scaled(positions[self.level.begin(h)], 16) for h in polygon]
        centre = div_each(total(corners), len(polygon))
        mean_radius = cut(sum(log2_16(square(sub(p, centre))) for p in corners), len(polygon))
        u, v, w = (sub(scaled(positions[x], 16), centre) for x in (a, e, c))
        inner = dot(u, v)
        cosine = exp2_16(min(log2_16(abs(inner)) - (log2_16(square(u)) + log2_16(square(v))) // 2, 0) + 96)
        angle = bucket(-cosine if inner < 0 else cosine, -64, 8, 16)
        return angle, bucket(cut(log2_16(square(w)) - mean_radius, 2), -16, 3, 16)
