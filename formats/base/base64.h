/// Base64: bytes as text.
///
/// Threads  pure.  Source  RFC 4648, sections 4 and 5.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "formats/base/bytes.h"

namespace luxel {

/// In the standard alphabet, with padding.
std::string encode_base64(ByteView bytes);

/// Standard or URL alphabet, padding optional, line breaks skipped; nullopt on any other character.
std::optional<Bytes> decode_base64(std::string_view text);

}  // namespace luxel
