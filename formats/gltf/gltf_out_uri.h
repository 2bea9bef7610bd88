/// URIs that the writer makes.
#pragma once
#include <string>
#include <string_view>

namespace luxel {

/// A file name as a relative URI: everything but letters, digits and -._~ is escaped, byte by byte (RFC 3986).
std::string encode_percent(std::string_view file_name);

}  // namespace luxel
