/// SceneRecord -> Scene: one world space, clean triangles, materials in physical units.
///
/// Geometry   positions are transformed in double precision and stored as floats relative to Scene::origin, the centre of
///            the bounding box rounded to a coarse grid, so that small edits leave every float as it was. Mirrored
///            instances swap winding. Triangles with a vertex that is not finite, or without area, are dropped. Vertices
///            that no triangle uses are left out. Primitives without normals are flat: a vertex of its own per corner.
/// Light      emission M = pi * nits in lm/m2; reflectance in 0..1; sRGB textures become linear. Numbers out of their range:
///            value_check.h.
/// Findings   one warning per object or material and kind, appended to `warnings`.
/// Errors     Error{bad_input}: more than 2^32 - 2 vertices or triangles; with BadValues::refuse a number of a material that is
///            shown, or of a lamp, that is out of its range. Nothing else here throws on odd content.
/// Memory     the Scene, plus the record, which the caller may free afterwards.
/// Threads    not reentrant on one `warnings`; runs in parallel inside; the result does not depend on the thread count.
#pragma once
#include <functional>
#include <optional>

#include "baker/scene/scene.h"
#include "baker/scene/value_check.h"

namespace luxel {

/// Pixels as the file stores them, scaled to 0..1: no colour conversion. Grey images have equal r, g, b; alpha is 1 if
/// there is none. Row 0 at the top.
struct DecodedImage {
    std::uint32_t width = 0, height = 0;
    std::vector<std::array<float, 4>> rgba;
};

/// Encoded file -> pixels, nullopt if it cannot be decoded. Called from one thread, at most once per image and use (colours; numbers).
using ImageDecoder = std::function<std::optional<DecodedImage>(ByteView bytes, const std::string& name)>;

/// The sky that the user asks for, before what the file has.
struct SkyWish {
    bool none = false;                              ///< no sky, whatever the file has
    std::optional<std::array<double, 3>> color{};   ///< nits from everywhere
    std::optional<DecodedImage> picture{};          ///< nits by longitude and latitude (SkyMap)
    std::string picture_name{};                     ///< for messages
    double turn_degrees = 0;  ///< of any sky, about +Y, counter-clockwise seen from above
    double scale = 1;         ///< factor of any sky, >= 0
};

struct BuildOptions {
    bool textures = true;  ///< false: textures count as white, for a first look or for tests
    BadValues bad_values = BadValues::clamp;
    bool blend_colours = false;  ///< light through alpha BLEND takes the base colour
    std::string file{};  ///< named in errors
    double lamp_radius = 0;        ///< metres, of point and spot lamps that give none
    double sun_angle_degrees = 0;  ///< apparent diameter of directional lamps that give none
    SkyWish sky{};
    bool keep_even_textures = false;  ///< textures of one colour stay textures; else their colour goes into the material
    bool keep_dark_lamps = false;     ///< lamps without power are lamps; else their names alone are kept
};

Scene build_scene(const SceneRecord& record, const ImageDecoder& decode, const BuildOptions& options,
                  std::vector<Warning>& warnings);

}  // namespace luxel
