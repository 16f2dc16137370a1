#!/usr/bin/env python3
"""Decodes compact streams by docs/compact-stream.md alone, and prints what each chunk leads to.

usage: compact_decoder.py FILE.lods ...

A line for each chunk, as tests/golden/compact-3.0/README.md has them. A stream that the document says to refuse is named on the
error output, after the lines of the chunks that stand; the exit code is then 1. Written to read, not to be fast: some thousand
vertices take a minute. It shares nothing with the C++ decoder but the document, so where the two agree the document says what
there is to say.
"""

import struct
import sys

from compact_coding import RangeCoder, Refused, must
from compact_header import Header, checksum
from compact_rounds import Decoder


def fnv(data):
    """FNV-1a of 64 bits, as text."""
    sum_ = 0xCBF29CE484222325
    for byte in data:
        sum_ = (sum_ ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return f"{sum_:016x}"


def packed(kind, numbers):
    numbers = list(numbers)
    return struct.pack(f"<{len(numbers)}{kind}", *numbers)


def faces_by_group(level):
    """For each group its faces by slots, each as three wedges with the largest first."""
    groups = [[None] * size for size in level.group_sizes]
    for f in range(level.face_count):
        a, b, c = level.corner_wedge[3 * f : 3 * f + 3]
        largest = max(a, b, c)
        face = (a, b, c) if a == largest else (b, c, a) if b == largest else (c, a, b)
        groups[level.groups[f]][level.slots[f]] = face
    return groups


def faces_checksum(groups):
    return fnv(b"".join(packed("I", [len(faces)]) + packed("I", [w for face in faces for w in face]) for faces in groups))


def line_of(decoder, index):
    """What the golden texts have of a chunk."""
    level = decoder.level
    slots = faces_by_group(level)
    fields = {
        "chunk": index,
        "rounds": decoder.rounds,
        "vertices": level.vertex_count,
        "wedges": level.wedge_count,
        "faces": level.face_count,
    }
    sums = [
        ("positions", fnv(packed("I", [c for position in decoder.positions() for c in position]))),
        ("wedges", fnv(packed("I", level.wedge_vertex))),
        ("faces", faces_checksum([sorted(faces) for faces in slots])),
        ("slots", faces_checksum(slots)),
        ("errors", fnv(packed("f", [e for errors in decoder.errors.values() for e in errors]))),
    ]
    for model in decoder.attributes.by_header:
        sums.append((model.attribute.name, fnv(b"".join(map(model.attribute.bytes_of, decoder.elements(model))))))
    return " ".join(f"{name} {value}" for name, value in [*fields.items(), *sums])


def decode(data, trace=None):
    """Yields the decoder after each chunk, with the chunk's number; raises Refused."""
    header = Header(data)
    must(len(data) <= header.bytes + sum(entry.bytes for entry in header.chunks), "it goes on behind its last chunk")
    must(len(data) > header.bytes or header.chunks[0].bytes == 0, "it has no chunk")
    decoder, at = Decoder(header), header.bytes
    for index, entry in enumerate(header.chunks):
        if index > 0 and at == len(data):
            return
        chunk = data[at : at + entry.bytes]
        must(len(chunk) == entry.bytes, f"it ends inside chunk {index}")
        must(checksum(chunk) == entry.checksum, f"chunk {index} has another checksum than the header says")
        try:
            header.check_chunk(index)
            decoder.decode_chunk(index, RangeCoder(chunk, header.fast, trace))
        except Refused as why:
            raise Refused(f"chunk {index}: {why}") from None
        yield index, decoder
        at += entry.bytes


def main(files):
    if not files:
        sys.exit(__doc__)
    refused = False
    for file in files:
        with open(file, "rb") as opened:
            data = opened.read()
        try:
            for index, decoder in decode(data):
                print(line_of(decoder, index), flush=True)
        except Refused as why:
            print(f"{file}: compact stream: {why}", file=sys.stderr)
            refused = True
    sys.exit(1 if refused else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
