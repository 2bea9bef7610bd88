/// The formats in which pages go into a model, and what each is called there. docs/lightmap-formats.md is for those who read them.
/// Threads: pure.
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "baker/output/lightmap_encode.h"

namespace luxel {

enum class LightmapFormat { png8, png16, rgbm, rgbm_mx, rgbe, exr, ktx2 };

struct LightmapFormatInfo {
    LightmapFormat format;
    const char* name;      ///< on the command line, in reports and in files
    const char* encoding;  ///< nullptr: LightmapEncoding says it
    const char* suffix;    ///< of a file beside the model, behind ".lightmap0"; never that of the float page, ".exr"
    const char* mime_type;
    const char* texture_extension;  ///< of glTF, that names the picture; nullptr: the texture itself does
    std::uint64_t bytes_per_texel;  ///< of the file, at most
};

constexpr std::array<LightmapFormatInfo, 7> all_lightmap_formats{{
    {LightmapFormat::png8, "png8", nullptr, ".png", "image/png", nullptr, 3},
    {LightmapFormat::png16, "png16", "linear16", ".png", "image/png", nullptr, 6},
    {LightmapFormat::rgbm, "rgbm", "rgbm8", ".png", "image/png", nullptr, 4},
    {LightmapFormat::rgbm_mx, "rgbm-mx", "rgbm8-mx", ".png", "image/png", nullptr, 4},
    {LightmapFormat::rgbe, "rgbe", "rgbe8", ".hdr", "image/vnd.radiance", "MOZ_texture_rgbe", 4},
    {LightmapFormat::exr, "exr", "half", ".half.exr", "image/x-exr", "EXT_texture_exr", 6},
    {LightmapFormat::ktx2, "ktx2", "half", ".ktx2", "image/ktx2", "KHR_texture_basisu", 8},
}};

const LightmapFormatInfo& lightmap_format_info(LightmapFormat format);

/// Throws Error{usage} naming `where`, with all names.
LightmapFormat parse_lightmap_format(const std::string& name, const std::string& where);

/// "srgb8", "linear16" ...: what a sample stands for. `bytes` decides for png8.
std::string encoding_of(LightmapFormat format, LightmapEncoding bytes);

}  // namespace luxel
