/// zstd frames. Only user of zstd.
#pragma once
#include <cstdint>

#include "formats/base/bytes.h"

namespace luxel {

/// One zstd frame; level 1 (fast) to 19 (small). Same bytes for the same input and library version.
Bytes compress(ByteView raw, int level);

/// One zstd frame for bytes without repeats, such as small numbers that are noise: little but entropy coding, which for
/// them is smaller than the search for repeats and decodes faster.
Bytes compress_literals(ByteView raw);

/// Exactly `raw_bytes` bytes from one frame; throws Error{damaged_store} naming `where` when the frame is damaged,
/// shorter or longer. Allocates only after the frame's own size agrees with raw_bytes.
Bytes decompress(ByteView frame, std::uint64_t raw_bytes, const std::string& where);

/// The same into memory that is used again; keeps room for `slack` more bytes.
void decompress_into(ByteView frame, std::uint64_t raw_bytes, const std::string& where, std::size_t slack, Bytes& out);

}  // namespace luxel
