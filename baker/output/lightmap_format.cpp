#include "baker/output/lightmap_format.h"

#include "formats/base/error.h"

namespace luxel {

const LightmapFormatInfo& lightmap_format_info(LightmapFormat format) {
    return all_lightmap_formats[static_cast<std::size_t>(format)];
}

LightmapFormat parse_lightmap_format(const std::string& name, const std::string& where) {
    std::string names;
    for (const LightmapFormatInfo& info : all_lightmap_formats) {
        if (name == info.name) return info.format;
        names += std::string(names.empty() ? "" : ", ") + info.name;
    }
    throw Error(ErrorCode::usage, where, "expected one of " + names + ", found \"" + name + "\"");
}

std::string encoding_of(LightmapFormat format, LightmapEncoding bytes) {
    const char* fixed = lightmap_format_info(format).encoding;
    return fixed ? fixed : encoding_name(bytes);
}

}  // namespace luxel
