/// The options of a bake: what the command line says, and what it means. Commands that look at a bake without doing it share them.
#pragma once
#include <CLI/App.hpp>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "baker/bake/bake.h"
#include "tools/luxel/model_options.h"

namespace luxel {

/// Names of --quality, the fastest first.
inline constexpr std::array qualities{"draft", "medium", "high", "reference"};

/// As they were typed; values that were not given are those of the help.
struct BakeArguments {
    std::string input, output, quality = "medium", uv = "unwrap", memory = "2G", work, report, interpolation = "linear", aov,
                                seams = "join", importance = "on", estimator = "ray",
                                chunks = "rooms", store = "all", store_bytes, solver = "shoot", scene, bad_values = "clamp", blend_colour = "off", gather = "on", instances = "share", two_sided = "front", vertex_colours = "on", settings, force;
    std::string sky, sky_color;
    ModelArguments model;
    double sky_turn = 0, sky_scale = 1, lamp_radius = 0, sun_angle = 0;
    double texels_per_metre = 0, tolerance = 0, error = 0, target_seconds = 0, stop_after_s = 0, preview_s = 0, checkpoint_s = 20;
    std::uint32_t atlas_size = 1024, padding = 2, patch_texels = 4, chunk_patches = 2048, gather_rays = 0, max_rays = 0, lamp_points = 0, share = 8, hemicube_resolution = 64;
    std::uint64_t rays = 0, seed = 0;
    unsigned threads = 0;
    bool verify = false, force_all = false, quiet = false, skip_skinned = false, allow_outside = false;
};

/// All of them but --output.
void add_bake_options(CLI::App& command, BakeArguments& arguments);

/// --target-seconds of luxel bake and plan; a sweep has one of its own.
void add_target_seconds(CLI::App& command, BakeArguments& arguments);

/// Asks `stop` for the time of --stop-after, from now on, if the user gave it.
void ask_stop_after(const BakeArguments& arguments, const CLI::App& command, StopRequest& stop);

/// What they mean. Throws Error{usage} on what does not go together.
BakeOptions resolve_bake_options(const BakeArguments& arguments, const CLI::App& command);

/// Name and value as text of each, for reports.
std::vector<std::pair<std::string, std::string>> bake_settings(const BakeArguments& arguments, const BakeOptions& options);

}  // namespace luxel
