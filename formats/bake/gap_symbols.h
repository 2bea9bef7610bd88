/// The pairs of a block as one byte symbol each, gap and count together, entropy coded: codec 2 of strip_file.md.
///
/// Where few pairs of a block exist, a bit index spends most on saying what is not there, and its bits and the counts
/// say the same twice: dense runs have large counts. A symbol holds the free places before the pair and its count; its
/// code depends on the count before it (chained_code.h). What does not fit into a symbol follows in streams of its own.
///
/// Decoding goes over a block several times, each time with one simple task and no choice that a processor could guess
/// wrong: symbols, their two halves, what is large, sums of gaps. For the last, gaps run on from row to row as if a row
/// began one width after the row before it, so that all of a block is one sum. Memory: 3 bytes per pair while it runs.
#pragma once
#include "formats/bake/strip_file.h"

namespace luxel {

/// Pure. Requires a valid block.
Bytes encode_gaps(const StripPairs& block);

/// Validates everything. `diagonal`: only columns above the row are legal. Throws Error{damaged_store} naming `where`.
/// `reuse`: its memory serves again.
StripPairs decode_gaps(ByteView bytes, bool diagonal, const std::string& where, StripPairs reuse = {});

}  // namespace luxel
