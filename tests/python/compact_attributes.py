"""Section 10 of docs/compact-stream.md: attributes of wedges."""

from math import isqrt

from compact_coding import (
    ZERO, Bits, NumberCoder, add, along, clamp, cross, cut, cut_each, div, dot, exp2_16, fit, hint, length, log, must, scaled,
    shifted, shorten, steepest, sub, times, total, unit, width,
)  # fmt: skip
from compact_header import DIRECTIONS, NUMBERS, TEXTURE, WEIGHTS
from compact_level import NONE, prev_of


class Around:
    """What is around a wedge when its attributes are coded."""

    def __init__(self, level, w, faces, beside, normals):
        self.level, self.wedge, self.beside, self.normals = level, w, beside, normals
        corners = level.corner_wedge
        self.faces = [f for f in faces if corners[3 * f] == w][:256]
        self.ring = list(dict.fromkeys(corners[3 * f + k] for f in self.faces for k in (1, 2)))[:256]

    def points(self, f):
        return [self.level.positions[v] for v in self.level.corner_vertex[3 * f : 3 * f + 3]]

    def edges(self, f):
        """Of face f: from its first corner to the second, and to the third."""
        p = self.points(f)
        return sub(p[1], p[0]), sub(p[2], p[0])

    def surface(self):
        """The sum of its faces' normals, not longer than 2^24."""
        return shorten(total(cross(*self.edges(f)) for f in self.faces), 24)[0]

    def position(self, w):
        return self.level.positions[self.level.wedge_vertex[w]]


class AttributeModel:
    """The numbers of an attribute, by wedges, and what all codings have. `wedges[w]` are those of wedge w."""

    FIRST_MISS = None  # what wedges have that are not coded by the models, if they have misses

    def __init__(self, attribute):
        self.attribute = attribute
        self.wedges = []
        self.misses = []
        self.same = Bits(attribute.name + " same", 4)
        self.common = Bits(attribute.name + " common", 72)
        self.last_common = 0
        self.coder = NumberCoder(attribute.name)
        self.alone = NumberCoder(attribute.name + " alone")
        self.lowest, self.highest = attribute.lowest, attribute.highest

    def decode(self, coder, around):
        """Numbers of the next wedge."""
        must(around.wedge == len(self.wedges), "wedges are not coded in order")
        numbers = self._same(coder, around) or self._common(coder, around)
        miss = self._miss_of_copy(around.wedge)
        if numbers is None:
            numbers, miss = self._numbers(coder, around)
            must(all(self.lowest <= n <= self.highest for n in numbers), f"{self.attribute.name}: a number is out of range")
        self.wedges.append(tuple(numbers))
        self.misses.append(miss)

    def _miss_of_copy(self, _):
        return self.FIRST_MISS

    def _same(self, coder, around):
        w = around.wedge
        vertices = around.level.wedge_vertex
        for i in range(4):
            before = w - 1 - i
            if before < 0 or vertices[before] != vertices[w]:
                return None
            if self.same(coder, i):
                return self.wedges[before]
        return None

    def _common(self, coder, around):
        found = [self.wedges[r] for r in around.ring]
        most, common = 0, None
        counts = {}
        for i in range(len(found) - 1, -1, -1):
            counts[found[i]] = counts.get(found[i], 0) + 1
            if counts[found[i]] >= most:
                most, common = counts[found[i]], found[i]
        if most < 2:
            return None
        context = 2 * (min(most - 2, 5) * 6 + min(len(found) - most, 5)) + self.last_common
        self.last_common = self.common(coder, context)
        return common if self.last_common else None

    def _beside(self, around):
        return None if around.beside is None else self.wedges[around.beside]

    def _middle(self):
        return self.lowest + cut(self.highest - self.lowest, 2)


