#include "tools/luxel/model_options.h"

#include <fmt/format.h>

#include <CLI/Validators.hpp>

#include "tools/luxel/unsigned_option.h"

namespace luxel {
namespace {

void add_lightmap_options(CLI::App& command, ModelArguments& a) {
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

void add_packing_options(CLI::App& command, ModelArguments& a) {
    command.add_flag("--draco", a.draco, "compress the meshes of the result by Draco (KHR_draco_mesh_compression)")->group("Result");
    command.add_option("--draco-bits", a.draco_bits,
                       "bits kept of each number, 1 .. 24 (POSITION=14,NORMAL=10,TEXCOORD=12,COLOR=8,LIGHTMAP=auto,OTHER=12)")
        ->type_name("LIST")->group("Result");
    command.add_flag("--meshopt", a.meshopt, "compress the arrays of the result without loss (EXT_meshopt_compression), after --draco what that left")->group("Result");
    command.add_option("--split", a.split, "write the scene in parts too, each a GLB, with an index: by the chunks of patches")
        ->check(CLI::IsMember({"none", "chunks"}))->capture_default_str()->group("Result");
    command.add_option("--split-triangles", a.split_triangles, "fewest triangles of a part; smaller ones join the one that they see most of")
        ->check(unsigned_number)->check(CLI::Range(0u, 1u << 30))->capture_default_str()->group("Result");
}

void resolve_lightmap_options(const ModelArguments& a, const CLI::App& command, BakeOptions& o) {
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

void resolve_packing_options(const ModelArguments& a, const CLI::App& command, BakeOptions& o) {
    if (command.count("--draco-bits") && !a.draco)
        throw Error(ErrorCode::usage, "--draco-bits", "it says how exact --draco is, but there is none", "add --draco, or leave it out");
    if (a.draco) o.draco = command.count("--draco-bits") ? parse_draco_bits(a.draco_bits, "--draco-bits") : DracoBits();
    o.meshopt = a.meshopt;
    if (command.count("--split-triangles") && a.split == "none")
        throw Error(ErrorCode::usage, "--split-triangles", "it says how small the files of --split may be, but there is none", "add --split chunks, or leave it out");
    o.split_chunks = a.split == "chunks";
    o.split_triangles = a.split_triangles;
}

/// Two digits, and never in powers of ten.
std::string percent(double share) { return share >= 0.0995 ? fmt::format("{:.0f} %", 100 * share) : fmt::format("{:.2g} %", 100 * share); }

}  // namespace

void add_model_options(CLI::App& command, ModelArguments& arguments) {
    add_lightmap_options(command, arguments);
    add_packing_options(command, arguments);
}

void resolve_model_options(const ModelArguments& arguments, const CLI::App& command, BakeOptions& options) {
    resolve_lightmap_options(arguments, command, options);
    resolve_packing_options(arguments, command, options);
}

std::string picture_error_text(const BakeReport& report, const BakeOptions& options) {
    std::optional<PictureError> worst;
    for (const OutputReport& output : report.outputs)
        if (output.error) worst = worst ? worst->worst_of(*output.error) : *output.error;
    if (!worst) return {};
    return fmt::format(" ({} within {}, 95 % of texels within {})", lightmap_format_info(options.format).name, percent(worst->median), percent(worst->p95));
}

}  // namespace luxel
