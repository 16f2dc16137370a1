"""Sections 5 to 7 of docs/compact-stream.md: the base mesh, and the rounds that refine it."""

from itertools import accumulate

from compact_attributes import Attributes
from compact_coding import Bits, NumberCoder, cut, div_each, exp2_16, float_bits, hint, log, must, total, width
from compact_header import error_of, from_ordered, is_finite, order_of, step_of
from compact_level import (
    CLOSED, LONE, MOVED, NONE, OPEN, CoarseFace, Level, Sector, Sectors, face_of, give_slots, next_of, write_star,
)  # fmt: skip
from compact_places import PlaceModels, Walk
from compact_fast_shape import FastMoves, FastVertices
from compact_shape import MoveShapes, VertexShapes

WEDGE_LIMIT = 65536  # of a record


class Errors:
    """Section 7.7: codes of the deviation and the curvature error of each position."""

    def __init__(self, header):
        self.header = header
        self.coders = [NumberCoder("deviation"), NumberCoder("curvature")]
        self.deviation = self.curvature = 255
        self.within = None  # the deviation's code of levels within the next round
        self.codes = []

    def _fall(self, coder, which, code):
        fall = self.coders[which].number(coder, 48, 48)
        must(0 <= fall <= code, "an error falls by more than it is")
        return code - fall

    def position(self, coder, records, stage_ends):
        """Those of a round's records, or of position 0, for which `records` is 1."""
        within = self.deviation if self.within is None else self.within, self.curvature
        self.deviation = self._fall(coder, 0, within[0])
        self.curvature = self._fall(coder, 1, self.curvature)
        self.within = None
        if stage_ends:
            self.deviation = coder.raw(8)
            self.within = coder.raw(8)
            must(self.within >= self.deviation, "a deviation falls where a stage begins")
        self.codes += [within] * (records - 1) + [(self.deviation, self.curvature)]

    def values(self):
        header = self.header
        return [
            (error_of(deviation, header.largest_deviation), error_of(curvature, header.largest_curvature))
            for deviation, curvature in self.codes
        ]


class RestKind:
    """The positions, or an attribute of floats: what codes the rests of its components, and the true floats.

    These are kept as their bits: not every NaN survives being a float of Python's.
    """

    def __init__(self, name, components, step):
        self.coder = NumberCoder("rests of " + name)
        self.same = Bits("same floats of " + name, 32)
        self.step = step
        self.ratios = [0] * components
        self.pasts = [0] * components
        self.last = [{} for _ in range(components)]  # 1024 entries at most: a number, and what it last was
        self.elements = []

    def decode(self, coder, numbers, values):
        """An element of whole numbers, which give `values`."""
        self.elements.append([self._float(coder, c, n, value) for c, (n, value) in enumerate(zip(numbers, values))])

    def _float(self, coder, c, n, value):
        entry = self.last[c].get(n % 1024)
        if entry and entry[0] == n:
            same = self.same(coder, 8 * min(c, 3) + self.pasts[c])
            self.pasts[c] = (2 * self.pasts[c] + same) % 8
            if same:
                return entry[1]
        value = self._with_rest(coder, c, value)
        self.last[c][n % 1024] = n, value
        return value

    def _with_rest(self, coder, c, value):
        order = order_of(value)
        usual = log(4 * (order_of(value + self.step) - order))
        hints = (hint(self.ratios[c], -208, 16), hint(usual, 0, 32), 0)
        rest = self.coder.number(coder, 0, exp2_16(usual + self.ratios[c] + 8), min(c, 3), hints)
        must(0 <= order + rest < 1 << 32, "a rest leads to no float")
        self.ratios[c] += cut(log(16 * rest) - usual - self.ratios[c], 8)
        return from_ordered(order + rest)


class Rests:
    """Section 7.8: how far the true floats are from what the whole numbers give."""

    def __init__(self, header, attributes):
        self.header = header
        self.positions = RestKind("positions", 3, header.position_step())
        self.attributes = {
            model: RestKind(model.attribute.name, model.attribute.components, step_of(model.attribute))
            for model in attributes.by_header
            if model.attribute.floats
        }

    def decode(self, coder, level):
        """Of all vertices and wedges that are new since the last time."""
        for numbers in level.positions[len(self.positions.elements) :]:
            self.positions.decode(coder, numbers, self.header.position(numbers))
            must(all(map(is_finite, self.positions.elements[-1])), "a position is not finite")
        for model, kind in self.attributes.items():
            for numbers in model.wedges[len(kind.elements) :]:
                kind.decode(coder, numbers, model.attribute.values(numbers))


