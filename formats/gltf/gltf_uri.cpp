#include "formats/gltf/gltf_uri.h"

#include <cctype>

#include "formats/base/base64.h"
#include "formats/base/file.h"
#include "formats/gltf/gltf_json.h"

namespace luxel {

namespace {

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

/// "http" of "http://x", empty if the text starts with no scheme. One letter is a drive, which is no scheme either.
std::string_view scheme_of(std::string_view uri) {
    const std::size_t colon = uri.find(':');
    if (colon == std::string_view::npos || colon < 1) return {};
    for (const char c : uri.substr(0, colon))
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '+' && c != '-' && c != '.') return {};
    return uri.substr(0, colon);
}

/// For messages: a data URI can be megabytes long.
std::string shortened(const std::string& uri) { return uri.size() <= 80 ? uri : uri.substr(0, 77) + "..."; }

Bytes read_data_uri(const std::string& uri, const std::string& where, std::string* mime_type) {
    const std::size_t comma = uri.find(',');
    if (comma == std::string::npos) bad_gltf(where, "data URI without a comma: " + shortened(uri));
    const std::string_view head = std::string_view(uri).substr(5, comma - 5);
    const std::string_view body = std::string_view(uri).substr(comma + 1);
    if (mime_type) *mime_type = head.substr(0, head.find(';'));
    if (head.ends_with(";base64")) {
        if (auto bytes = decode_base64(body)) return std::move(*bytes);
        bad_gltf(where, "data URI is not valid base64: " + shortened(uri));
    }
    const auto text = decode_percent(body);
    if (!text) bad_gltf(where, "data URI with a broken % escape: " + shortened(uri));
    return Bytes(text->begin(), text->end());
}

}  // namespace

std::optional<std::string> decode_percent(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            out.push_back(text[i]);
            continue;
        }
        if (i + 2 >= text.size()) return std::nullopt;
        const int high = hex_digit(text[i + 1]), low = hex_digit(text[i + 2]);
        if (high < 0 || low < 0) return std::nullopt;
        out.push_back(static_cast<char>(high * 16 + low));
        i += 2;
    }
    return out;
}

std::filesystem::path uri_path(const GltfDocument& document, const std::string& uri, const std::string& where) {
    if (const std::string_view scheme = scheme_of(uri); !scheme.empty())
        bad_gltf(where, "uri \"" + shortened(uri) + "\": " + std::string(scheme) + ": is not followed",
                 "store the file beside the glTF file and refer to it by a relative path");
    const auto decoded = decode_percent(uri);
    if (!decoded || decoded->empty() || decoded->find('\0') != std::string::npos)
        bad_gltf(where, "uri \"" + shortened(uri) + "\" is not a valid relative path");
    // A UTF-8 string constructor: on the systems we run on a path is the same bytes.
    const std::filesystem::path relative = std::filesystem::path(*decoded).lexically_normal();
    if (!document.allow_outside) {
        const char* hint = "store the file beside the glTF file and refer to it by a relative path, or allow it: --allow-outside";
        if (relative.is_absolute() || decoded->front() == '\\')
            bad_gltf(where, "uri \"" + shortened(uri) + "\" is an absolute path", hint);
        if (*relative.begin() == "..") bad_gltf(where, "uri \"" + shortened(uri) + "\" leads out of the folder of the file", hint);
    }
    return document.folder / relative;
}

Bytes read_uri(const GltfDocument& document, const std::string& uri, const std::string& where, std::string* mime_type) {
    if (uri.rfind("data:", 0) == 0) return read_data_uri(uri, where, mime_type);
    const std::filesystem::path path = uri_path(document, uri, where);
    try {
        return read_file(path);
    } catch (const Error& problem) {
        bad_gltf(where, "cannot read the external file " + path.string() + ": " + problem.what_text,
                 "copy it there, or export the scene as one .glb file");
    }
}

}  // namespace luxel
