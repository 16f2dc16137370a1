"""Section 9.6 of docs/compact-stream.md: where vertices of fast streams are, and where they move to. Lengths count sixteenths."""

from compact_coding import (
    ZERO, NumberCoder, add, clamp, cross, cut, dot, exp2_16, log, log2_16, must, scaled, shifted, shorten,
    square, steepest, sub, total,
)  # fmt: skip
from compact_level import NONE
from compact_shape import UNKNOWN, bare_position, mean_of, outer_ring

OFF = 1 << 26


class Near:
    """Codes a position near an expected point, by a normal of any length and the size (normal, tangent) of the expected error."""

    def __init__(self, name, grid_highest):
        self.numbers = NumberCoder(name)
        self.grid_highest = grid_highest

    def position(self, coder, expected, normal, size, step):
        """The position, and its miss."""
        z = steepest(normal)
        x, y = [axis for axis in range(3) if axis != z]
        position = [0, 0, 0]

        def code(axis, mean, part, kind):
            scale = exp2_16(clamp(part, 16, 320)) >> step
            position[axis] = self.numbers.number(coder, (expected[axis] + mean) >> step, scale, kind) << step
            must(0 <= position[axis] <= self.grid_highest, "a vertex is not on the grid")
            return clamp(16 * position[axis] - expected[axis], -OFF, OFF)

        off_x, off_y = code(x, 0, size[1], 0), code(y, 0, size[1], 0)
        mean = 0
        if normal[z] != 0:
            mean = clamp(cut(-(normal[x] * off_x + normal[y] * off_y), normal[z]), -OFF, OFF)
        off_z = code(z, mean, size[0], 1)
        return tuple(position), (log(abs(off_z - mean) + 3), log2_16(off_x * off_x + off_y * off_y + 9) // 2)


def seen_from_first(level, halves):
    """The first corner, and the corners at each half-edge's begin and end, as seen from it."""
    first = level.positions[level.begin(halves[0])]
    points = [(sub(level.positions[level.begin(h)], first), sub(level.positions[level.to(h)], first)) for h in halves]
    return first, points


def corners_of(level, halves, closed):
    return [level.begin(h) for h in halves] + ([] if closed else [level.to(halves[-1])])


class FastVertices:
    """Positions of new vertices."""

    def __init__(self, grid_highest):
        self.near = Near("positions", grid_highest)
        self.misses = {}  # of vertices of no base mesh, once coded

    def note_loose(self, v):
        self.misses[v] = UNKNOWN

    def position(self, coder, v, around, _, step):
        level, halves, closed = around
        first, points = seen_from_first(level, halves)
        beyond = [NONE if level.twins[h] == NONE else level.apex(level.twins[h]) for h in halves]
        outer = [(p, q, sub(level.positions[o], first)) for (p, q), o in zip(points, beyond) if o != NONE]
        n, starts = len(halves), [p for p, _ in points]
        centre = mean_of_all(starts)
        mean = centre if closed else scaled(points[-1][1], 8)
        radius = (sum(map(square, starts)) * ((1 << 20) // n) >> 12) - square(centre)
        size_log = log2_16(max(radius, 256)) // 2
        pull = sub(mean, mean_of_all([o for _, _, o in outer])) if outer else ZERO
        planes = [(cross(sub(q, p), sub(p, o)), p) for p, q, o in outer]
        slope = total(plane for plane, _ in planes)
        distance = 16 * sum(dot(plane, p) for plane, p in planes) - dot(slope, mean)
        shift = add(shifted(scaled(pull, 5), 5), towards(slope, distance))
        expected = add(add(scaled(first, 16), mean), shift)
        normal, _ = shorten(total(cross(p, q) for p, q in points), 28)
        steep = normal[steepest(normal)]
        lift = 0 if steep == 0 else cut(dot(pull, normal), steep)
        seen = corners_of(level, halves, closed) + [o for o in beyond if o != NONE]
        found = [self.misses[x] for x in seen if x in self.misses]
        normal_miss, tangent_miss = mean_of(found) if found else UNKNOWN
        across = cut(3 * normal_miss + log(abs(lift) + 3) - size_log, 4)
        size = across + size_log, tangent_miss + size_log
        position, miss = self.near.position(coder, expected, normal, size, step)
        self.misses[v] = miss[0] - size_log, miss[1] - size_log
        return position


def mean_of_all(points):
    """About the mean of points, in sixteenths."""
    return shifted(scaled(total(points), (1 << 20) // len(points)), 16)


def towards(slope, distance):
    """A quarter of the way to a plane."""
    n, s = shorten(slope, 16)
    if square(n) == 0:
        return ZERO
    share = cut(clamp(distance >> s, -(1 << 38), 1 << 38) << 24, square(n))
    return shifted(scaled(n, clamp(share, -(1 << 44), 1 << 44)), 26)


class FastMoves:
    """Where vertices move to, at most once a stage."""

    def __init__(self, grid_highest):
        self.grid_highest = grid_highest
        self.near = Near("moves", grid_highest)
        self.bare = NumberCoder("bare")
        self.begin_stage()

    def begin_stage(self):
        self.moved = {}  # vertex to its miss

    def position(self, coder, level, v, half, _, old, new):
        start = scaled(level.positions[v], 16)
        if half == NONE:
            return bare_position(self.bare, coder, start, old, new, self.grid_highest)
        halves, closed = outer_ring(level, half)
        _, points = seen_from_first(level, halves)
        normal, _ = shorten(total(cross(p, q) for p, q in points), 28)
        found = [self.moved[x] for x in corners_of(level, halves, closed) if x in self.moved]
        size = mean_of(found) if found else (16 * old + 40, 16 * old + 40)
        position, self.moved[v] = self.near.position(coder, start, normal, size, new)
        return position
