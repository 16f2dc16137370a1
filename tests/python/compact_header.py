"""Section 2 of docs/compact-stream.md: the header and its directory of chunks, checksums, and what numbers stand for."""

import math
import struct

from compact_coding import Refused, float_bits, must, rounded

MASK = (1 << 64) - 1
PRIMES = (0x9E3779B185EBCA87, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x85EBCA77C2B2AE63, 0x27D4EB2F165667C5)


def rotated(x, bits):
    return ((x << bits) | (x >> (64 - bits))) & MASK


def xxh64_round(sum_, lane):
    return rotated((sum_ + lane * PRIMES[1]) & MASK, 31) * PRIMES[0] & MASK


def xxh64(data):
    """XXH64 of seed 0."""
    size, at = len(data), 0
    if size >= 32:
        sums = [(PRIMES[0] + PRIMES[1]) & MASK, PRIMES[1], 0, -PRIMES[0] & MASK]
        for at in range(0, size - 31, 32):
            sums = [xxh64_round(s, lane) for s, lane in zip(sums, struct.unpack_from("<4Q", data, at))]
        at += 32
        result = sum(rotated(s, bits) for s, bits in zip(sums, (1, 7, 12, 18))) & MASK
        for s in sums:
            result = ((result ^ xxh64_round(0, s)) * PRIMES[0] + PRIMES[3]) & MASK
    else:
        result = PRIMES[4]
    result = (result + size) & MASK
    while at + 8 <= size:
        result ^= xxh64_round(0, struct.unpack_from("<Q", data, at)[0])
        result = (rotated(result, 27) * PRIMES[0] + PRIMES[3]) & MASK
        at += 8
    if at + 4 <= size:
        result ^= struct.unpack_from("<I", data, at)[0] * PRIMES[0] & MASK
        result = (rotated(result, 23) * PRIMES[1] + PRIMES[2]) & MASK
        at += 4
    for byte in data[at:]:
        result ^= byte * PRIMES[4] & MASK
        result = rotated(result, 11) * PRIMES[0] & MASK
    for shift, prime in ((33, PRIMES[1]), (29, PRIMES[2])):
        result = (result ^ (result >> shift)) * prime & MASK
    return result ^ (result >> 32)


def checksum(data):
    return xxh64(data) & 0xFFFFFFFF


class Reader:
    """Takes fields from bytes, and refuses to go beyond them."""

    def __init__(self, data, at, end):
        self.data, self.at, self.end = data, at, end

    def take(self, count):
        must(self.at + count <= self.end, "its fields go beyond the end of the header")
        self.at += count
        return self.data[self.at - count : self.at]

    def fields(self, kinds):
        return struct.unpack("<" + kinds, self.take(struct.calcsize("<" + kinds)))

    def field(self, kind):
        return self.fields(kind)[0]

    def varint(self):
        number = 0
        for i in range(9):
            byte = self.take(1)[0]
            number |= (byte & 127) << (7 * i)
            if byte < 128:
                return number
        raise Refused("a varint of the header has more than nine bytes")

    def count(self, what, low, high):
        number = self.varint()
        must(low <= number <= high, f"{what}: {number}, where {low} to {high} are allowed")
        return number


