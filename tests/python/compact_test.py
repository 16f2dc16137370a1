#!/usr/bin/env python3
"""Holds the decoder beside it to the golden files of compact streams, and to what it has to refuse.

usage: compact_test.py FOLDER

FOLDER is tests/golden/compact-3.0 or compact-3.1. Prints what differs, by file and chunk, and exits with 1 then.
"""

import struct
import sys
from pathlib import Path

from compact_coding import Refused
from compact_decoder import decode, line_of
from compact_header import Header, checksum


class Test:
    def __init__(self, folder):
        self.streams = {path.stem: path.read_bytes() for path in sorted(folder.glob("*.lods"))}
        self.folder = folder
        self.failures = 0

    def expect(self, holds, what):
        if not holds:
            print(f"FAILED: {what}")
            self.failures += 1

    # Golden files.

    def golden(self, name):
        text = (self.folder / f"{name}.txt").read_text()
        expected = [line for line in text.splitlines() if not line.startswith("#")]
        found, refused = lines_of(self.streams[name])
        self.expect(refused is None, f"{name}: it is refused: {refused}")
        self.expect(len(found) == len(expected), f"{name}: {len(found)} chunks, where the text has {len(expected)}")
        for chunk, (line, wanted) in enumerate(zip(found, expected)):
            self.expect(line == wanted, f"{name}: chunk {chunk} leads to\n  {line}\nwhere the text has\n  {wanted}")

    def bits(self, name):
        """The first bit that differs from those of the file's table."""
        table = [line.split("\t") for line in (self.folder / f"{name}.tsv").read_text().splitlines()[1:]]
        found = []

        def note(model, contexts, selector, p, bit):
            told = ",".join(map(str, contexts)), "" if model == "raw" else str(selector)
            found.append([str(len(found)), model, *told, str(p), str(bit)])

        for _ in decode(self.streams[name], note):
            pass
        self.expect(len(found) == len(table), f"{name}: {len(found)} bits, where the table has {len(table)}")
        differ = next((i for i, (bit, wanted) in enumerate(zip(found, table)) if bit != wanted), None)
        self.expect(differ is None, f"{name}: bit {differ} differs from that of the table")

    # What is to be refused.

    def refused(self, data, what, because=""):
        _, why = lines_of(data)
        self.expect(why is not None, f"{what}: it is not refused")
        self.expect(why is None or because in why, f"{what}: it is refused for another reason: {why}")

    def flipped(self, name):
        """Any byte changed is refused."""
        data = self.streams[name]
        for at in range(len(data)):
            self.refused(data[:at] + bytes([data[at] ^ 0x10]) + data[at + 1 :], f"{name} with byte {at} changed")

    def cut(self, name):
        """Cut off after a chunk it leads to the level there, and anywhere else it is refused behind the same chunks."""
        data = self.streams[name]
        whole, _ = lines_of(data)
        ends = ends_of(data)
        for size in [*ends, *(end - 1 for end in ends), *(end + 1 for end in ends), ends[0] // 2, 15, 8, 0]:
            complete = sum(end <= size for end in ends)
            found, why = lines_of((data + b"\0")[:size])
            self.expect((why is None) == (size in ends), f"{name} cut off at {size}: {why}")
            self.expect(size > len(data) or found == whole[:complete], f"{name} cut off at {size}: other levels")

    def edited(self, name, what, because, edit):
        """A header with another field, and the right checksum."""
        self.refused(with_header(self.streams[name], edit), f"{name} with {what}", because)

    def broken_chunks(self, name, tries):
        """A chunk of other bytes with the right checksum is refused or leads elsewhere: nothing else may happen."""
        data = self.streams[name]
        begin, end = Header(data).bytes, ends_of(data)[0]
        refusals = 0
        for i in range(tries):
            at = begin + (i * 7919) % (end - begin)
            broken = with_chunk_byte(data, at, data[at] ^ (1 + (i * 101) % 255))
            refusals += lines_of(broken)[1] is not None
        self.expect(refusals > 0, f"{name}: none of {tries} broken chunks is refused")


def lines_of(data):
    """The lines of the chunks that stand, and why the next one, or the stream, is refused; None if it is not."""
    found = []
    try:
        for chunk, decoder in decode(data):
            found.append(line_of(decoder, chunk))
    except Refused as why:
        return found, str(why)
    return found, None


def ends_of(data):
    header = Header(data)
    ends, at = [], header.bytes
    for chunk in header.chunks:
        at += chunk.bytes
        ends.append(at)
    return ends


def with_header(data, edit):
    size = Header(data).bytes
    header = bytearray(data[: size - 4])
    edit(header)
    return bytes(header) + struct.pack("<I", checksum(header)) + data[size:]


def with_chunk_byte(data, at, byte):
    """Of a stream whose header has nothing behind the checksum of its only chunk."""
    broken = data[:at] + bytes([byte]) + data[at + 1 :]
    size = Header(data).bytes

    def edit(header):
        header[-4:] = struct.pack("<I", checksum(broken[size:]))

    return with_header(broken, edit)


def setting(at, byte):
    def edit(header):
        header[at] = byte

    return edit


def main(folder):
    test = Test(Path(folder))
    test.expect(len(test.streams) >= 14, f"{folder} has {len(test.streams)} streams")
    for name in test.streams:
        test.golden(name)
    if (test.folder / "triangle.tsv").exists():
        test.bits("triangle")
    test.flipped("triangle")
    for name in ("closed", "triangle"):
        test.cut(name)
    # Offsets are those of section 12 of the document.
    test.edited("triangle", "version 4", "version 4", setting(8, 4))
    test.edited("triangle", "a grid of 17 bits", "grid", setting(16, 17))
    test.edited("triangle", "flags of 4", "flags", setting(17, 4))
    test.edited("triangle", "a range that is no number", "grid", setting(33, 0x7F))
    test.edited("triangle", "no groups", "groups", setting(34, 0))
    test.edited("triangle", "a group of 2 faces", "chunk 0", setting(36, 2))
    test.edited("triangle", "65 attributes", "attributes", setting(37, 65))
    test.edited("triangle", "fewer base vertices", "chunk 0", setting(38, 2))
    test.edited("triangle", "a base mesh too large for its chunk", "base mesh", setting(39, 127))
    test.edited("triangle", "two chunks, where it has fields of one", "fields", setting(48, 2))
    test.edited("triangle", "2 rounds of 1 record", "rounds", setting(50, 2))
    test.edited("triangle", "one added face", "chunk 0", setting(52, 2))
    test.edited("triangle", "another deviation's code", "deviation", setting(54, 7))
    for name in ("vertex", "triangle", "pieces", "sheets"):
        test.broken_chunks(name, 24)
    print(f"{len(test.streams)} streams: {test.failures or 'no'} failures")
    sys.exit(1 if test.failures else 0)


if __name__ == "__main__":
    main(*sys.argv[1:]) if len(sys.argv) == 2 else sys.exit(__doc__)
