"""Sections 1 and 4 of docs/compact-stream.md: arithmetic, the range coder, and the models that its bits come from."""

import struct
from bisect import bisect_left
from math import isqrt


class Refused(Exception):
    """The document says to refuse this stream, or the rest of it; the message says why."""


def must(holds, why):
    if not holds:
        raise Refused(why)


# Numbers. Python's // and >> round down, as the document's >> does; its / cuts towards zero, here `cut`.


def cut(a, b):
    return a // b if (a >= 0) == (b > 0) else -(-a // b)


def div(a, b):
    return (2 * a + b) // (2 * b)


def clamp(x, low, high):
    return low if x < low else high if x > high else x


def width(x):
    return x.bit_length()


def bucket(x, low, step, count):
    return clamp(cut(x - low, step), 0, count - 1)


def hint(x, low, step):
    return bucket(x, low, step, 16)


LOG = [
    0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 6, 6, 6, 6, 7, 7, 7, 7, 8, 8, 8, 9, 9, 9, 9,
    9, 10, 10, 10, 10, 11, 11, 11, 11, 12, 12, 12, 12, 12, 13, 13, 13, 13, 13, 14, 14, 14, 14, 14, 15, 15, 15, 15, 15, 16, 16, 16,
]  # fmt: skip
EXP = [4096, 4277, 4467, 4664, 4871, 5087, 5312, 5547, 5793, 6049, 6317, 6597, 6889, 7194, 7512, 7845]


def log2_16(x):
    if x < 2:
        return 0
    t = width(x) - 1
    return 16 * t + LOG[(x >> (t - 6) if t >= 6 else x << (6 - t)) & 63]


def log(x):
    return log2_16(abs(x) + 1)


