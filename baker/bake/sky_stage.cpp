#include "baker/bake/sky_stage.h"

#include <algorithm>
#include <bit>

#include "baker/bake/stopping.h"
#include "baker/formfactors/sky_view.h"
#include "baker/light/patch_sky.h"
#include "baker/light/sky_split.h"

namespace luxel {
namespace {

/// Places of a patch from which the bright part of the sky is tested, at least: each has one ray.
constexpr std::uint32_t least_bright_points = 16;

/// As many as evidence has on average.
std::uint32_t sky_rays(const BakeOptions& options) {
    return static_cast<std::uint32_t>(std::bit_ceil(std::clamp<std::uint64_t>(options.rays, 64, 4096)));
}

void trace_view(const BakeOptions& options, const BakedGeometry& g, const std::filesystem::path& path, const StageClock& clock) {
    ProgressCounter progress(g.patches.count(), clock.progress("patches"));
    const SkyViewOptions rays{sky_rays(options), options.seed};
    SkyViewWriter file(path, sky_view_key(options, g), g.patches.count(), rays.rays);
    for (std::size_t begin = 0; begin < g.patches.count(); begin += sky_view_block) {
        if (is_stopping(options)) refuse_without_light(options, "stopped while the sky's view was traced");
        const std::size_t end = std::min<std::size_t>(begin + sky_view_block, g.patches.count());
        file.append(count_sky_rays(g.scene, g.atlas, g.patches, *g.tracer, static_cast<PatchNumber>(begin),
                                   static_cast<PatchNumber>(end), rays));
        progress.add(end - begin);
    }
    file.publish();
}

/// Returns whether any patch sees the sky.
bool add_binned(const SkyInView& sky, std::vector<Rgb>& irradiance) {
    bool is_seen = false;
    sky.visit(0, static_cast<PatchNumber>(irradiance.size()), [&](PatchNumber patch, std::span<const SkyBin> bins, std::span<const std::uint16_t> counts) {
        is_seen |= !bins.empty();
        irradiance[patch] += binned_irradiance(sky.bin_nits(), bins, counts, sky.rays());
    });
    return is_seen;
}

}  // namespace

Key sky_view_key(const BakeOptions& options, const BakedGeometry& g) {
    return KeyBuilder("sky view 4")
        .key(g.layout_key)
        .text(tracer_identity())
        .integer(static_cast<std::int64_t>(options.seed))
        .integer(sky_rays(options))
        .finish();
}

std::unique_ptr<const SkyInView> add_sky_light(const BakeOptions& options, const BakedGeometry& g, const BakeFolder& folder,
                                               std::vector<Rgb>& irradiance, StageClock& clock, BakeReport& report) {
    std::unique_ptr<const SkyInView> sky;
    if (g.scene.sky.empty()) return sky;
    const Key key = sky_view_key(options, g);
    const auto path = folder.sky_view(key);
    clock.stage("sky view", [&] {
        clock.keeps(path);
        if (std::filesystem::exists(path)) return true;
        trace_view(options, g, path, clock);
        return false;
    });
    clock.stage("sky", [&] {
        SkySplit split = split_sky(g.scene.sky);
        sky = std::make_unique<SkyInView>(path, key, g.patches.count(), std::move(split.bins));
        if (add_binned(*sky, irradiance)) {
            add_bright_sky(g.scene, g.atlas, g.patches, *g.tracer, split.bright,
                           std::max(least_bright_points, options.lamp_points), irradiance);
        } else if (!options.forced.has(Part::sky)) {
            report.skipped.emplace_back(part_name(Part::sky), "no surface sees it");
            sky.reset();
        }
        return false;
    });
    return sky;
}

}  // namespace luxel
