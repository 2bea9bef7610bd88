/// Base64 of RFC 4648, section 4, for pictures inside of text files. Threads: pure.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace luxel {

std::string base64(std::string_view bytes);
/// The bytes again; nothing where the text is not what base64() writes.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace luxel
