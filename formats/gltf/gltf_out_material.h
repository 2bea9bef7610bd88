/// Clones of materials that carry a lightmap. Private to the gltf_out files.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "formats/gltf/gltf_out.h"
#include "formats/gltf/gltf_out_model.h"

namespace luxel {

/// Does any texture of this material (or of another object's extensions) use TEXCOORD_`set`? `extras` and MOZ_lightmap
/// do not count.
bool uses_uv_set(const nlohmann::json& object, std::uint64_t set);
/// Makes every texture that uses TEXCOORD_`from` use TEXCOORD_`to`.
void change_uv_set(nlohmann::json& object, std::uint64_t from, std::uint64_t to);

/// Does the material name any texture?
bool has_texture(const nlohmann::json& material);

class LightmapMaterials {
  public:
    /// Adds a texture for each page; `images` are the indices of the pages' pictures.
    LightmapMaterials(OutputModel& model, const GltfLightmaps& lightmaps, const std::vector<std::uint64_t>& images);

    /// The clone of `material` (-1: the default material) for a place on a page. `moved_uv_set`: where the input's TEXCOORD_1
    /// went, 0 if it did not. The same arguments give the same clone.
    std::uint64_t clone(std::int64_t material, std::uint32_t page, const LayoutPlace& place, std::uint64_t moved_uv_set);

    /// The material to show where nodes name the lightmap: `material` itself, or a clone whose textures follow a moved TEXCOORD_1 and which
    /// has no MOZ_lightmap. -1 stays -1.
    std::int64_t without_lightmap(std::int64_t material, std::uint64_t moved_uv_set);

    /// The texture of each page.
    [[nodiscard]] const std::vector<std::uint64_t>& textures() const { return textures_; }

    /// The material of the input.
    [[nodiscard]] const nlohmann::json& source(std::int64_t material) const;

  private:
    void set_place(nlohmann::json& texture_use, const LayoutPlace& place);
    nlohmann::json make_lit(std::int64_t material, std::uint32_t page, const LayoutPlace& place, std::uint64_t moved_uv_set);
    nlohmann::json make_unlit(std::int64_t material, std::uint32_t page, const LayoutPlace& place);

    OutputModel& model_;
    const GltfLightmaps& lightmaps_;
    std::vector<std::uint64_t> textures_;  ///< per page
    using CloneKey = std::tuple<std::int64_t, std::uint32_t, std::array<float, 4>, std::uint64_t>;
    std::map<CloneKey, std::uint64_t> clones_;
    std::map<std::pair<std::int64_t, std::uint64_t>, std::int64_t> plain_clones_;
};

}  // namespace luxel
