#!/usr/bin/env python3
"""Prints what is in evidence and strip files of a bake folder: an independent reader, written from the documents
formats/base/block_file.md, formats/bake/evidence_file.md and formats/bake/strip_file.md alone.

usage: read_bake.py FILE...      exit status 1 if any file is not what the documents say

Python's standard library, and libxxhash and libzstd through ctypes.
"""
import ctypes
import ctypes.util
import struct
import sys


class Damaged(Exception):
    pass


def check(condition, text):
    if not condition:
        raise Damaged(text)


def library(name):
    return ctypes.CDLL(ctypes.util.find_library(name) or f"lib{name}.so")


XXHASH, ZSTD = library("xxhash"), library("zstd")
XXHASH.XXH3_64bits_withSeed.restype = ctypes.c_uint64
XXHASH.XXH3_64bits_withSeed.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_uint64]
ZSTD.ZSTD_decompress.restype = ctypes.c_size_t
ZSTD.ZSTD_decompress.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t]
ZSTD.ZSTD_getFrameContentSize.restype = ctypes.c_uint64
ZSTD.ZSTD_getFrameContentSize.argtypes = [ctypes.c_char_p, ctypes.c_size_t]
ZSTD.ZSTD_findFrameCompressedSize.restype = ctypes.c_size_t
ZSTD.ZSTD_findFrameCompressedSize.argtypes = [ctypes.c_char_p, ctypes.c_size_t]


def checksum(data, seed=0):
    return XXHASH.XXH3_64bits_withSeed(data, len(data), seed)


def unpack_frame(stored, raw_bytes):
    check(ZSTD.ZSTD_getFrameContentSize(stored, len(stored)) == raw_bytes, "the frame's size is not the raw size")
    check(ZSTD.ZSTD_findFrameCompressedSize(stored, len(stored)) == len(stored), "not one zstd frame")
    raw = ctypes.create_string_buffer(raw_bytes + 1)
    check(ZSTD.ZSTD_decompress(raw, raw_bytes, stored, len(stored)) == raw_bytes, "the zstd frame is damaged")
    return raw.raw[:raw_bytes]


