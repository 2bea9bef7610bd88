#include "baker/output/viewer_profile.h"

#include "baker/output/named_choice.h"
#include "formats/base/error.h"

namespace luxel {

const ViewerProfileInfo& viewer_profile_info(ViewerProfile profile) {
    return all_viewer_profiles[static_cast<std::size_t>(profile)];
}

ViewerProfile parse_viewer_profile(const std::string& name, const std::string& where) {
    return row_named(all_viewer_profiles, name, where).profile;
}

void check_profile(ViewerProfile profile, LightmapFormat format, LightmapEncoding byte_encoding) {
    if (profile == ViewerProfile::mx && format != LightmapFormat::rgbm_mx)
        throw Error(ErrorCode::usage, "--lightmap-format",
                    std::string("expected rgbm-mx with --profile mx, whose viewers know no others, found ") + lightmap_format_info(format).name,
                    "leave it out, or choose another --profile");
    if (profile != ViewerProfile::hubs) return;
    if (format != LightmapFormat::png8 && format != LightmapFormat::rgbe)
        throw Error(ErrorCode::usage, "--lightmap-format",
                    std::string("expected rgbe or png8 with --profile hubs, whose viewers know no others, found ") + lightmap_format_info(format).name);
    if (format == LightmapFormat::png8 && byte_encoding != LightmapEncoding::linear8)
        throw Error(ErrorCode::usage, "--encoding", "expected linear8 with --profile hubs, whose viewers take 8-bit lightmaps as linear, found " + std::string(encoding_name(byte_encoding)));
}

bool embeds_foreign_pictures(ViewerProfile profile) { return profile == ViewerProfile::hubs; }

}  // namespace luxel
