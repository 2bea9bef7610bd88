/// URIs inside a glTF file: percent-encoding, and which of them may be followed.
///
/// Errors   Error{bad_input} naming `where`. Threads: pure functions.
/// Source   RFC 3986 (URI), RFC 2397 (data:).
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "formats/gltf/gltf_document.h"

namespace luxel {

/// %41 -> A; nullopt on a broken escape.
std::optional<std::string> decode_percent(std::string_view text);

/// The file that a relative URI names. Absolute paths and schemes (http:, file:) are refused; "../" is legal in glTF.
std::filesystem::path uri_path(const GltfDocument& document, const std::string& uri, const std::string& where);

}  // namespace luxel
