/// What nodes show: the new meshes, and where nodes name lightmaps (LightmapPlacement::nodes) their MX_lightmap.
/// Private to the gltf_out files. Errors and threads: as gltf_out.h.
///
/// Source  MX_lightmap (draft by R. Long): matrix-org/thirdroom, docs/gltf/MX_lightmap.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "formats/gltf/gltf_out.h"
#include "formats/gltf/gltf_out_model.h"

namespace luxel {

constexpr std::int64_t no_node_page = -1;

/// A new mesh, with what a node has to say to show it.
struct ShownMesh {
    std::uint64_t mesh = 0;
    std::int64_t page = no_node_page;  ///< of the node's lightmap; no_node_page: materials name it, or there is none
};

/// Makes the meshes that show a layout at a place together, at least one: materials of one mesh name as many pages as they like, a node names
/// one, so that there it is a mesh per page.
using MeshMaker = std::function<std::vector<ShownMesh>(const MeshLayout&, const LayoutPlace&)>;

class NodeWriter {
  public:
    /// `textures`: per page.
    NodeWriter(OutputModel& model, const GltfLightmaps& lightmaps, std::vector<std::uint64_t> textures)
        : model_(model), lightmaps_(lightmaps), textures_(std::move(textures)) {}

    /// Lets a node of the model show the first of these meshes, and children of it the others: with its skin and weights, at its place.
    void show(std::uint64_t node, const std::vector<ShownMesh>& meshes, const LayoutPlace& place);
    /// The same of one that is not yet in the model, whose copies have their places in attributes.
    void show_copies(nlohmann::json& node, const ShownMesh& mesh);
    /// When all nodes are there: extensionsUsed names MX_lightmap only if one of them still does.
    void finish();

  private:
    void set_mesh(nlohmann::json& node, const ShownMesh& shown, const LayoutPlace& place);
    void warn_of_weights(std::uint64_t node);

    OutputModel& model_;
    const GltfLightmaps& lightmaps_;
    std::vector<std::uint64_t> textures_;
};

/// The meshes that nodes of the input show with an MX_lightmap: their TEXCOORD_1 is a layout of before.
std::vector<bool> meshes_with_node_lightmap(const GltfDocument& document);

/// What extras of a lightmap say: `scale` is between its intensity and that for irradiance.
nlohmann::json lightmap_extras(const LightmapMeaning& meaning, double scale);

}  // namespace luxel