class WedgeModels:
    """Section 7.3: the wedges of stars."""

    def __init__(self):
        self.bits = Bits("wedges", 128)

    def decode(self, coder, level, place, has_seams):
        """Gives the faces of a place's star their centres, and what else they have that was not foretold."""
        star, v = place.star, place.vertex
        used = level.wedge_counts[v]
        centres, context = self._foretold(level, place, used, has_seams)
        if self.bits(coder, context):
            for f, c in zip(star, centres):
                self._set_centre(level, f, level.add_wedge(v) if c == level.wedge_counts[v] else level.first_wedge[v] + c)
            return
        for i, f in enumerate(star):
            self._side(coder, level, f, place.ear)
            self._centre(coder, level, v, f, star[i - 1] if i else None)

    @staticmethod
    def _set_centre(level, f, wedge):
        level.corner_wedge[3 * f] = wedge

    @staticmethod
    def _between(level, f, after):
        if level.corner_wedge[3 * f + 2] != level.corner_wedge[3 * after + 1]:
            return 2
        return 1 if level.groups[f] != level.groups[after] else 0

    def _foretold(self, level, place, used, has_seams):
        """The centres' numbers within the vertex, and the context of the bit that says whether they are right."""
        star = place.star
        centres, cuts, outers = [used] * len(star), 0, 0
        if has_seams:
            steps = [self._between(level, f, after) == 2 for f, after in zip(star, star[1:])]
            around = place.closed and self._between(level, star[-1], star[0]) == 2
            cuts = sum(steps) + around
            outers = sum(level.seam(3 * f + 1) for f in star)
            if not (place.closed and cuts < 2):
                centres = list(accumulate(steps, initial=used))
                if place.closed and not around:
                    centres = [used if c == centres[-1] else c for c in centres]
        shape = 2 if place.ear else 0 if place.closed else 1
        return centres, ((min(cuts, 3) * 3 + shape) * 3 + min(outers, 2)) * 2 + (1 if used > 0 else 0)

    def _side(self, coder, level, f, ear):
        h = 3 * f + 1
        seam = 1 if level.seam(h) else 0
        if self.bits(coder, 72 + seam):
            return
        wedges = level.corner_wedge
        if seam and not ear and self.bits(coder, 74):
            t = level.twins[h]
            level.groups[f] = level.groups[face_of(t)]
            wedges[h], wedges[h + 1] = wedges[next_of(t)], wedges[t]
            return
        level.groups[f] = number_below(coder, len(level.group_sizes), "group")
        for corner in (h, h + 1):
            wedges[corner] = told_wedge(coder, level, level.corner_vertex[corner])

    def _centre(self, coder, level, v, f, before):
        if before is not None and self.bits(coder, 75 + self._between(level, before, f)):
            self._set_centre(level, f, level.corner_wedge[3 * before])
        elif level.wedge_counts[v] == 0 or self.bits(coder, 78):
            self._set_centre(level, f, level.add_wedge(v))
        else:
            self._set_centre(level, f, told_wedge(coder, level, v))

    def extra(self, coder, level, v):
        """Wedges of a vertex that no face uses yet."""
        context = 79
        while self.bits(coder, context):
            level.add_wedge(v)
            context = 80


def number_below(coder, count, what):
    """One of `count` things, by a number of as many bits as it needs."""
    must(count > 0, f"there is no {what} to name")
    number = coder.raw(width(count - 1))
    must(number < count, f"a {what} of number {number} is not there")
    return number


def told_wedge(coder, level, v):
    return level.first_wedge[v] + number_below(coder, level.wedge_counts[v], "wedge of a vertex")


