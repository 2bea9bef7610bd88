/// A .gltf or .glb file in memory: its whole JSON, the bytes of its buffers, and checked access to buffer views.
///
/// Read with nlohmann-json directly, not with tinygltf: version 2.7 of that library reads past its buffers on damaged
/// Draco files, refuses meshopt fallback buffers and some valid Draco files, and drops JSON members that it does not
/// know, while the writer has to keep every one of them.
///
/// Which of the two forms a file has is decided by its first four bytes, never by its name.
/// Units: sizes and offsets in bytes. Errors: everything throws Error{bad_input} with file, part, expected and found.
/// Ownership: a document owns all bytes; views stay valid as long as it lives and is not changed.
/// Threads: a loaded document is only read; all const members are reentrant.
/// Source: glTF 2.0 specification, sections 3.6 (buffers), 4 (GLB); EXT_meshopt_compression; RFC 2397 (data URIs).
#pragma once
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/base/bytes.h"
#include "formats/base/error.h"

namespace luxel {

struct GltfDocument {
    std::string name;              ///< file name, the first part of every message
    std::filesystem::path folder;  ///< where relative URIs start
    bool allow_outside = false;    ///< URIs may lead out of the folder
    bool binary = false;           ///< a GLB container
    nlohmann::json json;           ///< an object with asset.version 2.x; otherwise as found
    /// One per json["buffers"], at least byteLength bytes (a GLB chunk is padded). Empty for a meshopt fallback buffer
    /// without data of its own.
    std::vector<Bytes> buffers;
    /// One per json["bufferViews"]: the bytes of a view that is stored compressed (meshopt), decoded.
    std::vector<std::optional<Bytes>> decoded_views;
    std::vector<Warning> warnings;  ///< unknown extensions

    /// Bytes of a buffer view, decoded where it is compressed. `where` names who asks, for the message.
    [[nodiscard]] ByteView view(std::int64_t index, const std::string& where) const;
    /// byteStride of a buffer view, 0 if the file gives none. `index` was accepted by view().
    [[nodiscard]] std::uint64_t view_stride(std::int64_t index) const;
};

/// Loads a file with its external buffers; images stay where they are. URIs that lead out of the file's folder, by "..", or absolute
/// paths, are refused unless `allow_outside`: a file from elsewhere should not read what it likes.
GltfDocument load_gltf(const std::filesystem::path& path, bool allow_outside = false);

/// The same from bytes in memory; relative URIs start at `folder`.
GltfDocument parse_gltf(ByteView bytes, const std::string& name, const std::filesystem::path& folder, bool allow_outside = false);

/// Bytes behind a URI: data: (base64 or percent-encoded) or a file relative to the document (percent-decoded).
/// Other schemes are refused, and what lies outside of the folder unless the document allows it. If `mime_type` is given it receives a data URI's type.
Bytes read_uri(const GltfDocument& document, const std::string& uri, const std::string& where,
               std::string* mime_type = nullptr);

}  // namespace luxel
