/// Sizes on the command line.
#pragma once
#include <cstdint>
#include <string>

namespace luxel {

/// "256M" -> bytes. Suffixes K, M, G are powers of 1024. Throws Error{usage} naming `option`.
std::uint64_t parse_bytes(const std::string& text, const std::string& option);

}  // namespace luxel
