#include "tools/luxel/model_options.h"

#include <fmt/format.h>

#include <CLI/Validators.hpp>

namespace luxel {

void add_model_options(CLI::App& command, ModelArguments& a) {
    command.add_option("--lightmap-format", a.format, "of the pages in the glTF: 8 or 16 bits with a factor, shared multiplier or exponent, half floats (png8; hubs: rgbe; mx: rgbm-mx)")
        ->check(CLI::IsMember({"png8", "png16", "rgbm", "rgbm-mx", "rgbe", "exr", "ktx2"}))->group("Lightmap");
    command.add_option("--encoding", a.encoding, "of png8 (srgb8; hubs: linear8)")
        ->check(CLI::IsMember({"srgb8", "linear8"}))->group("Lightmap");
    command.add_option("--dither", a.dither, "png8: round up or down by place, so that even surfaces are right in the mean; off: to the nearest")
        ->check(CLI::IsMember({"on", "off"}))->capture_default_str()->group("Lightmap");
    command.add_option("--profile", a.profile, "viewers that the glTF is made for: factor pi, colour space, lightmaps on materials or nodes")
        ->check(CLI::IsMember({"three", "hubs", "plain", "mx"}))->capture_default_str()->group("Lightmap");
    command.add_flag("--unlit", a.unlit, "write OUT's stem.unlit.glb too: its pictures are base colour times light, which any viewer shows")->group("Lightmap");
    command.add_option("--unlit-exposure", a.unlit_exposure, "of --unlit: picture = nits * X (so that 99 % of it is not cut)")
        ->check(CLI::Range(1e-30, 1e30))->type_name("X")->group("Lightmap");
}

void resolve_model_options(const ModelArguments& a, const CLI::App& command, BakeOptions& o) {
    o.profile = parse_viewer_profile(a.profile, "--profile");
    const ViewerProfileInfo& profile = viewer_profile_info(o.profile);
    o.format = a.format.empty() ? profile.format : parse_lightmap_format(a.format, "--lightmap-format");
    o.encoding = a.encoding.empty() ? profile.byte_encoding : parse_encoding(a.encoding);
    o.dither = a.dither == "on";
    for (const char* name : {"--encoding", "--dither"})
        if (command.count(name) && o.format != LightmapFormat::png8)
            throw Error(ErrorCode::usage, name,
                        std::string("it is of png8 only, but the format") + (a.format.empty() ? " of --profile " + a.profile : "") + " is " + lightmap_format_info(o.format).name,
                        o.profile == ViewerProfile::mx ? "leave it out, or choose another --profile" : "leave it out, or add --lightmap-format png8");
    check_profile(o.profile, o.format, o.encoding);
    o.unlit = a.unlit;
    o.unlit_exposure = a.unlit_exposure;
    if (command.count("--unlit-exposure") && !a.unlit)
        throw Error(ErrorCode::usage, "--unlit-exposure", "it is of the unlit model, but --unlit is not given", "add --unlit, or leave it out");
}

namespace {

/// Two digits, and never in powers of ten.
std::string percent(double share) { return share >= 0.0995 ? fmt::format("{:.0f} %", 100 * share) : fmt::format("{:.2g} %", 100 * share); }

}  // namespace

std::string picture_error_text(const BakeReport& report, const BakeOptions& options) {
    std::optional<PictureError> worst;
    for (const OutputReport& output : report.outputs)
        if (output.error) worst = worst ? worst->worst_of(*output.error) : *output.error;
    if (!worst) return {};
    return fmt::format(" ({} within {}, 95 % of texels within {})", lightmap_format_info(options.format).name, percent(worst->median), percent(worst->p95));
}

}  // namespace luxel