def zigzag(z):
    return -(z // 2) - 1 if z % 2 else z // 2


MAGIC = bytes.fromhex("894C44530D0A1A0A")
COUNT_LIMIT = (1 << 30) - 1

NUMBERS, DIRECTIONS, TEXTURE, WEIGHTS = range(4)  # codings
U32, F32 = 5125, 5126
INTEGERS = {5120: ("b", -128, 127), 5121: ("B", 0, 255), 5122: ("h", -32768, 32767), 5123: ("H", 0, 65535),
            U32: ("I", -(1 << 31), (1 << 31) - 1)}  # fmt: skip


class Attribute:
    """What the header says of an attribute: name, type, and the whole numbers, `lowest` to `highest`, that stand for it."""

    def __init__(self, reader):
        self.name = reader.take(reader.count("bytes of an attribute's name", 0, 255)).decode("utf-8", "replace")
        self.type, self.components, self.normalized, self.coding, self.bits = reader.fields("HBBBB")
        self.floats = self.type == F32
        self._check()
        if self.floats:
            self.lowest, self.highest = 0, (1 << self.bits) - 1
            if self.coding == DIRECTIONS:
                self.highest = (1 << (self.bits - 1)) - 1
                self.lowest = -self.highest
            else:
                self._read_ranges(reader)
        else:
            _, self.lowest, self.highest = INTEGERS[self.type]

    def _check(self):
        must(self.floats or self.type in INTEGERS, f"attribute {self.name}: no component type {self.type}")
        must(1 <= self.components <= 16, f"attribute {self.name}: {self.components} components")
        must(self.coding <= WEIGHTS, f"attribute {self.name}: no coding {self.coding}")
        fits = {
            NUMBERS: True,
            DIRECTIONS: self.floats and self.components in (3, 4),
            TEXTURE: self.components == 2 and self.type != U32,
            WEIGHTS: self.floats,
        }[self.coding]
        must(fits, f"attribute {self.name}: coding {self.coding} is not for its type and components")
        bits_fit = 2 <= self.bits <= 24 if self.floats else self.bits == 0
        must(bits_fit, f"attribute {self.name}: {self.bits} bits")

    def _read_ranges(self, reader):
        self.low = reader.fields("f" * self.components)
        self.range = reader.field("f")
        ends = [rounded(low + self.range) for low in self.low]
        finite = all(map(math.isfinite, (*self.low, *ends)))
        must(finite and self.range >= 0, f"attribute {self.name}: its range is not finite")

    def values(self, numbers):
        """The element that the numbers stand for: integers, or floats before they have their rests."""
        if self.coding == DIRECTIONS:
            x, y, z = numbers[:3]
            size = math.sqrt(x * x + y * y + z * z)
            return [rounded(c / size) for c in (x, y, z)] + [1.0 if n > 0 else -1.0 for n in numbers[3:]]
        if self.floats:
            return [rounded(low + n * self.range / self.highest) for n, low in zip(numbers, self.low)]
        return [n + (1 << 31) for n in numbers] if self.type == U32 else numbers

    def bytes_of(self, values):
        """As glTF stores an element; of floats the values are their bits."""
        kind = "I" if self.floats else INTEGERS[self.type][0]
        return struct.pack(f"<{self.components}{kind}", *values)


class ChunkEntry:
    """What the header says of a chunk."""

    def __init__(self, reader):
        self.bytes = reader.count("bytes of a chunk", 0, (1 << 40) - 1)
        self.rounds = reader.count("rounds of a chunk", 0, COUNT_LIMIT)
        self.records = reader.count("records of a chunk", 0, COUNT_LIMIT)
        self.added_faces = 2 * self.records - zigzag(reader.varint())
        self.added_wedges = self.records + zigzag(reader.varint())
        self.deviation_code = reader.field("B")
        self.checksum = reader.field("I")
        must(self.added_faces >= 0 and self.added_wedges >= 0, "a chunk takes faces or wedges away")


ROOTS = [rounded(root) for root in (1, 1.0905077, 1.1892071, 1.2968396, 1.4142135, 1.5422108, 1.6817928, 1.8340081)]


def error_of(code, largest):
    """What code `code` of a scale stands for whose code 255 is `largest`."""
    if code == 0:
        return 0.0
    below = 255 - code
    octaves = (below + 7) // 8
    return rounded(rounded(largest * 2.0**-octaves) * ROOTS[8 * octaves - below])


class Header:
    """All fields of a stream's header, checked."""

    def __init__(self, data):
        must(len(data) >= 16 and data[:8] == MAGIC, "it does not begin with the magic bytes")
        major, _, self.bytes = struct.unpack_from("<HHI", data, 8)
        must(major == 3, f"version {major} is not 3")
        must(20 <= self.bytes <= len(data), "it ends inside its header")
        stored = struct.unpack_from("<I", data, self.bytes - 4)[0]
        must(stored == checksum(data[: self.bytes - 4]), "its header has another checksum than it says")
        reader = Reader(data, 16, self.bytes - 4)
        self._read_grid(reader)
        group_count = reader.count("groups", 1, 65536)
        self.groups = [(reader.count("material", 0, (1 << 32) - 1), reader.count("faces of a group", 0, COUNT_LIMIT))
                       for _ in range(group_count)]  # fmt: skip
        self.attributes = [Attribute(reader) for _ in range(reader.count("attributes", 0, 64))]
        self.vertices = reader.count("vertices of the base mesh", 0, COUNT_LIMIT)
        self.wedges = reader.count("wedges of the base mesh", 0, COUNT_LIMIT)
        self.largest_deviation, self.largest_curvature = reader.fields("ff")
        for largest in (self.largest_deviation, self.largest_curvature):
            must(math.isfinite(largest) and largest >= 0, "its largest error is not finite, or below 0")
        chunk_count = reader.count("chunks", 1, COUNT_LIMIT)
        self.chunks = []
        for _ in range(chunk_count):  # not reserved: the bytes may not be there
            self.chunks.append(ChunkEntry(reader))
        self._sum_levels()

    def _read_grid(self, reader):
        self.grid_bits, flags = reader.fields("BB")
        must(8 <= self.grid_bits <= 16, f"grid of {self.grid_bits} bits")
        must(flags < 4, f"flags are {flags}")
        self.lossless, self.fast = bool(flags & 1), bool(flags & 2)
        self.origin = reader.fields("fff")
        self.range = reader.field("f")
        ends = [rounded(o + self.range) for o in self.origin]
        must(all(map(math.isfinite, (*self.origin, self.range, *ends))) and self.range > 0, "its grid is not finite")
        self.grid_highest = (1 << self.grid_bits) - 1

    @property
    def faces(self):
        return sum(faces for _, faces in self.groups)

    def _sum_levels(self):
        """The levels that chunks lead to."""
        vertices, wedges, faces = self.vertices, self.wedges, self.faces
        for chunk in self.chunks:
            vertices += chunk.records
            wedges += chunk.added_wedges
            faces += chunk.added_faces
            chunk.level = (vertices, wedges, faces)

    def check_chunk(self, index):
        """Section 3, as far as it needs the header alone."""
        chunk = self.chunks[index]
        must((1 if index else 0) <= chunk.rounds <= chunk.records, f"{chunk.rounds} rounds of {chunk.records} records")
        base_wedges = 0 if index else self.wedges
        base_size = 0 if index else self.vertices + self.wedges + self.faces
        must(base_size <= 8 * chunk.bytes, "its base mesh is larger than its bytes may tell")
        numbers = sum(attribute.components for attribute in self.attributes) * (chunk.added_wedges + base_wedges)
        for count, limit in ((chunk.records, 8), (chunk.added_faces, 16), (chunk.added_wedges, 8), (numbers, 256)):
            must(count <= limit * chunk.bytes, "it has more than its bytes may tell")
        must(max(chunk.level) <= COUNT_LIMIT, "the level after it is too large")

    def position(self, numbers):
        """Floats of a vertex, before they have their rests."""
        return [rounded(o + n * self.range / self.grid_highest) for o, n in zip(self.origin, numbers)]

    def position_step(self):
        return rounded(self.range / self.grid_highest)


def ordered(bits):
    """Section 7.8: a number that grows with the float of these bits."""
    return bits ^ (0xFFFFFFFF if bits >= 1 << 31 else 1 << 31)


def from_ordered(number):
    return number ^ (1 << 31 if number >= 1 << 31 else 0xFFFFFFFF)


def is_finite(bits):
    return bits & 0x7F800000 != 0x7F800000


def order_of(value):
    return ordered(float_bits(value))


def step_of(attribute):
    """The distance of neighbouring numbers of an attribute of floats, as an f32."""
    if attribute.coding == DIRECTIONS:
        return rounded(1 / attribute.highest)
    return rounded(attribute.range / attribute.highest)
