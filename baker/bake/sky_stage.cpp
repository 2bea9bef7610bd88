#include "baker/bake/sky_stage.h"

#include <algorithm>
#include <bit>

#include "baker/bake/stopping.h"
#include "baker/formfactors/sky_view.h"
#include "baker/light/patch_sky.h"

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
bool add_binned(const SkyViewReader& view, std::span<const Rgb> bin_nits, std::vector<Rgb>& irradiance) {
    bool is_seen = false;
    for (std::size_t block = 0; block < view.block_count(); ++block) {
        const SkyCounts counts = view.read(block);
        const std::span<const std::uint8_t> bins(counts.bins);
        const std::span<const std::uint16_t> of_bins(counts.counts);
        is_seen |= !bins.empty();
        std::size_t at = 0;
        for (std::size_t k = 0; k < counts.bins_of_patch.size(); ++k) {
            const std::size_t count = counts.bins_of_patch[k];
            irradiance[block * sky_view_block + k] +=
                binned_irradiance(bin_nits, bins.subspan(at, count), of_bins.subspan(at, count), view.rays());
            at += count;
        }
    }
    return is_seen;
}

}  // namespace

Key sky_view_key(const BakeOptions& options, const BakedGeometry& g) {
    return KeyBuilder("sky view 3")
        .key(g.layout_key)
        .text(tracer_identity())
        .integer(static_cast<std::int64_t>(options.seed))
        .integer(sky_rays(options))
        .finish();
}

void add_sky_light(const BakeOptions& options, const BakedGeometry& g, const BakeFolder& folder, std::vector<Rgb>& irradiance,
                   StageClock& clock, BakeReport& report) {
    if (g.scene.sky.empty()) return;
    const Key key = sky_view_key(options, g);
    const auto path = folder.sky_view(key);
    clock.stage("sky view", [&] {
        if (std::filesystem::exists(path)) return true;
        trace_view(options, g, path, clock);
        return false;
    });
    clock.stage("sky", [&] {
        const SkyViewReader view(path, key);
        if (view.patch_count() != g.patches.count())
            throw Error(ErrorCode::damaged_store, path.string(),
                        "expected " + std::to_string(g.patches.count()) + " patches, found " + std::to_string(view.patch_count()),
                        "remove the file and run the same command again");
        const SkySplit split = split_sky(g.scene.sky);
        if (add_binned(view, split.bins, irradiance))
            add_bright_sky(g.scene, g.atlas, g.patches, *g.tracer, split.bright,
                           std::max(least_bright_points, options.lamp_points), irradiance);
        else
            report.skipped.push_back({"sky", "no surface sees it"});
        return false;
    });
}

}  // namespace luxel