class BlockFile:
    """Header, blocks, index, footer."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        check(len(data) >= 48 + 40, "shorter than header and footer")
        magic, container, self.kind, self.version, reserved, self.key, total = struct.unpack("<8sIIII16sQ", data[:48])
        check(magic == bytes.fromhex("0a58554c424c4b31"), "header magic")
        check(checksum(data[:40]) == total, "header checksum")
        check(container == 1, f"container version {container}")
        check(reserved == 0, "reserved field")
        index_at, count, index_sum, footer_sum, magic = struct.unpack("<QQQQ8s", data[-40:])
        check(magic == bytes.fromhex("4b58554c454e440a"), "footer magic")
        check(checksum(data[-40:-16]) == footer_sum, "footer checksum")
        index = data[index_at:len(data) - 40]
        check(index_at >= 48 and len(index) == 40 * count, "the index does not fill the space before the footer")
        check(checksum(index) == index_sum, "index checksum")
        self.blocks = []
        at = 48
        for tag, offset, stored_bytes, raw_bytes, codec in struct.iter_unpack("<QQQQQ", index):
            check(offset == at, "blocks overlap or leave gaps")
            check(raw_bytes <= 1 << 36, "raw size")
            at = offset + stored_bytes + 16
            check(at <= index_at, "a block reaches into the index")
            stored = data[offset:offset + stored_bytes]
            trailer_codec, total = struct.unpack("<QQ", data[at - 16:at])
            check(trailer_codec == codec and codec in (0, 1), "codec")
            check(checksum(stored, checksum(struct.pack("<QQQ", codec, tag, raw_bytes))) == total, "block checksum")
            if codec == 0:
                check(stored_bytes == raw_bytes, "a raw block whose sizes differ")
            self.blocks.append((tag, stored if codec == 0 else unpack_frame(stored, raw_bytes)))
        check(at == index_at, "a gap before the index")


class Cursor:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, form):
        size = struct.calcsize("<" + form)
        check(self.at + size <= len(self.data), "bytes end early")
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += size
        return values

    def varint(self):
        value = shift = 0
        while True:
            check(shift < 70, "varint longer than 10 bytes")
            (byte,) = self.take("B")
            value |= (byte & 0x7f) << shift
            shift += 7
            if byte < 0x80:
                return value

    def end(self):
        check(self.at == len(self.data), "bytes left over")


def print_evidence(file, out):
    check(file.version == 1, f"evidence version {file.version}")
    records_before = 0
    for tag, raw in file.blocks:
        check(tag == records_before, "tag is not the number of the first record")
        cursor = Cursor(raw)
        records, table_size = cursor.varint(), cursor.varint()
        check(table_size < 1 << 32 and records <= len(raw), "sizes")
        records_before += records
        table = cursor.take(f"{table_size}Q")
        check(all(a < b for a, b in zip(table, table[1:])), "target table out of order")
        patches = cursor.take(f"{records}Q")
        levels = [cursor.take("BBB") for _ in range(records)]
        tallies = [(cursor.varint(), cursor.varint(), cursor.varint()) for _ in range(records)]
        targets = []
        for opened, back, count in tallies:
            check(opened < 1 << 32 and back < 1 << 32 and count <= table_size, "open, back or target count")
            indexes, following = [], 0
            for _ in range(count):
                indexes.append(following + cursor.varint())
                following = indexes[-1] + 1
                check(following <= table_size, "target index beyond the table")
            targets.append(indexes)
        for patch, (replicate, first, last), (opened, back, _), indexes in zip(patches, levels, tallies, targets):
            check(first <= last <= 31, "levels")
            counts = [cursor.varint() for _ in indexes]
            check(all(0 < count < 1 << 32 for count in counts), "a count of zero or above 2^32")
            rays = (1 << last) - (1 << (first - 1) if first > 0 else 0)
            check(opened + back + sum(counts) == rays, "the sum is not the number of rays")
            ends = "".join(f" {table[i]:016x}*{count}" for i, count in zip(indexes, counts))
            out.append(f"patch {patch:016x} replicate {replicate} levels {first}..{last} open {opened} back {back} on{ends}")
        cursor.end()


def set_bits(words):
    for place, word in enumerate(words):
        for bit in range(64):
            if word >> bit & 1:
                yield place * 64 + bit


def bit_index(raw, diagonal):
    """(rows, columns, [(row, column, count)]) of codec 1"""
    cursor = Cursor(raw)
    rows, columns, pairs = cursor.varint(), cursor.varint(), cursor.varint()
    check(1 <= rows <= 65536 and 1 <= columns <= 65536 and 1 <= pairs <= rows * columns, "R, C or P")
    per_row = -(-columns // 64)
    word_count = -(-rows * per_row // 64)
    words = cursor.take(f"{-(-word_count // 64)}Q")
    for length in (word_count, rows * per_row):
        places = list(set_bits(words))
        check(not places or places[-1] < length, "a bit beyond the block")
        stored = cursor.take(f"{len(places)}Q")
        check(all(stored), "a stored word is zero")
        words = [0] * length
        for place, word in zip(places, stored):
            words[place] = word
    found = []
    for bit in set_bits(words):
        row, column = bit // 64 // per_row, bit // 64 % per_row * 64 + bit % 64
        check(column < columns and (not diagonal or column > row), "a bit beyond the block")
        found.append((row, column))
    check(len(found) == pairs, "a number of bits other than P")
    counts = [cursor.varint() for _ in found]
    check(all(0 < count < 1 << 32 for count in counts), "a count of zero or above 2^32")
    cursor.end()
    return rows, columns, [(row, column, count) for (row, column), count in zip(found, counts)]


def code_lengths(cursor):
    """of symbols 0 to 255, from half bytes"""
    lengths, run = [], False
    while len(lengths) < 256 or run:
        (byte,) = cursor.take("B")
        for half in (byte & 15, byte >> 4):
            if run:
                lengths += [0] * half
                run = False
            elif len(lengths) < 256:
                check(half <= 10, "a code of more than 10 bits")
                lengths.append(half)
                run = half == 0
            else:
                check(half == 0, "code lengths left over")
    check(len(lengths) == 256, "code lengths of more than 256 symbols")
    check(sum(1 << (10 - length) for length in lengths if length) == 1 << 10, "a code is not complete")
    return lengths


def codes(lengths):
    """{(length, code): symbol}"""
    found, code, before = {}, 0, 0
    for length, symbol in sorted((length, symbol) for symbol, length in enumerate(lengths) if length):
        code <<= length - before
        found[length, code] = symbol
        code, before = code + 1, length
    return found


def class_after(symbol):
    count = symbol >> 4
    return 0 if count <= 1 else 1 if count == 2 else 2 if count <= 4 else 3 if count <= 8 else 4


def symbols(cursor, classes, count):
    tables = [codes(code_lengths(cursor)) for _ in range(classes)]
    sizes = [cursor.varint() for _ in range(4)]
    found = []
    for lane, size in enumerate(sizes):
        check(size <= len(cursor.data), "lane bytes")
        data = cursor.take(f"{size}s")[0]
        at = state = 0
        for _ in range(count // 4 + (lane < count % 4)):
            code = length = 0
            while (length, code) not in tables[state]:
                check(at < 8 * size and length < 10, "a lane ends early")
                code = code << 1 | data[at // 8] >> at % 8 & 1
                at, length = at + 1, length + 1
            found.append(tables[state][length, code])
            state = class_after(found[-1]) if classes > 1 else 0
        check((at + 7) // 8 == size and (at % 8 == 0 or data[-1] >> at % 8 == 0), "a lane ends late")
    return found


def numbers(cursor, count):
    if count == 0:
        return []
    size = cursor.varint()
    check(size <= len(cursor.data), "stored bytes")
    found = []
    for first in unpack_frame(cursor.take(f"{size}s")[0], count):
        if first < 128:
            found.append(first)
        elif first < 255:
            found.append(128 + 256 * (first - 128) + cursor.take("B")[0])
        else:
            found.append(cursor.take("I")[0])
    return found


def gap_symbols(raw):
    """The same of codec 2"""
    cursor = Cursor(raw)
    rows, columns, pairs = cursor.varint(), cursor.varint(), cursor.varint()
    check(1 <= rows <= 65536 and 1 <= columns <= 65536 and 1 <= pairs <= rows * columns, "R, C or P")
    (classes,) = cursor.take("B")
    check(classes in (1, 5), "K")
    check(pairs <= 8 * len(raw), "more pairs than bits")
    found = symbols(cursor, classes, pairs)
    sizes = numbers(cursor, rows)
    check(sum(sizes) == pairs, "the sum of row sizes is not P")
    large_gaps = sum(symbol & 15 == 15 for symbol in found)
    large = numbers(cursor, large_gaps + sum(symbol >> 4 == 15 for symbol in found))
    cursor.end()
    next_gap, next_count = iter(large[:large_gaps]), iter(large[large_gaps:])
    next_symbol, result = iter(found), []
    for row, size in enumerate(sizes):
        column = -1
        for _ in range(size):
            symbol = next(next_symbol)
            gap, count = symbol & 15, symbol >> 4
            gap += next(next_gap) if gap == 15 else 0
            count += next(next_count) if count == 15 else 0
            column += gap + 1
            check(gap < 65536 and column < columns and 0 < count < 1 << 32, "a pair beyond the block, or a count of zero or above 2^32")
            result.append((row, column, count))
    return rows, columns, result


def pair_block(raw):
    check(raw, "an empty pair block")
    if raw[0] == 2:
        return gap_symbols(raw[1:])
    check(raw[0] == 1, f"codec {raw[0]}")
    cursor = Cursor(raw[1:])
    size = cursor.varint()
    return bit_index(unpack_frame(raw[1 + cursor.at:], size), False)


def print_strip(file, out):
    check(file.version == 3, f"strip version {file.version}")
    check(len(file.blocks) >= 5 and [tag for tag, _ in file.blocks[:5]] == [0, 1, 2, 3, 4], "the first blocks")
    columns = []
    for _, raw in file.blocks[:4]:
        check(len(raw) % 4 == 0, "a column of u32")
        columns.append([value for (value,) in struct.iter_unpack("<I", raw)])
    check(len({len(column) for column in columns}) == 1, "tallies of different lengths")
    for patch, (rays, own, opened, back) in enumerate(zip(*columns)):
        out.append(f"patch {patch} rays {rays} self {own} open {opened} back {back}")
    cursor = Cursor(file.blocks[4][1])
    (count,) = cursor.take("Q")
    check(len(file.blocks) == 5 + count, "the directory is not as long as the file has blocks")
    before = -1
    for tag, raw in file.blocks[5:]:
        b, pairs = cursor.take("IQ")
        check(b > before and tag == 5 + b, "the directory is out of order")
        # The file does not name its chunk, so whether a bit lies on the wrong side of the diagonal is not checked.
        rows, width, found = pair_block(raw)
        check(rows == len(columns[0]) and len(found) == pairs, "the directory does not fit the block")
        out.append(f"block {b} rows {rows} columns {width} pairs {pairs}")
        out += [f"{row} {column} {count}" for row, column, count in found]
        before = b
    cursor.end()


PRINTERS = {2: ("evidence", print_evidence), 3: ("strip", print_strip)}


def describe(path):
    """The lines that say what the file holds; raises Damaged or OSError."""
    file = BlockFile(path)
    check(file.kind in PRINTERS, f"kind {file.kind} is neither evidence (2) nor a strip (3)")
    name, printer = PRINTERS[file.kind]
    lines = [f"{name} version {file.version} key {file.key.hex()} blocks {len(file.blocks)}"]
    printer(file, lines)
    return lines


def main():
    if len(sys.argv) < 2:
        print(__doc__, file=sys.stderr)
        return 1
    status = 0
    for path in sys.argv[1:]:
        try:
            print("\n".join(describe(path)))
        except (Damaged, OSError) as error:
            print(f"{path}: {error}", file=sys.stderr)
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
