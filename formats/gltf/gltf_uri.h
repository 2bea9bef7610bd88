/// URIs inside a glTF file: base64, percent-encoding, and which of them may be followed.
///
/// Errors   Error{bad_input} naming `where`. Threads: pure functions.
/// Source   RFC 3986 (URI), RFC 2397 (data:), RFC 4648 (base64).
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "formats/gltf/gltf_document.h"

namespace luxel {

/// %41 -> A; nullopt on a broken escape.
std::optional<std::string> decode_percent(std::string_view text);

/// Standard or URL alphabet, padding optional, line breaks skipped; nullopt on any other character.
std::optional<Bytes> decode_base64(std::string_view text);

/// The file that a relative URI names. Absolute paths and schemes (http:, file:) are refused; "../" is legal in glTF.
std::filesystem::path uri_path(const GltfDocument& document, const std::string& uri, const std::string& where);

}  // namespace luxel
