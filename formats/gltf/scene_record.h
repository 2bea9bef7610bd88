/// What a glTF file says about surfaces and light, as plain records: validated sizes and indexes, decoded arrays,
/// no interpretation. Local coordinates; world matrices in double precision. baker/scene turns it into a Scene.
#pragma once
#include <ImathMatrix.h>
#include <ImathVec.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/base/bytes.h"
#include "formats/base/error.h"

namespace luxel {

/// Encoded image file (PNG, JPEG, WebP ...) as found. `bytes` is empty when it could not be read; a warning says why.
struct ImageRecord {
    std::string name;       ///< for messages: name, uri or "image 3"
    std::string mime_type;  ///< may be empty
    Bytes bytes;
};

enum class WrapMode { repeat, clamp, mirror };

struct TextureRecord {
    int image = -1;  ///< index into images, or -1: cannot be decoded here (a warning names the extension)
    WrapMode wrap_s = WrapMode::repeat, wrap_t = WrapMode::repeat;
    bool nearest = false;  ///< magFilter NEAREST
    int other = -1;  ///< the same in another format, for readers that cannot decode `image`; -1: none
};

/// A texture as a material uses it. uv' = (a*u + b*v + c, d*u + e*v + f), from KHR_texture_transform.
struct TextureUse {
    int texture = -1;  ///< -1: none
    int uv_set = 0;    ///< TEXCOORD_n
    std::array<double, 6> transform{1, 0, 0, 0, 1, 0};
};

enum class AlphaMode { opaque, mask, blend };

struct MaterialRecord {
    std::string name;
    std::array<double, 4> base_color{1, 1, 1, 1};  ///< linear, times the texture; diffuse factor for specular-glossiness
    TextureUse base_color_texture;                 ///< sRGB colour, linear alpha
    std::array<double, 3> emission{0, 0, 0};       ///< nits: emissiveFactor * emissiveStrength, times the texture
    TextureUse emissive_texture;                   ///< sRGB
    bool double_sided = false;
    AlphaMode alpha_mode = AlphaMode::opaque;
    double alpha_cutoff = 0.5;
    double metallic = 0;      ///< metallicFactor 0..1: the part that mirrors; 0 where a texture decides it (has_metallic_texture)
    bool has_metallic_texture = false;
    double transmission = 0;  ///< KHR_materials_transmission factor 0..1
    TextureUse transmission_texture;  ///< its red, linear, times the factor; none where the factor is 0
    bool unlit = false;
};

/// One primitive with triangles; strips and fans are expanded, in the specification's winding.
/// Arrays other than indices are empty or as long as positions; indices are 3 per triangle and below positions.size().
struct PrimitiveRecord {
    int gltf_primitive = 0;  ///< index in the mesh of the file
    int material = -1;       ///< -1: default material
    std::vector<Imath::V3f> positions;
    std::vector<Imath::V3f> normals;
    std::array<std::vector<Imath::V2f>, 2> uv;  ///< TEXCOORD_0 and TEXCOORD_1
    std::vector<std::array<float, 4>> colors;   ///< COLOR_0, as found: linear factors of base colour and alpha, 1 where it has no alpha
    std::vector<std::uint32_t> indices;
};

struct MeshRecord {
    std::string name;  ///< name or "mesh 3"
    std::vector<PrimitiveRecord> primitives;
};

/// What is said about a node beside its glTF (node_settings.h); none: nothing is said.
struct NodeSettings {
    std::optional<bool> lightmap{};            ///< false: no lightmap is written for it
    std::optional<bool> receive{};             ///< false: no light falls on it, and no lightmap either
    std::optional<bool> cast_shadow{};         ///< false: rays pass as if it were not there
    std::optional<bool> two_sided{};           ///< in place of MaterialRecord::double_sided
    std::optional<double> texels_per_metre{};  ///< 1e-6 .. 1e9
};

/// A node of the scene that shows a mesh, in document order of a depth-first walk.
struct InstanceRecord {
    int node = -1;
    int mesh = -1;
    std::string node_path;  ///< "/hall/chair": names (or "#index"); siblings of one name get ":1", ":2". Unique.
    Imath::M44d world;      ///< row vectors: p' = p * M
    /// Number within EXT_mesh_gpu_instancing of the node (node_path ends in "@k"), -1 for an ordinary node. All copies
    /// share one node and its materials, so the writer cannot give them lightmaps of their own.
    int gpu_instance = -1;
    NodeSettings settings{};
};

enum class LampKind { point, spot, directional };

/// A node of the scene that carries a KHR_lights_punctual light; it shines along -Z of `world`.
struct LampRecord {
    LampKind kind = LampKind::point;
    std::string node_path;
    std::array<double, 3> intensity{0, 0, 0};  ///< color * intensity: cd (point, spot) or lux (directional)
    double range = 0;                          ///< metres; 0: unlimited
    double inner_cone = 0, outer_cone = 0.7853981633974483;  ///< radians
    /// Size, from `extras` of the node or else of the light; negative: the file gives none.
    double radius = -1;         ///< of point and spot, metres
    double angle_degrees = -1;  ///< of directional: apparent diameter
    Imath::M44d world;
};

/// The scene's EXT_lights_image_based light, as far as it is read: the largest mip of its cubemap.
struct SkyRecord {
    bool is_there = false;
    std::string where;                             ///< for messages
    std::array<double, 4> rotation{0, 0, 0, 1};    ///< quaternion x, y, z, w: from the cubemap's axes to the scene's
    double intensity = 1;                          ///< factor of the pictures
    /// +X, -X, +Y, -Y, +Z, -Z, each as it is seen from the middle of the cube; bytes are empty where a picture is missing.
    std::array<ImageRecord, 6> faces;
};

struct SceneRecord {
    std::vector<ImageRecord> images;
    std::vector<TextureRecord> textures;
    std::vector<MaterialRecord> materials;
    std::vector<MeshRecord> meshes;
    std::vector<InstanceRecord> instances;
    std::vector<LampRecord> lamps;
    SkyRecord sky;
    std::vector<Warning> warnings;
};

}  // namespace luxel
