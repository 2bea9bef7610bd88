#include "tools/luxel/bake_options.h"

#include <fmt/format.h>

#include <CLI/Validators.hpp>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "tools/luxel/size_option.h"
#include "tools/luxel/unsigned_option.h"

namespace luxel {
namespace {

/// What --quality stands for; each number can be set by its own option.
struct Preset {
    const char* name;
    std::uint64_t rays;
    std::uint32_t gather_rays, lamp_points;
    double tolerance;
};
constexpr std::array<Preset, 4> presets{{{qualities[0], 128, 0, 4, 1e-2}, {qualities[1], 256, 128, 16, 1e-3}, {qualities[2], 1024, 1024, 64, 1e-4}, {qualities[3], 8192, 8192, 256, 1e-5}}};

constexpr std::uint32_t highest_rays = 1u << 20;  ///< per texel

/// Refuses what a range check lets through: not-a-number compares with nothing.
const CLI::Validator finite(
    [](std::string& text) { return std::isnan(std::strtod(text.c_str(), nullptr)) ? "expected a number" : std::string(); },
    "", "finite");

/// Takes the word for the number that switches a thing off.
const CLI::Validator off_or_number(
    [](std::string& text) {
        if (text == "off") text = "0";
        return std::string();
    },
    "", "off or a number");

/// "R,G,B" or one number for all three, nits.
std::array<double, 3> parse_nits(const std::string& text) {
    std::array<double, 3> nits{};
    std::size_t count = 0;
    const char* at = text.c_str();
    bool more = true;
    for (; more && count < 3; ++count) {
        char* end = nullptr;
        nits[count] = std::strtod(at, &end);
        if (end == at || !(nits[count] >= 0 && nits[count] <= most_light)) break;
        more = *end == ',';
        at = more ? end + 1 : end;
    }
    const bool is_whole = !more && *at == 0;
    if (is_whole && count == 1) nits[1] = nits[2] = nits[0];
    else if (!is_whole || count != 3)
        throw Error(ErrorCode::usage, "--sky-color", "expected R,G,B in nits, each from 0 to 1e30, found " + text,
                    "for example --sky-color 3000,4000,6000");
    return nits;
}

SkyChoice sky_choice(const BakeArguments& a) {
    SkyChoice sky{.none = a.sky == "none", .color = {}, .picture = {}, .turn_degrees = a.sky_turn, .scale = a.sky_scale};
    if (!a.sky_color.empty() && !a.sky.empty())
        throw Error(ErrorCode::usage, "--sky-color", "--sky was given too, but there is only one sky", "leave out one of them");
    if (!a.sky_color.empty()) sky.color = parse_nits(a.sky_color);
    if (!a.sky.empty() && !sky.none) sky.picture = a.sky;
    return sky;
}

std::vector<std::string> interpolation_names() {
    std::vector<std::string> names;
    for (const Interpolation interpolation : all_interpolations) names.emplace_back(interpolation_name(interpolation));
    return names;
}

void add_input_options(CLI::App& command, BakeArguments& a) {
    command.add_option("input", a.input, "scene, .gltf or .glb")->required()->type_name("IN");
    command.add_option("--scene", a.scene, "of a file with several: number or name (the file's default)")->type_name("SCENE")->group("Input");
    command.add_flag("--skip-skinned", a.skip_skinned, "leave out meshes with a skin, which move; otherwise they stand in their rest pose")->group("Input");
    command.add_option("--vertex-colours,--vertex-colors", a.vertex_colours, "COLOR_0 of meshes multiplies base colour and alpha, as glTF says; off: as if there were none")
        ->check(CLI::IsMember({"on", "off"}))->capture_default_str()->group("Input");
    command.add_option("--settings", a.settings, "what is said of single nodes by patterns of their names: lightmap, density, shadow, as JSON (docs/settings.md)")
        ->type_name("FILE")->group("Input");
    command.add_flag("--allow-outside", a.allow_outside, "the scene may read files outside of its folder, by \"..\" or absolute paths")->group("Input");
}

void add_quality_options(CLI::App& command, BakeArguments& a) {
    command.add_option("--quality", a.quality, "preset of rays, gathering and tolerance")
        ->check(CLI::IsMember(std::vector<std::string>(qualities.begin(), qualities.end())))->capture_default_str()->group("Quality");
    command.add_option("--rays", a.rays, "evidence rays per patch on average (128 / 256 / 1024 / 8192 by quality)")
        ->check(CLI::Range(std::uint64_t{4}, std::uint64_t{1} << 24))->group("Quality");
    command.add_option("--estimator", a.estimator, "of form factors: rays, or the classic hemicube for comparison")
        ->check(CLI::IsMember({"ray", "hemicube"}))->capture_default_str()->group("Quality");
    command.add_option("--hemicube-resolution", a.hemicube_resolution, "pixels along an edge of the hemicube, even")
        ->check(CLI::Range(2u, 4096u))->capture_default_str()->group("Quality");
    command.add_option("--error", a.error, "trace until the relative error of the light of patches and of texels is below this, such as 0.02")
        ->check(finite)->check(CLI::Range(1e-4, 1.0))->group("Quality");
    command.add_option("--importance", a.importance, "after a thin first round, rays go where they help most; off: the same for all")
        ->check(CLI::IsMember({"on", "off"}))->capture_default_str()->group("Quality");
    command.add_option("--gather", a.gather, "light at every texel by rays of its own, as --quality and --gather-rays say; off: patches are interpolated")
        ->check(CLI::IsMember({"on", "off"}))->capture_default_str()->group("Quality");
    command.add_option("--gather-rays", a.gather_rays, "rays per texel, a power of two; 0 interpolates patches (0 / 128 / 1024 / 8192)")
        ->check(CLI::Range(0u, highest_rays))->group("Quality");
    command.add_option("--max-rays", a.max_rays, "most rays per texel, where --error asks for more than --gather-rays (16 times as many)")
        ->check(unsigned_number)->check(CLI::Range(0u, highest_rays))->group("Quality");
    command.add_option("--lamp-points", a.lamp_points, "points of a texel at which punctual lamps are tested, a power of two; 8 times as many where a shadow may have its edge (4 / 16 / 64 / 256)")
        ->check(unsigned_number)->check(CLI::Range(1u, 1024u))->group("Quality");
    command.add_option("--tolerance", a.tolerance, "bound of the relative error of the solve (1e-2 / 1e-3 / 1e-4 / 1e-5)")
        ->check(finite)->check(CLI::Range(1e-12, 1.0))->group("Quality");
    command.add_option("--solver", a.solver, "shooting by chunks, conjugate gradients, or as baselines gathering by strips, the series of bounces, shooting by patches; same light")
        ->check(CLI::IsMember(std::vector<std::string>(solver_names().begin(), solver_names().end())))->capture_default_str()->group("Quality");
    command.add_option("--patch-texels", a.patch_texels, "side of a patch in texels")
        ->check(CLI::Range(1u, 64u))->capture_default_str()->group("Quality");
    command.add_option("--share", a.share, "texels over which gathered light may be shared where it is even, 0 .. 8; 0 or off: not")
        ->transform(off_or_number)->check(CLI::Range(0, 8))->capture_default_str()->group("Quality");
    command.add_option("--interpolation", a.interpolation, "of patches over texels where nothing is gathered, as in drafts and previews")
        ->check(CLI::IsMember(interpolation_names()))->capture_default_str()->group("Quality");
    command.add_option("--blend-colour,--blend-color", a.blend_colour,
                       "light that alpha BLEND lets through takes the base colour, like coloured glass; off: alpha covers, the rest is clear")
        ->check(CLI::IsMember({"on", "off"}))->capture_default_str()->group("Quality");
}

void add_light_options(CLI::App& command, BakeArguments& a) {
    command.add_option("--sky", a.sky, "picture of the sky in nits by longitude and latitude, .exr or .hdr; none: no sky (what the scene has)")
        ->type_name("FILE")->group("Light");
    command.add_option("--sky-color", a.sky_color, "the same sky everywhere, nits: L gives pi L lux to a surface that sees all of it")
        ->type_name("R,G,B")->group("Light");
    command.add_option("--sky-rotate", a.sky_turn, "turn the sky, degrees counter-clockwise seen from above")
        ->check(finite)->check(CLI::Range(-1e6, 1e6))->type_name("DEG")->capture_default_str()->group("Light");
    command.add_option("--sky-scale", a.sky_scale, "factor of the sky's light")
        ->check(finite)->check(CLI::Range(0.0, 1e30))->capture_default_str()->group("Light");
    command.add_option("--lamp-radius", a.lamp_radius, "of point and spot lamps that the scene gives no size, metres: soft shadows")
        ->check(finite)->check(CLI::Range(0.0, 1e6))->type_name("M")->capture_default_str()->group("Light");
    command.add_option("--sun-angle", a.sun_angle, "apparent diameter of directional lamps that the scene gives no size, degrees; the sun has 0.53")
        ->check(finite)->check(CLI::Range(0.0, 170.0))->type_name("DEG")->capture_default_str()->group("Light");
}

void add_lightmap_options(CLI::App& command, BakeArguments& a) {
    command.add_option("--texels-per-metre", a.texels_per_metre, "density of the lightmap; 0: about half a page for the scene")
        ->check(finite)->check(CLI::Range(0.0, 1e9))->capture_default_str()->group("Lightmap");
    command.add_option("--atlas-size", a.atlas_size, "side of a page in texels")
        ->check(CLI::Range(16u, 16384u))->capture_default_str()->group("Lightmap");
    command.add_option("--padding", a.padding, "free texels around charts")
        ->check(CLI::Range(0u, 64u))->capture_default_str()->group("Lightmap");
    command.add_option("--uv", a.uv, "new charts, or keep the file's second UV set where it is fit")
        ->check(CLI::IsMember({"unwrap", "keep"}))->capture_default_str()->group("Lightmap");
    command.add_option("--instances", a.instances, "of one mesh: keep one copy of its geometry, each in its own place by KHR_texture_transform, or split them")
        ->check(CLI::IsMember({"share", "split"}))->capture_default_str()->group("Lightmap");
    command.add_option("--two-sided", a.two_sided, "texels of two-sided surfaces hold the light of their front, or of their back where the front lies in the dark")
        ->check(CLI::IsMember({"front", "lit"}))->capture_default_str()->group("Lightmap");
    command.add_option("--seams", a.seams, "between charts where the surface goes on: make both sides agree, or leave them as computed")
        ->check(CLI::IsMember({"join", "keep"}))->capture_default_str()->group("Lightmap");
    add_model_options(command, a.model);
    command.add_option("--aov", a.aov, "layers to write beside the lightmap, separated by commas: " + known_layer_names())
        ->type_name("LIST")->group("Lightmap");
}

void add_running_options(CLI::App& command, BakeArguments& a) {
    command.add_option("--bad-values", a.bad_values,
                       "colours outside 0 to 1, light below 0 or above 1e30: the nearest that can be, with a warning, or an error")
        ->check(CLI::IsMember({"clamp", "refuse"}))->capture_default_str()->group("Running");
    command.add_option("--memory", a.memory, "budget beside the scene's geometry, K/M/G")
        ->capture_default_str()->group("Running");
    command.add_option("--store", a.store, "what of the form factors stays on disk; the rest is traced again, with the same result")
        ->check(CLI::IsMember({"all", "hot", "none"}))->capture_default_str()->group("Running");
    command.add_option("--store-bytes", a.store_bytes, "of --store hot, K/M/G (a quarter of what all takes)")->group("Running");
    command.add_option("--threads", a.threads, "0: all cores")
        ->check(CLI::Range(0u, 1024u))->capture_default_str()->group("Running");
    command.add_option("--chunks", a.chunks, "patches that see each other, found by a thin round of rays, or cubes of space")
        ->check(CLI::IsMember({"rooms", "tiles"}))->capture_default_str()->group("Running");
    command.add_option("--chunk-patches", a.chunk_patches, "patches per chunk at most")
        ->check(CLI::Range(16u, 65536u))->capture_default_str()->group("Running");
    command.add_option("--seed", a.seed, "of all sample patterns")->check(unsigned_number)->capture_default_str()->group("Running");
    command.add_option("--work", a.work, "bake folder: kept, and reused by the next run")->type_name("DIR")->group("Running");
    command.add_option("--stop-after", a.stop_after_s, "end then with what is there, seconds; with --work the next run goes on")
        ->check(finite)->check(CLI::Range(0.0, 1e9))->type_name("SECONDS")->group("Running");
    command.add_option("--preview-every", a.preview_s, "while solving, write the light so far to the output; 0: never")
        ->check(finite)->check(CLI::Range(0.0, 1e9))->type_name("SECONDS")->capture_default_str()->group("Running");
    command.add_option("--checkpoint-every", a.checkpoint_s, "what a killed solve loses at most; 0: one step")
        ->check(finite)->check(CLI::Range(0.0, 1e9))->type_name("SECONDS")->capture_default_str()->group("Running");
    command.add_option("--report", a.report, "write what was done as JSON")->type_name("FILE")->group("Running");
    command.add_option("--force", a.force, "do what this scene does not need, separated by commas: " + part_names(every_part()) + "; the same light, later (docs/needs.md)")
        ->type_name("LIST")->group("Running");
    command.add_flag("--force-all", a.force_all, "do all of that")->excludes("--force")->group("Running");
    command.add_flag("--verify", a.verify, "at the end check everything in the bake folder, as luxel inspect --verify does")->group("Running");
    command.add_flag("-q,--quiet", a.quiet, "no progress, no summary")->group("Running");
}

}  // namespace

void add_bake_options(CLI::App& command, BakeArguments& arguments) {
    add_input_options(command, arguments);
    add_quality_options(command, arguments);
    add_light_options(command, arguments);
    add_lightmap_options(command, arguments);
    add_running_options(command, arguments);
}

void add_target_seconds(CLI::App& command, BakeArguments& arguments) {
    command.add_option("--target-seconds", arguments.target_seconds, "take the best quality that will be done in this time, as luxel plan foresees it")
        ->check(finite)->check(CLI::Range(1e-3, 1e9))->type_name("SECONDS")->group("Quality");
}

void ask_stop_after(const BakeArguments& arguments, const CLI::App& command, StopRequest& stop) {
    if (command.count("--stop-after") == 0) return;
    stop.ask_at(StopRequest::Clock::now() +
                std::chrono::duration_cast<StopRequest::Clock::duration>(std::chrono::duration<double>(arguments.stop_after_s)));
}

BakeOptions resolve_bake_options(const BakeArguments& a, const CLI::App& command) {
    BakeOptions o;
    const auto given = [&](const char* name) { return command.count(name) > 0; };
    for (const Preset& preset : presets)
        if (a.quality == preset.name) {
            o.rays = given("--rays") ? a.rays : preset.rays;
            o.gather_rays = a.gather == "off" ? 0 : given("--gather-rays") ? a.gather_rays : preset.gather_rays;
            o.share_texels = a.share;
            o.lamp_points = given("--lamp-points") ? a.lamp_points : preset.lamp_points;
            o.tolerance = given("--tolerance") ? a.tolerance : preset.tolerance;
        }
    if (a.gather == "off" && given("--gather-rays") && a.gather_rays > 0)
        throw Error(ErrorCode::usage, "--gather", "expected no --gather-rays beside off, found " + std::to_string(a.gather_rays), "leave out one of the two");
    if (o.gather_rays && !std::has_single_bit(o.gather_rays))
        throw Error(ErrorCode::usage, "--gather-rays", "expected 0 or a power of two, found " + std::to_string(o.gather_rays),
                    "sample patterns are whole only at powers of two; use " + std::to_string(std::bit_ceil(o.gather_rays)));
    if (!std::has_single_bit(o.lamp_points))
        throw Error(ErrorCode::usage, "--lamp-points", "expected a power of two, found " + std::to_string(o.lamp_points),
                    "sample patterns are whole only at powers of two; use " + std::to_string(std::bit_ceil(o.lamp_points)));
    if (given("--max-rays") && !(a.error > 0))
        throw Error(ErrorCode::usage, "--max-rays", "it says how far --error may go, but there is none",
                    "add --error, or say the number of rays with --gather-rays");
    if (given("--max-rays") && a.max_rays < o.gather_rays)
        throw Error(ErrorCode::usage, "--max-rays", "expected at least --gather-rays, " + std::to_string(o.gather_rays) + ", found " + std::to_string(a.max_rays),
                    "each texel gets --gather-rays to begin with");
    o.most_gather_rays = given("--max-rays") ? a.max_rays : std::min(16 * o.gather_rays, highest_rays);
    o.input = a.input;
    o.output = a.output;
    o.work = a.work;
    o.scene = a.scene;
    o.skip_skinned = a.skip_skinned;
    o.vertex_colors = a.vertex_colours == "on";
    o.settings = a.settings;
    o.allow_outside = a.allow_outside;
    o.bad_values = a.bad_values == "refuse" ? BadValues::refuse : BadValues::clamp;
    o.lamp_radius = a.lamp_radius;
    o.sun_angle_degrees = a.sun_angle;
    o.sky = sky_choice(a);
    o.blend_colours = a.blend_colour == "on";
    o.unwrap.texels_per_metre = a.texels_per_metre;
    o.unwrap.page_size = a.atlas_size;
    o.unwrap.padding = a.padding;
    o.unwrap.uv_mode = a.uv == "keep" ? UvMode::keep : UvMode::unwrap;
    o.unwrap.instances = a.instances == "split" ? InstanceMode::split : InstanceMode::share;
    o.two_sided = a.two_sided == "lit" ? TwoSidedTexels::lit : TwoSidedTexels::front;
    o.patch_texels = a.patch_texels;
    o.chunk_patches = a.chunk_patches;
    o.chunks = a.chunks == "tiles" ? ChunkKind::tiles : ChunkKind::rooms;
    o.estimator = a.estimator == "hemicube" ? EstimatorKind::hemicube : EstimatorKind::ray;
    if (o.estimator == EstimatorKind::hemicube && a.error > 0)
        throw Error(ErrorCode::usage, "--error", "the counts of the hemicube do not scatter, so no error can be found from them",
                    "leave out --error, or choose --estimator ray");
    o.hemicube_resolution = a.hemicube_resolution;
    o.store = a.store == "none" ? StoreKind::no_blocks : a.store == "hot" ? StoreKind::hot : StoreKind::all;
    if (given("--store-bytes")) {
        if (o.store != StoreKind::hot)
            throw Error(ErrorCode::usage, "--store-bytes", "it says how much --store hot may keep, but --store is " + a.store,
                        "add --store hot, or leave out --store-bytes");
        o.store_bytes = parse_bytes(a.store_bytes, "--store-bytes");
        if (o.store_bytes == 0) throw Error(ErrorCode::usage, "--store-bytes", "expected at least one byte", "--store none keeps nothing");
    }
    o.importance = a.importance == "on";
    o.solver = *solver_kind(a.solver);
    o.error = a.error;
    o.interpolation = *interpolation_of(a.interpolation);
    o.seams = a.seams == "keep" ? SeamMode::keep : SeamMode::join;
    resolve_model_options(a.model, command, o);
    if (given("--aov")) o.layers = parse_layers(a.aov, "--aov");
    o.seed = a.seed;
    o.memory_bytes = parse_bytes(a.memory, "--memory");
    o.threads = a.threads;
    o.forced = a.force_all ? every_part() : parse_parts(a.force, "--force");
    o.verify = a.verify;
    o.preview_s = a.preview_s;
    o.checkpoint_s = a.checkpoint_s;
    o.software = "luxel " LUXEL_VERSION;
    return o;
}

std::vector<std::pair<std::string, std::string>> bake_settings(const BakeArguments& a, const BakeOptions& o) {
    return {{"input", a.input},
            {"output", a.output},
            {"quality", a.quality},
            {"bad-values", a.bad_values},
            {"lamp-radius", fmt::format("{}", a.lamp_radius)},
            {"sun-angle", fmt::format("{}", a.sun_angle)},
            {"sky", a.sky.empty() ? "scene" : a.sky},
            {"sky-color", a.sky_color.empty() ? "none" : a.sky_color},
            {"sky-rotate", fmt::format("{}", a.sky_turn)},
            {"sky-scale", fmt::format("{}", a.sky_scale)},
            {"blend-colour", a.blend_colour},
            {"texels-per-metre", a.texels_per_metre > 0 ? fmt::format("{}", a.texels_per_metre) : "auto"},
            {"atlas-size", std::to_string(o.unwrap.page_size)},
            {"padding", std::to_string(o.unwrap.padding)},
            {"uv", a.uv},
            {"instances", a.instances},
            {"two-sided", a.two_sided},
            {"scene", a.scene.empty() ? "default" : a.scene},
            {"allow-outside", a.allow_outside ? "on" : "off"},
            {"skip-skinned", a.skip_skinned ? "on" : "off"},
            {"vertex-colours", a.vertex_colours},
            {"settings", a.settings.empty() ? "none" : a.settings},
            {"patch-texels", std::to_string(o.patch_texels)},
            {"chunks", a.chunks},
            {"chunk-patches", std::to_string(o.chunk_patches)},
            {"rays", std::to_string(o.rays)},
            {"estimator", a.estimator},
            {"hemicube-resolution", std::to_string(o.hemicube_resolution)},
            {"importance", a.importance},
            {"error", a.error > 0 ? fmt::format("{}", a.error) : "none"},
            {"gather", o.gather_rays ? "on" : "off"},
            {"gather-rays", std::to_string(o.gather_rays)},
            {"max-rays", std::to_string(o.most_gather_rays)},
            {"lamp-points", std::to_string(o.lamp_points)},
            {"share", std::to_string(o.share_texels)},
            {"solver", a.solver},
            {"tolerance", fmt::format("{}", o.tolerance)},
            {"interpolation", a.interpolation},
            {"seams", a.seams},
            {"lightmap-format", lightmap_format_info(o.format).name},
            {"encoding", encoding_of(o.format, o.encoding)},
            {"dither", a.model.dither},
            {"profile", a.model.profile},
            {"unlit", o.unlit ? "on" : "off"},
            {"unlit-exposure", o.unlit_exposure > 0 ? fmt::format("{}", o.unlit_exposure) : "auto"},
            {"draco", o.draco ? "on" : "off"},
            {"draco-bits", a.model.draco_bits.empty() ? draco_bits_text({}) : a.model.draco_bits},
            {"meshopt", o.meshopt ? "on" : "off"},
            {"split", a.model.split},
            {"split-triangles", std::to_string(o.split_triangles)},
            {"aov", layer_names(o.layers)},
            {"seed", std::to_string(o.seed)},
            {"memory", a.memory},
            {"store", store_name(o.store)},
            {"store-bytes", a.store_bytes.empty() ? "auto" : a.store_bytes},
            {"threads", std::to_string(o.threads)},
            {"target-seconds", a.target_seconds > 0 ? fmt::format("{}", a.target_seconds) : "none"},
            {"stop-after", a.stop_after_s > 0 ? fmt::format("{}", a.stop_after_s) : "none"},
            {"preview-every", a.preview_s > 0 ? fmt::format("{}", a.preview_s) : "none"},
            {"checkpoint-every", fmt::format("{}", a.checkpoint_s)},
            {"force", part_names(o.forced)},
            {"verify", a.verify ? "on" : "off"},
            {"work", a.work}};
}

}  // namespace luxel
