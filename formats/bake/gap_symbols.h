/// The pairs of a block as one byte symbol each, gap and count together, entropy coded: codec 2 of strip_file.md.
///
/// Where few pairs of a block exist, a bit index spends most on saying what is not there, and its bits and the counts say
/// the same twice: dense runs have large counts. A symbol holds the free columns before the pair (0..14) and its count
/// (1..14); its probability depends on the count before it in the row, so there is a stream of symbols for each class of
/// that count, each a Huffman code made by zstd. Larger values follow as varints in a stream of their own.
#pragma once
#include "formats/bake/strip_file.h"

namespace luxel {

/// Pure. Requires a valid block. `diagonal`: gaps count from the column after the row's own number.
Bytes encode_gaps(const StripPairs& block, bool diagonal);

/// Validates everything. Throws Error{damaged_store} naming `where`.
StripPairs decode_gaps(ByteView bytes, bool diagonal, const std::string& where);

}  // namespace luxel