class NumberModel(AttributeModel):
    """Section 10.1."""

    def __init__(self, attribute):
        super().__init__(attribute)
        self.usual = [256] * attribute.components

    def _numbers(self, coder, around):
        numbers, off = [], 0
        for c in range(self.attribute.components):
            if around.ring:
                number, off = self._from_ring(coder, c, [self.wedges[r][c] for r in around.ring], off)
            else:
                beside = self._beside(around)
                value = 16 * (self._middle() if beside is None else beside[c])
                number = self.alone.number(coder, value, max(16, cut(self.highest - self.lowest, 2)), min(c, 3))
            numbers.append(number)
        return numbers, None

    def _from_ring(self, coder, c, found, off):
        n, usual = len(found), self.usual[c]
        mean = div(16 * sum(found), n)
        spread = sum(abs(16 * number - mean) for number in found) // n
        hints = (
            0 if spread == 0 else 1 + hint(log(spread), 0, 16) * 14 // 15,
            hint(log(usual), 0, 16),
            (8 if spread == 0 else 0) + off,
        )
        number = self.coder.number(coder, mean, (spread + usual) // 2 + 1, min(c, 3), hints)
        miss = abs(16 * number - mean)
        self.usual[c] += cut(min(miss, 16 * usual + 256) - usual, 16)
        return number, 2 if miss > 8 else 1


class DirectionModel(AttributeModel):
    """Section 10.2. `normals`: the attribute of directions of three components, `texture`: that of coordinates, or None."""

    FIRST_MISS = 160

    def __init__(self, attribute, normals, texture):
        super().__init__(attribute)
        self.four = attribute.components == 4
        self.normals, self.texture = normals, texture
        self.signs = Bits(attribute.name + " signs", 16)
        self.pulls = fit(0, 0, 0, 0, trust=1 << 17)
        self.sizes = fit(0, 2048, 1024, 1024, size=8, trust=1 << 14)

    def _miss_of_copy(self, w):
        return self.misses[w - 1] if w else 160

    def direction(self, w):
        return unit(self.wedges[w][:3])

    def _numbers(self, coder, around):
        if around.ring:
            return self._from_ring(coder, around)
        beside = self._beside(around)
        sign = self._sign(coder, 7 if beside is not None and beside[3] > 0 else 8) if self.four else []
        expected = ZERO if beside is None else self.direction(around.beside)
        return self._point(coder, expected, 192, 2) + sign, 160

    def _from_ring(self, coder, around):
        ring, w = around.ring, around.wedge
        n = len(ring)
        mean = unit(total(map(self.direction, ring)))
        guesses, spread, mirrored = self._of_four(around, mean) if self.four else self._of_three(around)
        own, even, _, surface = guesses
        features = [[cut(g[c] - own[c], 4) for g in (mean, *guesses[1:])] for c in range(3)]
        expected = unit(add(own, tuple(4 * self.pulls.predict(f) for f in features)))
        turn = sum(length(sub(self.direction(r), mean)) for r in ring)
        off = sum(length(sub(self.direction(r), own if self.four else around.normals[r])) for r in ring)
        traits = [
            64,
            cut(sum(self.misses[r] for r in ring), n),
            log(length(sub(mean, own))),
            log(spread),
            log(turn // n),
            log(length(sub(even, own))),
            log(off // n),
            log(length(sub(surface, own))),
        ]
        error = clamp(self.sizes.predict(traits), 16, 224)
        sign = self._sign(coder, self._sign_context(ring, mirrored)) if self.four else []
        numbers = self._point(coder, expected, error, 0)
        found = unit(numbers)
        for f, difference in zip(features, sub(found, own)):
            self.pulls.add(f, cut(difference, 4))
        self.pulls.end_sample()
        miss = log(length(sub(found, expected)) + 16384 // (4 * self.highest))
        self.sizes.learn(traits, miss)
        return numbers + sign, miss

    def _of_three(self, around):
        """own, even, third, surface; spread; mirrored."""
        edges = [around.edges(f) for f in around.faces]
        normals = [unit(cross(a, b)) for a, b in edges]
        own = around.normals[around.wedge]
        angles = [length(sub(unit(a), unit(b))) >> 4 for a, b in edges]
        third = unit(total(scaled(normal, angle) for normal, angle in zip(normals, angles)))
        surface = unit(total(around.normals[r] for r in around.ring))
        spread = sum(length(sub(normal, own)) for normal in normals) // max(1, len(normals))
        return (own, unit(total(normals)), third, surface), spread, False

    def _of_four(self, around, mean):
        normal = self.normals.direction(around.wedge) if self.normals else around.normals[around.wedge]

        def on(v):
            return unit(sub(v, times(normal, along(v, normal))))

        surface = on(mean)
        if not self.texture:
            return (surface,) * 4, 0, False
        gradients, turns = zip(*[self._gradient(around, f) for f in around.faces])
        whole = total(gradients)
        mirrored = sum(turns) < 0
        if whole == ZERO:
            return (surface,) * 4, 0, mirrored
        own, even, third = on(unit(whole)), on(unit(total(map(unit, gradients)))), unit(whole)
        return (own, even, third, surface), length(sub(third, own)), mirrored

    def _gradient(self, around, f):
        """Where texture coordinates say that the tangent goes in a face, and 1, or -1 where they are mirrored."""
        (u0, v0), (u1, v1), (u2, v2) = [self.texture.wedges[w] for w in around.level.corner_wedge[3 * f : 3 * f + 3]]
        a, b = around.edges(f)
        turn = 1 if (u1 - u0) * (v2 - v0) > (u2 - u0) * (v1 - v0) else -1
        return scaled(sub(scaled(a, v2 - v0), scaled(b, v1 - v0)), turn), turn

    def _sign_context(self, ring, mirrored):
        positive = sum(self.wedges[r][3] > 0 for r in ring)
        return (4 if positive == 0 else 5 if positive == len(ring) else 6) + (5 if mirrored else 0)

    def _sign(self, coder, context):
        return [1 if self.signs(coder, context) else -1]

    def _point(self, coder, expected, error, base):
        size = sum(map(abs, expected))
        scale = max(1, exp2_16(error) * 16 * self.highest // max(size, 16384))
        return self._octahedron(coder, expected, scale, base, (hint(error, 0, 14), hint(size >> 10, 16, 1)))[0]

    def _octahedron(self, coder, expected, scale, base, hints):
        """The numbers, and how far the two that are coded were off altogether."""
        size = sum(map(abs, expected))
        top = 2
        for c in (1, 0):
            if abs(expected[c]) > abs(expected[top]):
                top = c
        point = (0, 0, 16 * self.highest) if size == 0 else cut_each(scaled(expected, 16 * self.highest), size)
        rest, off = self.highest, 0
        numbers, h2 = [0, 0, 0], 0
        for i in (1, 2):
            c = (top + i) % 3
            numbers[c] = self.coder.number(coder, point[c], scale, base + i - 1, (*hints, h2))
            rest -= abs(numbers[c])
            must(rest >= 0, f"{self.attribute.name}: a direction is not on its octahedron")
            off += abs(16 * numbers[c] - point[c])
            h2 = hint(log(16 * numbers[c] - point[c]), 0, 12)
        same = rest == 0 or self.signs(coder, 1 if rest < self.highest // 4 else 0)
        numbers[top] = rest if (expected[top] >= 0) == bool(same) else -rest
        return numbers, off


class FastDirectionModel(DirectionModel):
    """The same of fast streams."""

    def __init__(self, attribute, normals, texture):
        super().__init__(attribute, normals, texture)
        self.usual = log(attribute.highest)

    def _miss_of_copy(self, _):
        return self.usual

    def _numbers(self, coder, around):
        ring, mirrored = around.ring, False
        if not ring:
            beside = self._beside(around)
            expected, near, base = ZERO if beside is None else beside[:3], self.usual, 2
        else:
            near, base = cut(sum(self.misses[r] for r in ring), len(ring)), 0
            expected, mirrored = self._tangent(around) if self.four else (around.surface(), False)
            if expected == ZERO:
                expected = self._around(ring)
        sign = []
        if self.four:
            beside = self._beside(around)
            alone = 7 if beside is not None and beside[3] > 0 else 8
            sign = self._sign(coder, self._sign_context(ring, mirrored) if ring else alone)
        numbers, off = self._octahedron(coder, expected, exp2_16(near), base, (0, 0))
        return numbers + sign, log(off // 2 + 3)

    def _around(self, ring):
        return shorten(total(self.wedges[r][:3] for r in ring), 24)[0]

    def _tangent(self, around):
        """Where the first texture coordinates grow along the surface, and whether they are mirrored."""
        normal = self.normals.wedges[around.wedge] if self.normals else around.surface()
        whole, turns = ZERO, 0
        if self.texture:
            for f in around.faces:
                gradient, turn = self._gradient(around, f)
                whole, turns = add(whole, gradient), turns + turn
        whole, _ = shorten(self._around(around.ring) if whole == ZERO else whole, 24)
        normal, _ = shorten(normal, 14)
        square = dot(normal, normal)
        if square:
            whole = sub(scaled(whole, square), scaled(normal, dot(whole, normal)))
        return shorten(whole, 24)[0], turns < 0


class TextureModel(AttributeModel):
    """Section 10.3; numbers count 16 each."""

    FIRST_MISS = -32

    def __init__(self, attribute):
        super().__init__(attribute)
        self.pulls = [fit(4096, 0, 0, trust=1 << 17) for _ in range(2)]
        self.sizes = [fit(0, 2048, 0, 2048, size=7, trust=1 << 14) for _ in range(2)]

    def _numbers(self, coder, around):
        if around.ring:
            return self._from_ring(coder, around)
        beside = self._beside(around) or [self._middle()] * 2
        scale = 2 * (self.highest - self.lowest)
        return [self.alone.number(coder, 16 * beside[c], scale, c) for c in range(2)], -32

    def _from_ring(self, coder, around):
        m = len(around.ring)
        points = self._points(around)
        is_open = 1 if m > len(around.faces) else 0
        mean = [div(sum(p[2][c] for p in points[:m]), m) for c in range(2)]
        radius = max(16, sum(abs(p[2][c] - mean[c]) for p in points[:m] for c in range(2)) // m)
        pulls, bend = self._pulls(points, m, mean)
        features = [[cut(pull[c] * 256, radius) for pull in pulls] for c in range(2)]
        expected = [mean[c] + cut(self.pulls[is_open].predict(features[c]) * radius, 256) for c in range(2)]
        base = log(radius)
        near = cut(sum(self.misses[r] for r in around.ring), m)
        sizes = [abs(pull[0]) + abs(pull[1]) for pull in pulls]
        traits = [64, near] + [log(x) - base for x in (sizes[0], bend, 16, sizes[2], sizes[1])]
        error = exp2_16(clamp(base + self.sizes[is_open].predict(traits), 0, 480))
        numbers = self._code(coder, expected, max(error, 1), 2 * is_open, hint(near, -112, 8), hint(log(error), 0, 12))
        for c in range(2):
            self.pulls[is_open].add(features[c], cut((16 * numbers[c] - mean[c]) * 256, radius))
        self.pulls[is_open].end_sample()
        off = sum(abs(16 * numbers[c] - expected[c]) // 2 for c in range(2))
        miss = clamp(log(3 + off) - base, -1000, 1000)
        self.sizes[is_open].learn(traits, miss)
        return numbers, miss

    def _code(self, coder, expected, scale, base, h0, h1):
        numbers, h2 = [], 0
        for c in range(2):
            value = clamp(expected[c], 16 * self.lowest, 16 * self.highest)
            numbers.append(self.coder.number(coder, value, scale, base + c, (h0, h1, h2)))
            h2 = hint(log(abs(16 * numbers[c] - value) + cut(scale, 16)) - log(scale) + 64, 0, 8)
        return numbers

    def _points(self, around):
        """Wedges near by as (x, y, numbers): those of the ring, then those beyond it; x and y are short."""
        level, w = around.level, around.wedge
        own = around.position(w)
        n = unit(total(cross(*around.edges(f)) for f in around.faces))
        d = scaled(sub(around.position(around.ring[0]), own), 16)
        x_axis = unit(sub(d, times(n, along(d, n))))
        y_axis = shifted(cross(n, x_axis), 14)
        found = list(around.ring)
        for f in around.faces:
            t = level.twins[3 * f + 1]
            if t != NONE and not level.seam(3 * f + 1) and level.corner_wedge[prev_of(t)] < w:
                found.append(level.corner_wedge[prev_of(t)])
        points = []
        for r in found:
            e = sub(around.position(r), own)
            points.append((dot(e, x_axis) >> 4, dot(e, y_axis) >> 4, [16 * z for z in self.wedges[r]]))
        s = 0
        while any(abs(x) >> s >= 1024 or abs(y) >> s >= 1024 for x, y, _ in points):
            s += 1
        return [(x >> s, y >> s, z) for x, y, z in points]

    @staticmethod
    def _pulls(points, m, mean):
        """By the plane of the ring, by nearness, and by what the plane of all points says beyond that; the bend of the ring."""
        weights = [(1 << 20) // (16 + isqrt(x * x + y * y)) for x, y, _ in points[:m]]
        pull = [cut(sum(w * (p[2][c] - mean[c]) for w, p in zip(weights, points)), sum(weights)) for c in range(2)]
        near_plane, wide_plane = Plane(points[:m]), Plane(points)
        bend = sum(abs(z[c] - near_plane.at(x, y, c)) for x, y, z in points[:m] for c in range(2)) // m
        near, wide = [[plane.at(0, 0, c) - mean[c] for c in range(2)] for plane in (near_plane, wide_plane)]
        if m < 3:
            near, wide = wide, near
        return (near, pull, [wide[c] - near[c] for c in range(2)]), bend


class Plane:
    """The plane through points (x, y, two numbers) that is nearest to them."""

    LIMIT = 1 << 20

    def __init__(self, points):
        k = len(points)
        self.x, self.y = div(sum(p[0] for p in points), k), div(sum(p[1] for p in points), k)
        self.z = [div(sum(p[2][c] for p in points), k) for c in range(2)]
        near = [(x - self.x, y - self.y, [self.short(z[c] - self.z[c]) for c in range(2)]) for x, y, z in points]
        xx, xy, yy = sum(x * x for x, _, _ in near), sum(x * y for x, y, _ in near), sum(y * y for _, y, _ in near)
        s = 0
        while (xx + yy) >> s >= self.LIMIT:
            s += 1
        r = ((xx + yy) >> (s + 7)) + 1
        xx, xy, yy = (xx >> s) + r, xy >> s, (yy >> s) + r
        self.det = max(xx * yy - xy * xy, 1)
        xz = [sum(x * z[c] for x, _, z in near) >> s for c in range(2)]
        yz = [sum(y * z[c] for _, y, z in near) >> s for c in range(2)]
        self.a = [yy * xz[c] - xy * yz[c] for c in range(2)]
        self.b = [xx * yz[c] - xy * xz[c] for c in range(2)]

    def at(self, x, y, c):
        slope = cut(self.a[c] * (x - self.x) + self.b[c] * (y - self.y), self.det)
        return self.z[c] + self.short(slope)

    def short(self, z):
        return clamp(z, -self.LIMIT, self.LIMIT)


class FastTextureModel(TextureModel):
    """The same of fast streams."""

    def _from_ring(self, coder, around):
        m = len(around.ring)
        plane = Plane(self._points(around))
        for slopes in (plane.a, plane.b):
            slopes[:] = [clamp(slope, -(1 << 51), 1 << 51) for slope in slopes]
        offs = (plane.short(16 * self.wedges[r][c] - plane.z[c]) for r in around.ring for c in range(2))
        base = log(max(16, sum(map(abs, offs)) // m))
        scale = exp2_16(base + cut(sum(self.misses[r] for r in around.ring), m))
        numbers, off = [], 3
        for c in range(2):
            value = clamp(plane.at(0, 0, c), 16 * self.lowest, 16 * self.highest)
            numbers.append(self.coder.number(coder, value, scale, c))
            off += abs(16 * numbers[c] - value) // 2
        return numbers, log(off) - base

    def _points(self, around):
        """Those of the ring, by the two coordinates of positions in which the surface is not steepest."""
        z = steepest(around.surface())
        x, y = [axis for axis in range(3) if axis != z]
        away = [sub(around.position(r), around.position(around.wedge)) for r in around.ring]
        s = max(0, max(width(max(abs(e[x]), abs(e[y]))) for e in away) - 10)
        return [(e[x] >> s, e[y] >> s, [16 * n for n in self.wedges[r]]) for e, r in zip(away, around.ring)]


class WeightModel(AttributeModel):
    """Section 10.4. `sets`: all models of weights, in order; `joints`: the model of the joints they are of, or None."""

    def __init__(self, attribute, sets, joints):
        super().__init__(attribute)
        self.sets, self.joints = sets, joints
        self.usual = 256

    def _numbers(self, coder, around):
        w = around.wedge
        earlier = self.sets[: self.sets.index(self)]
        rest = self.highest - sum(sum(model.wedges[w]) for model in earlier)
        must(rest >= 0, f"{self.attribute.name}: weights are more than 1")
        numbers = []
        for c in range(self.attribute.components):
            if self is self.sets[-1] and c == self.attribute.components - 1:
                number = rest
            elif rest == 0:
                number = 0
            else:
                number = self._number(coder, around, c, rest)
            numbers.append(number)
            rest -= number
        return numbers, None

    def _number(self, coder, around, c, rest):
        value = min(self._expected(around, c), 16 * rest)
        slack = min(value, 16 * rest - value)
        scale = max(8, cut(min(slack, 2 * self.usual), 2) + self.usual // 8)
        h2 = hint(log(self.usual), 0, 12) // 2 if around.ring else 15
        hints = (hint(log(slack), 0, 12), hint(log(value), 0, 12), h2)
        number = self.coder.number(coder, value, scale, min(c, 3), hints)
        must(0 <= number <= rest, f"{self.attribute.name}: a weight is out of range")
        miss = min(abs(16 * number - value), 16 * self.usual + 16)
        self.usual = max(16, self.usual + cut(miss - self.usual, 16))
        return number

    def _expected(self, around, c):
        if not around.ring:
            beside = self._beside(around)
            return 0 if beside is None else 16 * beside[c]
        if not self.joints:
            return 0
        joint = self.joints.wedges[around.wedge][c]
        sum_ = 0
        for r in around.ring:
            for model in self.sets:
                if model.joints:
                    sum_ += sum(weight for weight, j in zip(model.wedges[r], model.joints.wedges[r]) if j == joint)
        return div(16 * sum_, len(around.ring))


class Attributes:
    """All attributes of a stream: their models, and the order in which a wedge's are coded."""

    def __init__(self, attributes, fast):
        models = {}
        texture_model = FastTextureModel if fast else TextureModel
        direction_model = FastDirectionModel if fast else DirectionModel
        for attribute in attributes:
            if attribute.coding == NUMBERS:
                models[attribute] = NumberModel(attribute)
            elif attribute.coding == TEXTURE:
                models[attribute] = texture_model(attribute)

        def first(coding, components):
            return next((models[a] for a in attributes if a.coding == coding and a.components == components), None)

        texture = first(TEXTURE, 2)
        for components in (3, 4):
            for attribute in attributes:
                if attribute.coding == DIRECTIONS and attribute.components == components:
                    normals = first(DIRECTIONS, 3) if components == 4 else None
                    models[attribute] = direction_model(attribute, normals, texture)
        sets = []
        for attribute in attributes:
            if attribute.coding == WEIGHTS:
                sets.append(WeightModel(attribute, sets, self._joints_of(attribute, models)))
                models[attribute] = sets[-1]
        self.in_order = list(models.values())
        self.by_header = [models[attribute] for attribute in attributes]

    @staticmethod
    def _joints_of(attribute, models):
        if not attribute.name.startswith("WEIGHTS_"):
            return None
        name = "JOINTS_" + attribute.name[len("WEIGHTS_") :]
        fitting = [
            models[a] for a in models if a.coding == NUMBERS and a.name == name and a.components == attribute.components
        ]
        return fitting[-1] if fitting else None

    def decode_base(self, coder, level):
        """All wedges of the base mesh."""
        beside = [w - 1 for w in range(level.wedge_count)]
        shared = [NONE] * level.wedge_count
        for f in range(level.face_count):
            wedges = level.corner_wedge[3 * f : 3 * f + 3]
            for w in wedges:
                shared[w] = max([shared[w]] + [x for x in wedges if x < w])
        for w in range(level.wedge_count):
            if shared[w] != NONE:
                beside[w] = shared[w]
            self._decode_wedge(coder, Around(level, w, [], beside[w] if w else None, None))

    def decode(self, coder, level, stars):
        """The wedges of new vertices: (vertex, the faces of its star)."""
        if not self.in_order or not stars:
            return
        normals = level.wedge_normals()
        for v, faces in stars:
            for w in level.wedges_of(v):
                self._decode_wedge(coder, Around(level, w, faces, w - 1 if w else None, normals))

    def _decode_wedge(self, coder, around):
        for model in self.in_order:
            model.decode(coder, around)