def exp2_16(x):
    x = clamp(x, 0, 640)
    return (EXP[x % 16] << (x // 16)) >> 12


# Vectors are tuples of three numbers.

ZERO = (0, 0, 0)


def add(a, b):
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def sub(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def scaled(a, factor):
    return a[0] * factor, a[1] * factor, a[2] * factor


def shifted(a, bits):
    return a[0] >> bits, a[1] >> bits, a[2] >> bits


def cut_each(a, b):
    return cut(a[0], b), cut(a[1], b), cut(a[2], b)


def div_each(a, b):
    return div(a[0], b), div(a[1], b), div(a[2], b)


def total(vectors):
    x = y = z = 0
    for v in vectors:
        x += v[0]
        y += v[1]
        z += v[2]
    return x, y, z


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def square(a):
    return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]


def length(a):
    return isqrt(square(a))


def shorten(v, bits):
    s = max(0, width(max(abs(v[0]), abs(v[1]), abs(v[2]))) - bits)
    return shifted(v, s), s


def steepest(v):
    """The axis in which it is longest, of equal ones the last."""
    return max(range(3), key=lambda axis: (abs(v[axis]), axis))


def unit(v):
    v, _ = shorten(v, 24)
    n = length(v)
    return ZERO if n == 0 else shifted(scaled(v, (1 << 38) // n), 24)


def along(v, u):
    return dot(v, u) >> 14


def times(u, factor):
    return shifted(scaled(u, factor), 14)


# Floats, for what is given out.


def float_bits(x):
    """The bits of x, rounded to f32; what is too large becomes infinity."""
    try:
        return struct.unpack("<I", struct.pack("<f", x))[0]
    except OverflowError:
        return 0x7F800000 if x > 0 else 0xFF800000


def float_of(bits):
    return struct.unpack("<f", struct.pack("<I", bits))[0]


def rounded(x):
    return float_of(float_bits(x))


# The range coder, section 4.1.


class RangeCoder:
    """Reads the bits of one chunk. `trace`, if given, gets (name of the model, contexts, selector, probability, bit) of each."""

    def __init__(self, data, fast=False, trace=None):
        self.data = data
        self.fast = fast
        self.trace = trace
        self.low = 0
        self.high = 0xFFFFFFFF
        self.code = int.from_bytes(data[:4].ljust(4, b"\0"), "big")
        self.at = 4

    def bit(self, p):
        low, high = self.low, self.high
        span = high - low
        middle = low + (span >> 16) * p + (((span & 65535) * p) >> 16)
        if self.code <= middle:
            bit, high = 1, middle
        else:
            bit, low = 0, middle + 1
        while low >> 24 == high >> 24:
            low = (low << 8) & 0xFFFFFFFF
            high = ((high << 8) & 0xFFFFFFFF) | 255
            following = self.data[self.at] if self.at < len(self.data) else 0
            self.code = ((self.code << 8) & 0xFFFFFFFF) | following
            self.at += 1
        self.low, self.high = low, high
        return bit

    def raw(self, bits):
        number = 0
        for _ in range(bits):
            bit = self.bit(32768)
            if self.trace:
                self.trace("raw", (), 0, 32768, bit)
            number = 2 * number + bit
        return number


# Mixed bits, section 4.2.

CURVE = [
    1, 2, 3, 5, 8, 13, 22, 36, 60, 98, 162, 267, 439, 720, 1179, 1921, 3108, 4971, 7812, 11955, 17625, 24743, 32768, 40793, 47911,
    53581, 57724, 60565, 62428, 63615, 64357, 64816, 65097, 65269, 65374, 65438, 65476, 65500, 65514, 65523, 65528, 65531, 65533,
    65534, 65535,
]  # fmt: skip


def probability(x):
    x = clamp(x, -2815, 2815) + 2816
    i = x // 128
    return CURVE[i] + cut((CURVE[i + 1] - CURVE[i]) * (x % 128), 128)


PROBABILITIES = [probability(x) for x in range(-2815, 2816)]
ODDS = [min(bisect_left(PROBABILITIES, 16 * k + 8) - 2815, 2815) for k in range(4096)]
RATES = [131072 // (2 * seen + 3) for seen in range(61)]


class Mixer:
    """Codes bits, each by the counters of one context for each input. `sizes`: how many contexts the inputs have."""

    def __init__(self, name, sizes, selectors=1):
        self.name = name
        self.one = [[32768] * size for size in sizes]
        self.seen = [bytearray(size) for size in sizes]
        self.weights = [[9830 // len(sizes)] * len(sizes) for _ in range(selectors)]
        self.used = [0] * selectors

    def bit(self, coder, contexts, selector=0):
        weights = self.weights[selector]
        odds = [ODDS[one[context] >> 4] for one, context in zip(self.one, contexts)]
        x = sum([o * w for o, w in zip(odds, weights)]) >> 13
        q = clamp(PROBABILITIES[clamp(x, -2815, 2815) + 2815], 16, 65520)
        bit = coder.bit(q)
        if coder.trace:
            coder.trace(self.name, contexts, selector, q, bit)
        young = self.used[selector] < 60
        error = (65535 * bit - q) >> (1 if young else 2)
        self.used[selector] += young
        for i, context in enumerate(contexts):
            weights[i] = clamp(weights[i] + ((odds[i] * error + 32768) >> 16), -32768, 32767)
            one, seen = self.one[i], self.seen[i]
            if bit:
                one[context] += ((65535 - one[context]) * RATES[seen[context]]) >> 16
            else:
                one[context] -= (one[context] * RATES[seen[context]]) >> 16
            if seen[context] < 30:
                seen[context] += 1
        return bit


class Bits(Mixer):
    """A mixer of one input."""

    def __init__(self, name, size):
        super().__init__(name, [size])

    def __call__(self, coder, context):
        return self.bit(coder, (context,))


class Counters:
    """Bits of a fast stream, each by the counter of its context."""

    def __init__(self, name, size):
        self.name = name
        self.one = [32768] * size
        self.seen = bytearray(size)

    def __call__(self, coder, context):
        one, seen = self.one[context], self.seen[context]
        bit = coder.bit(one)
        if coder.trace:
            coder.trace(self.name, (context,), 0, one, bit)
        self.one[context] += ((65535 - one) * RATES[seen]) >> 16 if bit else -((one * RATES[seen]) >> 16)
        self.seen[context] = min(seen + 1, 60)
        return bit


# Numbers, section 4.3.

STEPS = [5, 11, 18, 26, 36, 48, 64, 86, 118, 170, 256, 450, 1000, 4000]


class NumberCoder:
    """Codes whole numbers near predictions."""

    NODES = 19

    def __init__(self, name):
        nodes = self.NODES
        sizes = [2 * nodes * 24, 8 * nodes * 8, 4 * nodes * 16, 4 * nodes * 16, 16 * nodes * 4]
        self.steps = Mixer(name + " steps", sizes, 4 * nodes)
        self.rest = Mixer(name + " rest", [4 * nodes, 24 * nodes], 2)
        self.counters = Counters(name, 4 * 24 * 20)

    def number(self, coder, value, scale, kind=0, hints=(0, 0, 0)):
        scale = max(scale, 1)
        first = (value + 15) >> 4
        if coder.fast:
            return self._counted(coder, first, scale, kind)
        fraction = (16 * first - value) >> 1
        large = clamp(cut(log2_16(scale) - 16, 8), 0, 23)
        small = clamp(cut(log2_16(scale) - 32, 8), 0, 7)
        side = 0

        def step(node):
            f = 0 if node >= 4 else fraction if side else 7 - fraction
            contexts = (
                (2 * node + (side if small < 7 else 0)) * 24 + large,
                (8 * node + f) * 8 + small,
                (4 * node + kind) * 16 + hints[0],
                (4 * node + kind) * 16 + hints[1],
                (16 * node + hints[2]) * 4 + min(small // 2, 3),
            )
            return self.steps.bit(coder, contexts, 4 * node + kind)

        side = step(0)
        begin, s = 0, 0
        while True:
            if s == 18:
                end = begin + (1 << 34)
                break
            end = max(begin + 1, (scale * STEPS[s] + 128) >> 8) if s < 14 else 2 * begin + 1
            if not step(1 + s):
                break
            begin, s = end, s + 1
        level = 0
        while end - begin > 1:
            middle = begin + (end - begin) // 2
            if level < 2:
                upper = self.rest.bit(coder, (4 * s + level, 24 * s + large), level)
            else:
                upper = coder.raw(1)
            begin, end = (middle, end) if upper else (begin, middle)
            level += 1
        return first + begin if side else first - 1 - begin

    def _counted(self, coder, first, scale, kind):
        """The number of a fast stream."""
        nodes = (24 * kind + clamp(cut(log2_16(scale) - 16, 8), 0, 23)) * 20
        side = self.counters(coder, nodes)
        begin, bits, s = 0, clamp(width(scale) - 7, 0, 31), 1
        while bits < 32 and self.counters(coder, nodes + min(s, 19)):
            begin += 1 << bits
            bits += s >= 8
            s += 1
        begin += coder.raw(bits)
        return first + begin if side else first - 1 - begin


# Running least squares, section 4.4.


class Fit:
    """Learns the weights by which features add up to a target."""

    def __init__(self, start, trust):
        self.start = start
        self.trust = trust
        self.weights = list(start)
        self.products = [[0] * (i + 1) for i in range(len(start))]
        self.targets = [0] * len(start)
        self.samples = 0

    def predict(self, features):
        return (sum([w * f for w, f in zip(self.weights, features)]) + 2048) >> 12

    def add(self, features, target):
        features = [clamp(f, -4096, 4096) for f in features]
        target = clamp(target, -4096, 4096)
        for i, f in enumerate(features):
            row = self.products[i]
            for j in range(i + 1):
                row[j] += f * features[j]
            self.targets[i] += f * target

    def end_sample(self):
        self.samples += 1
        if self.samples > 16 and self.samples % 16 != 0:
            return
        if self.samples >= 8192:
            self.samples //= 2
            self.products = [[cut(p, 2) for p in row] for row in self.products]
            self.targets = [cut(t, 2) for t in self.targets]
        for _ in range(3):
            for i in range(len(self.weights)):
                self._solve(i)

    def learn(self, features, target):
        self.add(features, target)
        self.end_sample()

    def _solve(self, i):
        products = self.products
        rest = 4096 * self.targets[i] + self.trust * self.start[i]
        for j, weight in enumerate(self.weights):
            if j != i:
                rest -= products[max(i, j)][min(i, j)] * weight
        self.weights[i] = clamp(cut(rest, products[i][i] + self.trust), -65536, 65536)


def fit(*start, trust, size=None):
    size = size or len(start)
    return Fit(list(start) + [0] * (size - len(start)), trust)
