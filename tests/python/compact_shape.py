"""Sections 9.2 to 9.4 of docs/compact-stream.md: where new vertices are, and where vertices move to. Lengths count sixteenths."""

from math import isqrt

from compact_coding import (
    ZERO, NumberCoder, add, along, clamp, cross, cut, div_each, exp2_16, fit, hint, length, log, log2_16, must,
    scaled, shifted, square, sub, times, total, unit, width,
)  # fmt: skip
from compact_level import NONE, next_of, prev_of

UNKNOWN = (-48, -32)  # a miss: its normal and its tangent part


class Ring:
    """What is around a vertex: outer half-edges in order; `normals` are those of vertices."""

    def __init__(self, level, halves, closed, normals):
        self.halves, self.closed = halves, closed
        self.corners = [level.begin(h) for h in halves]
        if not closed:
            self.corners.append(level.to(halves[-1]))
        self.size = len(self.corners)
        self.beyond = [level.apex(level.twins[h]) for h in halves if level.twins[h] != NONE]
        points = [scaled(level.positions[v], 16) for v in self.corners]
        after = points[1:] + points[:1]
        edges = list(zip(points, after))[: len(halves)]
        self._measure(points, edges)
        self._pull(level, points, edges, normals)
        self._spread(points)

    def _measure(self, points, edges):
        n = len(edges)
        first = points[0]
        self.normal = unit(total(shifted(cross(sub(p, first), sub(q, first)), 8) for p, q in edges))
        self.mean = div_each(total(points), n) if self.closed else div_each(add(points[0], points[-1]), 2)
        squares = [square(sub(p, self.mean)) for p, _ in edges]
        self.radius = max(16, isqrt(sum(squares) // n))
        self.log_least = log2_16(min(squares)) // 2
        self.lengths = [length(sub(p, q)) + 1 for p, q in edges]
        self.log_edge = log2_16(2 * sum(self.lengths) // (2 * n))

    def _pull(self, level, points, edges, normals):
        mean = self.mean
        inner = [(edge, h) for edge, h in zip(edges, self.halves) if level.twins[h] != NONE]
        outer = [(p, q, scaled(level.positions[level.apex(level.twins[h])], 16)) for (p, q), h in inner]
        pulls = [ZERO] * 4
        self.log_beyond = 0
        if outer:
            count = len(outer)
            self.log_beyond = log2_16(sum(length(sub(o, mean)) for _, _, o in outer) // count + 1)
            pulls[0] = sub(div_each(total(o for _, _, o in outer), count), mean)
            weights = [1 + (1 << 24) // ((square(sub(add(p, q), scaled(o, 2))) >> 4) // 64 + 256) for p, q, o in outer]
            sums = total(scaled(sub(add(p, q), o), w) for (p, q, o), w in zip(outer, weights))
            pulls[2] = sub(div_each(sums, sum(weights)), mean)
        sums = total(scaled(add(p, q), size) for (p, q), size in zip(edges, self.lengths))
        pulls[1] = sub(div_each(sums, 2 * sum(self.lengths)), mean)
        offsets = (times(normals[v], along(sub(p, mean), normals[v])) for v, p in zip(self.corners, points))
        pulls[3] = div_each(total(offsets), self.size)
        self.pulls = pulls

    def _spread(self, points):
        sums = [[0] * 3 for _ in range(3)]
        for p in points:
            d = sub(p, self.mean)
            e = sub(d, times(self.normal, along(d, self.normal)))
            for i in range(3):
                for j in range(i + 1):
                    sums[i][j] += (e[i] * e[j]) >> 4
        t = (sums[0][0] + sums[1][1] + sums[2][2]) // 2 + 1
        s = max(0, width(t) - 36)
        t = max(t >> s, 1)
        w = width(t)
        self.spread = [[0] * 3 for _ in range(3)]
        for i in range(3):
            for j in range(i + 1):
                spread = ((sums[i][j] >> s) * ((1 << (w + 24)) // t)) >> w
                self.spread[i][j] = self.spread[j][i] = spread

    def over(self, v):
        return shifted(scaled(v, (1 << 32) // self.radius), 24)

    def parts(self, v):
        """A vector over the radius: what of it is along the normal, and what is left."""
        u = self.over(v)
        a = along(u, self.normal)
        return a, sub(u, times(self.normal, a))

    def miss(self, error):
        a = along(error, self.normal)
        b = length(sub(error, times(self.normal, a)))
        radius = log2_16(self.radius)
        return log(abs(a) + 3) - radius, log(b + 3) - radius


def mean_of(misses):
    return tuple(cut(sum(part), len(misses)) for part in zip(*misses))


class Coordinates:
    """Section 9.3: codes a point from a ring, an expected point, and the size (normal, tangent) of the expected error."""

    def __init__(self, name, grid_highest):
        self.numbers = NumberCoder(name)
        self.grid_highest = grid_highest

    def position(self, coder, ring, expected, size, extra, step, around):
        normal, tangent = size
        n = ring.normal
        order = sorted(range(3), key=lambda axis: abs(n[axis]))
        v, (r10, r20, r21) = self._errors(ring, order, normal, tangent)
        sigma = exp2_16(tangent)
        position = [0, 0, 0]

        def code(k, m):
            axis = order[k]
            value = (expected[axis] + m) >> step
            scale = ((sigma * isqrt(v[k] << 24)) >> 24) >> step
            near = 15 if around is None else min(14, hint(around[0 if k == 2 else 1], -128, 8))
            hints = (hint(abs(n[axis]), 0, 1025), near, 4 * extra + hint(tangent - normal, -16, 32) // 4)
            number = self.numbers.number(coder, value, scale, k, hints)
            position[axis] = number << step
            must(0 <= position[axis] <= self.grid_highest, "a vertex is not on the grid")
            return clamp(16 * position[axis] - expected[axis], -(1 << 26), 1 << 26)

        e0 = code(0, 0)
        m = clamp(prod(e0, r10), -(1 << 26), 1 << 26)
        e1 = code(1, m)
        code(2, prod(e0, r20) + prod(e1 - m, r21))
        return tuple(position)

    @staticmethod
    def _errors(ring, order, normal, tangent):
        """The variances of the axes in order, each for what those before leave, and how they go along with these."""
        n = ring.normal
        factor = exp2_16(clamp(2 * (normal - tangent), -192, 32) + 384)

        def covariance(i, j):
            a = (n[i] * n[j]) >> 4
            b = ((1 << 24) if i == j else 0) - a
            return ((a * factor) >> 24) + ((b * 20 + ring.spread[i][j] * 236) >> 8)

        def ratio(x, y):
            return clamp(cut(x << 24, y), -(1 << 32), 1 << 32)

        x, y, z = order
        xy, xz = covariance(x, y), covariance(x, z)
        v0 = max(covariance(x, x), 1024)
        r10, r20 = ratio(xy, v0), ratio(xz, v0)
        v1 = max(covariance(y, y) - prod(xy, r10), 1024)
        yz = covariance(y, z) - prod(xz, r10)
        r21 = ratio(yz, v1)
        v2 = max(covariance(z, z) - prod(xz, r20) - prod(yz, r21), 1024)
        return (v0, v1, v2), (r10, r20, r21)


def prod(x, r):
    return (x * r) >> 24


class Shift:
    """A fit along a ring's normal and one across it: they tell from pulls where a vertex is."""

    def __init__(self, normal, tangent):
        self.normal = fit(*normal, trust=1 << 17)
        self.tangent = fit(*tangent, trust=1 << 17)

    def expect(self, ring, features):
        along_normal, across = features
        shift = times(ring.normal, self.normal.predict(along_normal))
        shift = add(shift, tuple(self.tangent.predict(f) for f in across))
        return shifted(scaled(shift, ring.radius), 8)

    def learn(self, ring, features, went):
        along_normal, across = features
        target, rest = ring.parts(went)
        self.normal.learn(along_normal, target)
        for f, t in zip(across, rest):
            self.tangent.add(f, t)
        self.tangent.end_sample()


def features_of(ring, pulls):
    """Of each pull its part along the normal; and for each coordinate the parts across."""
    parts = [ring.parts(pull) for pull in pulls]
    return [a for a, _ in parts], [[rest[c] for _, rest in parts] for c in range(3)]


class VertexShapes:
    """Positions of new vertices."""

    def __init__(self, grid_highest):
        self.coordinates = Coordinates("positions", grid_highest)
        self.shifts = [Shift((-600, 0, 0, 1200), (-800, 0, 0, 0)) for _ in range(4)]
        self.normal_size = fit(0, 2048, 1024, 1024, size=9, trust=1 << 14)
        self.tangent_size = fit(0, 2048, 0, 2048, size=9, trust=1 << 14)
        self.misses = {}  # of vertices of no base mesh, once coded

    def note_loose(self, v):
        self.misses[v] = UNKNOWN

    def position(self, coder, v, around, normals, step):
        """Where vertex v is; `around` has the level, its outer half-edges, and whether they are closed."""
        ring = Ring(*around, normals)
        found = [self.misses[x] for x in ring.corners + ring.beyond if x in self.misses]
        around = mean_of(found) if found else UNKNOWN
        shift = self.shifts[clamp(ring.size - 4, 0, 3) if ring.closed else 0]
        features = features_of(ring, ring.pulls)
        expected = add(ring.mean, shift.expect(ring, features))
        size_log = log2_16(ring.radius)
        traits = self._traits(ring, features, around)
        size = tuple(clamp(size_log + f.predict(t), 16, 320) for f, t in zip((self.normal_size, self.tangent_size), traits))
        extra = clamp(ring.size - 3, 0, 3)
        position = self.coordinates.position(coder, ring, expected, size, extra, step, around if found else None)
        point = scaled(position, 16)
        shift.learn(ring, features, sub(point, ring.mean))
        miss = ring.miss(sub(point, expected))
        self.normal_size.learn(traits[0], miss[0])
        self.tangent_size.learn(traits[1], miss[1])
        self.misses[v] = miss
        return position

    @staticmethod
    def _traits(ring, features, around):
        normal, across = features

        def size_across(k):
            return sum(abs(f[k]) for f in across)

        base = log2_16(ring.radius)
        tail = [ring.log_least - base, ring.log_edge - base, ring.log_beyond - base]
        shared = [around[1], 64 - base, log(size_across(0)) - 64, *tail]
        return (
            [64, around[0], log(normal[0]) - 64, *shared],
            [64, around[0], log(size_across(2) + abs(normal[2])) - 64, *shared],
        )


class MoveShapes:
    """Section 9.4: where vertices move to, at most once a stage."""

    def __init__(self, grid_highest):
        self.grid_highest = grid_highest
        self.coordinates = Coordinates("moves", grid_highest)
        self.bare = NumberCoder("bare")
        self.shift = Shift((0, 0, 0, 0), (0, 0, 0, 0))
        self.normal_size = fit(0, 2048, 0, 1024, 0, 0, trust=1 << 14)
        self.tangent_size = fit(0, 2048, 0, 0, 1024, 0, trust=1 << 14)
        self.begin_stage()

    def begin_stage(self):
        self.moved = {}  # vertex to its miss, and how far it went

    def position(self, coder, level, v, half, normals, old, new):
        """Where vertex v goes, seen from half-edge `half` (NONE: it has no faces), from grid 2^old to 2^new."""
        start = scaled(level.positions[v], 16)
        if half == NONE:
            return bare_position(self.bare, coder, start, old, new, self.grid_highest)
        ring = Ring(level, *outer_ring(level, half), normals)
        found = [self.moved[x] for x in ring.corners if x in self.moved]
        around = mean_of([miss for miss, _ in found]) if found else None
        went = div_each(total(way for _, way in found), len(found)) if found else ZERO
        features = features_of(ring, [sub(ring.mean, start), ring.pulls[0], ring.pulls[3], went])
        expected = add(start, self.shift.expect(ring, features))
        base = log2_16(ring.radius)
        s = 16 * old + 64
        near = around or (s - 24 - base, s - 24 - base)
        traits = [64, s - base, log(features[0][0]) - 64, *near, 0 if found else 64]
        size = tuple(clamp(base + f.predict(traits), 16, 320) for f in (self.normal_size, self.tangent_size))
        position = self.coordinates.position(coder, ring, expected, size, 1 if ring.closed else 0, new, around)
        way = sub(scaled(position, 16), start)
        self.shift.learn(ring, features, way)
        miss = ring.miss(sub(scaled(position, 16), expected))
        self.normal_size.learn(traits, miss[0])
        self.tangent_size.learn(traits, miss[1])
        self.moved[v] = miss, way
        return position


def bare_position(numbers, coder, start, old, new, grid_highest):
    """Where a vertex without faces moves to."""
    found = [numbers.number(coder, c >> new, max(1, (16 << old) >> new)) for c in start]
    position = tuple(number << new for number in found)
    must(all(0 <= c <= grid_highest for c in position), "a vertex moves off the grid")
    return position


def outer_ring(level, g):
    """The outer half-edges of the star around the vertex that g leaves, and whether it is closed."""
    twins = level.twins
    f, closed = g, True
    for _ in range(256):
        if twins[f] == NONE:
            closed = False
            break
        f = next_of(twins[f])
        if f == g:
            break
    if closed:
        f = g
    first, outer = f, []
    while len(outer) < 256:
        outer.append(next_of(f))
        f = twins[prev_of(f)]
        if f == NONE:
            closed = False
            break
        if f == first:
            closed = True
            break
    return outer, closed
