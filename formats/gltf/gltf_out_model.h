/// The model while it is being written: its JSON, and where the bytes of every buffer view come from.
/// Private to the gltf_out files. Errors and threads: as gltf_out.h.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "formats/gltf/gltf_accessor.h"

namespace luxel {

/// Bytes of a view as meshopt stores them (gltf_out_meshopt.h).
struct MeshoptBytes {
    Bytes bytes;
    const char* mode = "ATTRIBUTES";
    std::uint64_t count = 0, stride = 0;  ///< elements, and bytes of each
};

/// One per bufferViews entry; exactly one of the first three is used.
struct OutputView {
    std::int64_t source = -1;  ///< buffer view of the input document
    ByteView borrowed;         ///< bytes of the caller, where source < 0 and owned is empty
    Bytes owned;
    std::optional<MeshoptBytes> packed{};  ///< what goes to the file instead
};

struct OutputModel {
    const GltfDocument& document;
    nlohmann::json root;
    std::vector<OutputView> views;
    std::vector<Warning> warnings;

    explicit OutputModel(const GltfDocument& input);
    /// A model that begins with nothing; `input` is for the names in messages.
    static OutputModel empty(const GltfDocument& input) { return {input, nlohmann::json::object()}; }

    /// Appends an item to a top-level array, which is made when missing; returns its index.
    std::uint64_t append(const char* array, nlohmann::json item);
    /// Appends a buffer view with nothing but its bytes; returns its index. Offsets are set when the file is laid out.
    std::uint64_t append_view(OutputView view, nlohmann::json item = nlohmann::json::object());

    /// The bytes of a view, decoded where the input has it compressed. Throws Error{bad_input} naming `where`.
    [[nodiscard]] ByteView view_bytes(std::size_t view, const std::string& where) const;
    /// byteStride of a view, 0 if it has none.
    [[nodiscard]] std::uint64_t view_stride(std::size_t view, const std::string& where) const;
    /// The elements of an accessor of `root`.
    [[nodiscard]] AccessorBytes elements(std::int64_t accessor, const std::string& where) const;

  private:
    OutputModel(const GltfDocument& input, nlohmann::json json) : document(input), root(std::move(json)) {}
};

/// Adds to or removes from extensionsUsed; requiring adds to extensionsRequired too, and removing takes it along, and
/// empty lists away.
void use_extension(nlohmann::json& root, const std::string& name);
void require_extension(nlohmann::json& root, const std::string& name);
void drop_extension(nlohmann::json& root, const std::string& name);

/// Does any object of the tree carry extensions[name]? `extras` are not searched.
bool has_extension(const nlohmann::json& tree, const std::string& name);
/// Removes extensions[name] of this object, and an empty `extensions` with it.
void erase_extension(nlohmann::json& object, const std::string& name);

}  // namespace luxel
