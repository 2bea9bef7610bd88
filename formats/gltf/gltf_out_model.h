/// The model while it is being written: its JSON, and where the bytes of every buffer view come from.
/// Private to the gltf_out files. Errors and threads: as gltf_out.h.
#pragma once
#include <string>
#include <vector>

#include "formats/gltf/gltf_document.h"

namespace luxel {

/// One per bufferViews entry; exactly one of the three is used.
struct OutputView {
    std::int64_t source = -1;  ///< buffer view of the input document
    ByteView borrowed;         ///< bytes of the caller, where source < 0 and owned is empty
    Bytes owned;
};

struct OutputModel {
    const GltfDocument& document;
    nlohmann::json root;
    std::vector<OutputView> views;
    std::vector<Warning> warnings;

    explicit OutputModel(const GltfDocument& input);

    /// Appends an item to a top-level array, which is made when missing; returns its index.
    std::uint64_t append(const char* array, nlohmann::json item);
    /// Appends a buffer view with nothing but its bytes; returns its index. Offsets are set when the file is laid out.
    std::uint64_t append_view(OutputView view, nlohmann::json item = nlohmann::json::object());
};

/// Adds to or removes from extensionsUsed; removing takes extensionsRequired along, and empty lists away.
void use_extension(nlohmann::json& root, const std::string& name);
void drop_extension(nlohmann::json& root, const std::string& name);

/// Does any object of the tree carry extensions[name]? `extras` are not searched.
bool has_extension(const nlohmann::json& tree, const std::string& name);
/// Removes extensions[name] of this object, and an empty `extensions` with it.
void erase_extension(nlohmann::json& object, const std::string& name);

}  // namespace luxel
