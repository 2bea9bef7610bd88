/// The baked model: the input file with lightmaps. glTF binary, or .gltf with .bin and pictures when the name ends so.
///
/// Kept     everything: nodes, names, cameras, animations, skins, extras, unknown extensions and JSON members, textures
///          and the bytes of their pictures, all attributes (also custom ones, joints, weights, morph targets) in their
///          component types, unused materials. Points, lines, and meshes without a layout stay as they are.
/// Added    TEXCOORD_1 with the lightmap layout; per (material, page, place) a clone of the material with MOZ_lightmap
///          { index, texCoord: 1, intensity, extras } (docs/lightmap-formats.md); a texture and a picture per page;
///          asset.extras.luxel { version }. "MOZ_lightmap" goes to extensionsUsed, never to extensionsRequired. A picture that
///          glTF does not know is named by a texture extension, and lies beside the model: as `uri` without mimeType, and with the
///          extension on the image too, it is what validators pass over, where inside a GLB they warn of its kind.
/// Copies   Instances with one layout at different places share all arrays: coordinates are those of the layout, and the place
///          is a KHR_texture_transform { offset, scale } of the clone's MOZ_lightmap. Copies by EXT_mesh_gpu_instancing share
///          the material too: their places are its attributes _LIGHTMAP_OFFSET and _LIGHTMAP_SCALE (VEC2, float), the names
///          of MX_lightmap. Where such copies lie on several pages the node keeps those of one, children of it show the others.
///          If one of them has no place of its own (the identity), all copies of the node become child nodes without the extension.
/// Nodes    With LightmapPlacement::nodes the nodes name the lightmap instead, by MX_lightmap { lightMapTexture { index, texCoord: 1 }, scale, offset,
///          intensity, extras }: meshes are shared by all nodes that show one layout, and materials are those of the input, but where
///          a texture's UV set moves or an earlier MOZ_lightmap has to go. A mesh on several pages becomes one per page; children of
///          the node show all but the first.
/// Changed  Vertices are split where charts are cut: one per distinct (old vertex, lightmap coordinate). A primitive on
///          several pages becomes one primitive per page. Strips and fans become triangles. A mesh
///          that several nodes show becomes one per node, since every node has materials of its own; equal arrays are
///          stored once. A TEXCOORD_1 of the input moves to the next free set (materials that use it follow), except where
///          only an earlier MOZ_lightmap used it; a missing TEXCOORD_0 is added, as sets must not have gaps. Meshopt
///          data, and Draco data of what gets a lightmap, is written decoded, unless `packing` asks for it (gltf_out_draco.h,
///          gltf_out_meshopt.h); quantized attributes stay quantized. Pictures outside a GLB are
///          embedded. Arrays that only replaced primitives used are removed, unless an extension that is unknown here
///          might refer to them by number.
/// Errors   Error{cannot_write} (disk full, a folder as output, more than 4 GiB in a GLB): nothing partial is left.
///          Error{internal}: the layout does not fit the record. Error{bad_input}: an array cannot be read.
/// Threads  pure function of its arguments; the same arguments give the same bytes.
/// Source   glTF 2.0; MOZ_lightmap (draft by T. Takahiro, as the Hubs exporter and importer use it); MX_lightmap (gltf_out_nodes.h).
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/gltf/gltf_document.h"
#include "formats/gltf/gltf_packing.h"
#include "formats/gltf/scene_record.h"

namespace luxel {

/// In PrimitiveLayout::triangle_page: a triangle without a place (no area). It is kept, at coordinate 0 of a page that
/// its primitive uses; a primitive without any placed triangle stays without lightmap.
constexpr std::uint32_t no_page = 0xffffffffu;

struct PrimitiveLayout {
    std::vector<Imath::V2f> corner_uv;         ///< 3 per triangle of the PrimitiveRecord: 0..1 of the layout (LayoutPlace), v down
    std::vector<std::uint32_t> triangle_page;  ///< per triangle: index into GltfLightmaps::pages, or no_page
};

/// Where a layout lies: place on the page = coordinate of the layout * scale + offset.
struct LayoutPlace {
    Imath::V2f scale{1, 1}, offset{0, 0};
    [[nodiscard]] bool is_identity() const { return scale == Imath::V2f(1, 1) && offset == Imath::V2f(0, 0); }
};

/// As MeshRecord::primitives of a mesh.
using MeshLayout = std::vector<PrimitiveLayout>;

struct InstanceLayout {
    std::shared_ptr<const MeshLayout> mesh;  ///< one for all copies that share it; nullptr: the instance gets no lightmap
    LayoutPlace place;
};

struct LightmapPicture {
    std::string name;      ///< of texture and picture, "lightmap0.srgb8"
    Bytes file;
    double intensity = 1;  ///< irradiance = decode(sample) * intensity
};

/// Who names a lightmap: materials by MOZ_lightmap, or nodes by MX_lightmap.
enum class LightmapPlacement { materials, nodes };

/// The same for all pages.
struct LightmapMeaning {
    std::string quantity = "irradiance", unit = "lux", encoding = "srgb8", format = "png8", profile = "three";
    double range = 0;  ///< of encodings that have one, else 0
    LightmapPlacement placement = LightmapPlacement::materials;
    /// Written intensity = LightmapPicture::intensity * this, for lit materials and for those with KHR_materials_unlit; nodes take the first.
    double lit_scale = 1, unlit_scale = 1;
    std::string suffix = ".png", mime_type = "image/png";  ///< of the pictures: ".lightmap0" + suffix
    std::string texture_extension;                         ///< that names the picture; empty: glTF knows its kind
    bool is_embedded = true;                               ///< inside a GLB; else beside it
};

struct GltfLightmaps {
    std::vector<LightmapPicture> pages;
    std::vector<InstanceLayout> instances;  ///< as SceneRecord::instances; those with gpu_instance >= 0 and a place lie on one page each
    LightmapMeaning meaning;
    bool is_unlit = false;  ///< pages are what surfaces look like: materials show them as they are, and nothing is said of light
    std::string version;  ///< of luxel
};

struct GltfPart {
    std::filesystem::path file;
    std::vector<std::uint64_t> nodes;  ///< of the input, that belong to it, in the order of a depth-first walk
    std::vector<std::uint32_t> pages;  ///< lightmap pages that it uses, ascending
};
struct GltfParts {
    std::vector<GltfPart> parts;      ///< by number; no file: nothing belongs to it
    std::optional<GltfPart> common{};
    std::vector<std::filesystem::path> pictures;  ///< that several files use
    std::vector<Warning> warnings;
    [[nodiscard]] std::vector<std::filesystem::path> files() const;
};

struct GltfWritten {
    std::vector<std::filesystem::path> files;  ///< the model first
    std::vector<std::string> page_files;       ///< per page: its file beside the model; empty: inside
    GltfParts parts;                           ///< with GltfPacking::split; their files are in `files` too
    std::vector<Warning> warnings;
};

/// `document` and `record` as read from the input (load_gltf, read_scene).
GltfWritten write_gltf(const std::filesystem::path& path, const GltfDocument& document, const SceneRecord& record,
                       const GltfLightmaps& lightmaps, const GltfPacking& packing = {});

}  // namespace luxel