class LooseSector:
    """A sector as its loose record tells it."""

    def __init__(self, shape, centre, group, coarse, polygon):
        self.shape, self.centre, self.group, self.coarse, self.polygon = shape, centre, group, coarse, polygon
        self.fine = []
        self.slots = []  # what the coarse faces were

    @property
    def fine_count(self):
        return len(self.coarse) + {OPEN: 1, LONE: 1, CLOSED: 2, MOVED: 0}[self.shape]


class LooseRecords:
    """Section 7.5."""

    COUNT, SIZE, BACK, SECTORS = range(4)

    def __init__(self, header, wedge_models):
        self.header, self.wedge_models = header, wedge_models
        self.bits = Bits("loose", 16)
        self.numbers = NumberCoder("loose numbers")
        self.places = NumberCoder("loose positions")
        self.borders = {}  # (from, to) to a half-edge that had no twin

    def _number(self, coder, kind):
        return self.numbers.number(coder, 8, 32, kind)

    def count(self, coder):
        return max(0, self._number(coder, self.COUNT)) if self.bits(coder, 0) else 0

    def decode(self, coder, level, made, step):
        """A record: its new vertex, its fine faces and its sectors."""
        v = level.add_vertex()
        count = self._number(coder, self.SECTORS)
        must(0 <= count <= 1024, f"a loose record has {count} sectors")
        sectors = [self._sector(coder, level, v) for _ in range(count)]
        fine = self._write(level, v, sectors, made)
        self.wedge_models.extra(coder, level, v)
        must(level.wedge_counts[v] <= WEDGE_LIMIT, "a record has too many wedges")
        level.positions[v] = self._position(coder, level, v, fine, step)
        return v, fine, [Sector(s.fine, s.slots, len(s.polygon)) for s in sectors]

    def _sector(self, coder, level, v):
        high = self.bits(coder, 1)
        shape = 2 * high + self.bits(coder, 3 if high else 2)
        wedges_before = level.wedge_count
        if level.wedge_counts[v] == 0 or self.bits(coder, 5):
            centre = level.add_wedge(v)
        else:
            centre = told_wedge(coder, level, v)
        size = 0 if shape == LONE else self._number(coder, self.SIZE)
        must(0 <= size <= 254 and (size > 0 or shape in (OPEN, LONE)), f"a loose sector has {size} coarse faces")
        if size == 0:
            group = number_below(coder, len(level.group_sizes), "group")
            return LooseSector(shape, centre, group, [], [self._wedge_back(coder, level, v, wedges_before) for _ in range(2)])
        coarse = [number_below(coder, level.face_count, "face") for _ in range(size)]
        group = level.groups[coarse[0]]
        must(all(level.groups[f] == group for f in coarse), "a loose sector has faces of two groups")
        start = coder.raw(width(size + 1))
        must(start < size + 2, "a loose sector begins behind its edges")
        return LooseSector(shape, centre, group, coarse, self._trace(level, coarse, start))

    def _wedge_back(self, coder, level, v, wedges_before):
        wedge = wedges_before - 1 - self._number(coder, self.BACK)
        must(0 <= wedge < wedges_before, "a loose sector has a wedge that is not there")
        must(level.wedge_vertex[wedge] != v, "a loose sector's polygon has its own vertex")
        return wedge

    @staticmethod
    def _trace(level, coarse, start):
        edges = [(level.corner_wedge[h], level.corner_wedge[next_of(h)]) for f in coarse for h in range(3 * f, 3 * f + 3)]
        there = set(edges)
        outer = [edge for edge in edges if (edge[1], edge[0]) not in there]
        must(len(outer) == len(coarse) + 2, "a loose sector's faces are no polygon")
        after = {}
        for edge in outer:
            after.setdefault(edge[0], edge)
        polygon, edge = [], outer[start]
        for _ in outer:
            polygon.append(edge[0])
            must(edge[1] in after, "a loose sector's polygon ends")
            edge = after[edge[1]]
        must(len(set(polygon)) == len(polygon) and edge == outer[start], "a loose sector's polygon has a wedge twice")
        places = {wedge: i for i, wedge in enumerate(polygon)}
        for f in coarse:
            wedges = level.corner_wedge[3 * f : 3 * f + 3]
            must(all(w in places for w in wedges), "a loose sector's face has a corner inside")
            a, b, c = [places[w] for w in wedges]
            must(a < b < c or b < c < a or c < a < b, "a loose sector's face is the wrong way round")
        return polygon

    def _write(self, level, v, sectors, made):
        """Writes the fine faces, and joins what there is to join: the faces."""
        coarse = [f for sector in sectors for f in sector.coarse]
        must(len(set(coarse)) == len(coarse), "a face is coarse twice in a loose record")
        loose = set()
        for sector in sectors:
            sector.slots = [CoarseFace(level, f) for f in sector.coarse]
        for h in (3 * f + k for f in coarse for k in range(3)):
            t = level.twins[h]
            if t != NONE:
                level.twins[h] = level.twins[t] = NONE
                loose.add(t)
        fine = []
        for sector in sectors:
            polygon = sector.polygon
            for i in range(sector.fine_count):
                f = sector.coarse[i] if i < len(sector.coarse) else level.add_face()
                ends = polygon[i], polygon[(i + 1) % len(polygon)]
                vertices = [v] + [level.wedge_vertex[w] for w in ends]
                level.write_face(f, vertices, [sector.centre, *ends], sector.group, made)
                sector.fine.append(f)
            fine += sector.fine
        own = [3 * f + k for f in fine for k in range(3)]
        loose.update(own)
        for h in list(loose):
            ends = level.to(h), level.begin(h)
            border = self.borders.get(ends, NONE)
            if border != NONE and (level.begin(border), level.to(border)) == ends and level.twins[border] == NONE:
                loose.add(border)
        level.join(loose)
        for h in own:
            if level.twins[h] == NONE:
                self.borders[level.begin(h), level.to(h)] = h
        return fine

    def _position(self, coder, level, v, fine, step):
        corners = [level.positions[level.corner_vertex[3 * f + k]] for f in fine for k in (1, 2)]
        guess = div_each(total(corners), len(corners)) if corners else level.positions[v - 1] if v else (0, 0, 0)
        scale = max(1, (16 << (self.header.grid_bits - 5)) >> step)
        numbers = [self.places.number(coder, (16 * c) >> step, scale) for c in guess]
        position = tuple(number << step for number in numbers)
        must(all(0 <= c <= self.header.grid_highest for c in position), "a vertex is not on the grid")
        return position


