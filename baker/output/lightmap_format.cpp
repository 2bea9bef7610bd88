#include "baker/output/lightmap_format.h"

#include "baker/output/named_choice.h"

namespace luxel {

const LightmapFormatInfo& lightmap_format_info(LightmapFormat format) {
    return all_lightmap_formats[static_cast<std::size_t>(format)];
}

LightmapFormat parse_lightmap_format(const std::string& name, const std::string& where) {
    return row_named(all_lightmap_formats, name, where).format;
}

std::string encoding_of(LightmapFormat format, LightmapEncoding bytes) {
    const char* fixed = lightmap_format_info(format).encoding;
    return fixed ? fixed : encoding_name(bytes);
}

}  // namespace luxel
