/// Entropy code for byte symbols of which each says how likely the next ones are: a prefix code (Huffman 1952) for
/// every class of symbol before. What it stores is specified in strip_file.md, section *Symbols*.
///
/// Symbols lie in `lane_count` lanes, runs of equal length with bit streams of their own, so that a decoder works on
/// all of them at once: a code cannot be read before the one ahead of it, and one lane alone would leave the processor
/// waiting.
#pragma once
#include <array>
#include <memory>

#include "formats/base/bytes.h"

namespace luxel {

constexpr std::size_t lane_count = 4;
/// Bits: so the tables of five classes, 4 bytes an entry, fit into a processor's first cache.
constexpr std::uint32_t longest_code = 10;

/// Class of the symbols that come after a symbol; classes are below 8, and every lane begins in class 0.
using ClassAfter = std::array<std::uint8_t, 256>;

/// Appends the codes and the lanes. Pure. Requires at least one symbol.
void put_symbols(ByteWriter& out, ByteView symbols, const ClassAfter& class_after);

/// The inverse, `count` > 0 symbols; `slack` bytes more are allocated and zero. Throws Error{damaged_store} for codes
/// that are not complete, and for lanes that end early or late.
std::unique_ptr<std::uint8_t[]> get_symbols(ByteCursor& in, std::size_t count, std::size_t slack,
                                            const ClassAfter& class_after);

}  // namespace luxel