class Decoder:
    """A stream's level, refined chunk by chunk."""

    def __init__(self, header):
        self.header = header
        self.level = Level(len(header.groups))
        self.rounds = self.records = 0
        self.base = Bits("base", 8)
        self.base_positions = NumberCoder("base positions")
        self.flags = Bits("flags", 4)
        self.places = PlaceModels()
        self.wedges = WedgeModels()
        self.shapes = (FastVertices if header.fast else VertexShapes)(header.grid_highest)
        self.moves = (FastMoves if header.fast else MoveShapes)(header.grid_highest)
        self.loose = LooseRecords(header, self.wedges)
        self.attributes = Attributes(header.attributes, header.fast)
        self.rests = Rests(header, self.attributes)
        self.errors = Errors(header)
        self.step = self.old_step = 0
        self.unmoved = set()
        self.level_sizes = self.polygon_corners = self.move_count = 0

    def decode_chunk(self, index, coder):
        """The chunk of number `index`, which follows all that were decoded."""
        entry = self.header.chunks[index]
        self.level.limits = entry.level
        if index == 0:
            self._begin(coder)
        for _ in range(entry.rounds):
            Round(self, coder).decode()
        level = self.level
        found = (level.vertex_count, level.wedge_count, level.face_count)
        must(found == entry.level, f"it adds other counts than its header says: {found}, not {entry.level}")
        must(self.errors.deviation == entry.deviation_code, "it ends with another deviation than its header says")

    def check_limits(self):
        """Section 3: what adds up over the stream, held to the size of the level that the chunk leads to."""
        vertices, wedges, faces = self.level.limits
        size = faces + vertices + wedges + len(self.header.groups) + 1
        must(self.level_sizes <= 256 * size, "it has too many rounds for its size")
        must(self.polygon_corners <= 64 * (faces + vertices), "it has too many corners of polygons for its size")
        must(self.move_count <= 4 * vertices, "it has too many moves for its size")

    # Chunk 0, section 6.

    def _begin(self, coder):
        self._read_step(coder)
        corners = self._base_corners(coder)
        self._base_wedges(coder)
        self._base_faces(corners, self._base_corner_wedges(coder, corners))
        self._base_vertices(coder)
        self.level.join(range(3 * self.level.face_count))
        self.attributes.decode_base(coder, self.level)
        if self.header.lossless:
            self.rests.decode(coder, self.level)
        self.errors.position(coder, 1, False)

    def _read_step(self, coder):
        self.old_step, self.step = self.step, coder.raw(4)
        must(self.step <= self.header.grid_bits - 4, f"a step of {self.step} bits is too large")
        must(self.step == 0 or not self.header.lossless, "a lossless stream has a step")

    def _base_corners(self, coder):
        used, corners = 0, []
        for _ in range(3 * self.header.faces):
            if self.base(coder, 0):
                v = used
                used += 1
            else:
                v = coder.raw(width(max(used, 1) - 1))
            must(v < min(used, self.header.vertices), "a base face has a vertex that is not there")
            corners.append(v)
        return corners

    def _base_wedges(self, coder):
        for _ in range(self.header.vertices):
            v = self.level.add_vertex()
            i = 0
            while self.base(coder, 1 + min(i, 2)):
                must(self.level.wedge_count < self.header.wedges, "the base mesh has more wedges than its header says")
                self.level.add_wedge(v)
                i += 1
        must(self.level.wedge_count == self.header.wedges, "the base mesh has fewer wedges than its header says")

    def _base_corner_wedges(self, coder, corners):
        level, last, wedges = self.level, {}, []
        for v in corners:
            count = level.wedge_counts[v]
            must(count > 0, "a base face has a vertex without wedges")
            if count > 1 and not self.base(coder, 4):
                last[v] = told_wedge(coder, level, v)
            wedges.append(last.get(v, level.first_wedge[v]))
        return wedges

    def _base_faces(self, corners, wedges):
        level, at = self.level, 0
        for group, (_, count) in enumerate(self.header.groups):
            for _ in range(count):
                turn = max(range(3), key=lambda k: wedges[at + k])
                turned = [at + (turn + k) % 3 for k in range(3)]
                f = level.add_face()
                level.write_face(f, [corners[c] for c in turned], [wedges[c] for c in turned], group, 0)
                level.append_slot(f)
                at += 3

    def _base_vertices(self, coder):
        for v in range(self.level.vertex_count):
            value = 16 << (self.header.grid_bits - 1 - self.step)
            numbers = [self.base_positions.number(coder, value, value // 4) for _ in range(3)]
            position = tuple(number << self.step for number in numbers)
            must(all(0 <= c <= self.header.grid_highest for c in position), "a base vertex is not on the grid")
            self.level.positions[v] = position

    # What a stage ends with, section 7.6.

    def move(self, coder, v, half, normals):
        """Moves a vertex that has not moved in this stage."""
        self.unmoved.discard(v)
        self.move_count += 1
        self.level.positions[v] = self.moves.position(coder, self.level, v, half, normals, self.old_step, self.step)

    def end_stage(self, coder):
        level = self.level
        if self.unmoved:
            leaving = {}
            for h, v in enumerate(level.corner_vertex):
                leaving.setdefault(v, h)
            normals = level.vertex_normals()
            for v in sorted(self.unmoved):
                self.move(coder, v, leaving.get(v, NONE), normals)
        self.check_limits()
        self._read_step(coder)
        self.unmoved = set(range(level.vertex_count))
        self.moves.begin_stage()

    # What a stream leads to.

    def positions(self):
        """Three floats of each vertex, as their bits."""
        if self.header.lossless:
            return self.rests.positions.elements
        return [list(map(float_bits, self.header.position(numbers))) for numbers in self.level.positions]

    def elements(self, model):
        """The values of an attribute, wedge by wedge; floats as their bits."""
        if not model.attribute.floats:
            return [model.attribute.values(numbers) for numbers in model.wedges]
        if self.header.lossless:
            return self.rests.attributes[model].elements
        return [list(map(float_bits, model.attribute.values(numbers))) for numbers in model.wedges]


class Round:
    """One round, section 7."""

    def __init__(self, decoder, coder):
        self.decoder, self.coder, self.level = decoder, coder, decoder.level
        decoder.rounds += 1
        self.number = decoder.rounds
        decoder.level_sizes += self.level.size
        decoder.check_limits()
        self.has_seams = len(self.level.group_sizes) > 1 or self.level.wedge_count > self.level.vertex_count

    def decode(self):
        decoder, coder, level = self.decoder, self.coder, self.level
        places = Walk(decoder.places, coder, level, self.number, self.has_seams).places()
        self.normals = level.vertex_normals()
        self._moves(places)
        vertices = self._stars(places)
        self._wedges(vertices)
        self._positions(vertices)
        decoder.attributes.decode(coder, level, [(v, [f for p in of_vertex for f in p.star]) for v, of_vertex in vertices])
        loose = self._loose_records()
        decoder.attributes.decode(coder, level, loose)
        records = len(vertices) + len(loose)
        must(records > 0, "a round has no records")
        if decoder.header.lossless:
            decoder.rests.decode(coder, level)
        stage_ends = decoder.flags(coder, 3)
        if stage_ends:
            must(not decoder.header.lossless, "a lossless stream has stages")
            decoder.end_stage(coder)
        decoder.errors.position(coder, records, stage_ends)
        decoder.records += records

    def _moves(self, places):
        level, unmoved = self.level, self.decoder.unmoved
        if not unmoved:
            return
        for place in places:
            for h in place.halves:
                for half in (h, next_of(h)):
                    if level.begin(half) in unmoved:
                        self.decoder.move(self.coder, level.begin(half), half, self.normals)
        self.decoder.check_limits()

    def _stars(self, places):
        """Joins places, and writes their stars: the new vertices, each with its places."""
        decoder, coder = self.decoder, self.coder
        joined = len(places) > 1 and decoder.flags(coder, 0)
        vertices = []
        for i, place in enumerate(places):
            if i > 0 and joined and decoder.flags(coder, 1):
                j = coder.raw(width(i - 1))
                must(j < i and not places[j].joined, "a place is joined to one that cannot be")
                place.joined = True
                place.vertex = places[j].vertex
            else:
                place.vertex = self.level.add_vertex()
                vertices.append((place.vertex, []))
        by_vertex = dict(vertices)
        for place in places:
            by_vertex[place.vertex].append(place)
            write_star(self.level, place, self.number)
        return vertices

    def _wedges(self, vertices):
        decoder, coder, level = self.decoder, self.coder, self.level
        any_extra = decoder.flags(coder, 2)
        for v, places in vertices:
            sectors = []
            for place in places:
                decoder.wedges.decode(coder, level, place, self.has_seams)
                sectors += Sectors(level, place).find()
            if any_extra:
                decoder.wedges.extra(coder, level, v)
            must(level.wedge_counts[v] <= WEDGE_LIMIT, "a record has too many wedges")
            self._end_record(sectors)

    def _end_record(self, sectors):
        give_slots(self.level, sectors)
        self.decoder.polygon_corners += sum(sector.corners for sector in sectors)
        self.decoder.check_limits()

    def _positions(self, vertices):
        decoder, level = self.decoder, self.level
        for v, places in vertices:
            level.positions[v] = self._guess(places[0])
        for v, places in vertices:
            halves = [3 * f + 1 for f in places[0].star]
            around = level, halves, places[0].closed
            level.positions[v] = decoder.shapes.position(self.coder, v, around, self.normals, decoder.step)

    def _guess(self, place):
        positions, corners = self.level.positions, self.level.corner_vertex
        if place.closed:
            return div_each(total(positions[corners[3 * f + 1]] for f in place.star), len(place.star))
        ends = corners[3 * place.star[0] + 1], corners[3 * place.star[-1] + 2]
        return div_each(total(positions[v] for v in ends), 2)

    def _loose_records(self):
        """The loose records' vertices, each with its faces."""
        decoder, found = self.decoder, []
        for _ in range(decoder.loose.count(self.coder)):
            v, fine, sectors = decoder.loose.decode(self.coder, self.level, self.number, decoder.step)
            decoder.shapes.note_loose(v)
            self._end_record(sectors)
            found.append((v, fine))
        return found
