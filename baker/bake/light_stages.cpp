#include "baker/bake/light_stages.h"

#include <algorithm>
#include <limits>

#include "baker/bake/page_lighter.h"
#include "baker/bake/stage_files.h"
#include "baker/bake/stopping.h"

namespace luxel {
namespace {

Key light_key(const BakeOptions& options, const Key& solution) {
    return KeyBuilder("light 9")
        .key(solution)
        .integer(options.gather_rays)
        .integer(options.share_texels)
        .integer(options.lamp_points)
        .integer(static_cast<std::int64_t>(options.seed))
        .integer(static_cast<int>(options.interpolation))
        .finish();
}

}  // namespace

bool parts_light(const BakeOptions& options) { return options.gather_rays > 0; }

BakedLight light_texels(const BakeOptions& options, const BakedGeometry& g, const BakedSources& sources,
                        const BakedMatrix& matrix, const BakedSolution& solution, const BakeFolder& folder,
                        StageClock& clock, BakeReport& report) {
    BakedLight light;
    light.key = light_key(options, solution.key);
    if (options.gather_rays == 0) report.skipped.push_back({"gather", "draft quality interpolates the patches"});
    std::uint32_t missing = g.atlas.page_count;
    clock.stage("light", [&] {
        if (!solution.is_whole) return false;
        light.folder = folder.lightmaps(light.key);
        if (parts_light(options))
            light.texel_light = [&g, folder = light.folder, key = light.key](std::uint32_t page) {
                return load_page_light(BakeFolder::lightmap_file(folder, page), key, g.texels.pages[page].texels.size()).value_or(std::vector<TexelLight>());
            };
        ProgressCounter progress(g.texels.texel_count(), clock.progress("texels"));
        PageLighter lighter(options, g, sources, matrix, solution);
        bool reused = true;
        missing = 0;
        for (std::uint32_t page = 0; page < g.atlas.page_count; ++page) {
            const auto path = BakeFolder::lightmap_file(light.folder, page);
            const std::size_t texels = g.texels.pages[page].texels.size();
            if (load_page_light(path, light.key, texels)) continue;
            reused = false;
            const std::vector<TexelLight> found = lighter.light(page, progress);
            if (found.size() == texels) save_page_light(path, light.key, found);
            else ++missing;
        }
        return reused;
    });
    if (missing) {
        light.patch_irradiance = add_lamps(solution.result.irradiance, sources.lamp_irradiance);
        light.state = "stopped";
        std::error_code not_empty;
        if (!light.folder.empty()) std::filesystem::remove(light.folder, not_empty);
        note_stop(report, "light", std::to_string(missing) + " of " + std::to_string(g.atlas.page_count) +
                                       " pages are interpolated from the patches");
    } else if (report.stopped) {
        light.state = "stopped";
    }
    return light;
}

std::vector<Rgb> add_lamps(std::span<const Channels> irradiance, std::span<const Rgb> lamp_irradiance) {
    // What is still a guess may leave the range of a picture.
    constexpr double most = std::numeric_limits<float>::max();
    std::vector<Rgb> sum(irradiance.size());
    for (std::size_t p = 0; p < sum.size(); ++p)
        for (int c = 0; c < 3; ++c)
            sum[p][c] = static_cast<float>(
                std::min(irradiance[p][static_cast<std::size_t>(c)] + static_cast<double>(lamp_irradiance[p][c]), most));
    return sum;
}

std::vector<Rgb> page_light(const BakeOptions& options, const BakedGeometry& g, const BakedLight& light, std::uint32_t page) {
    if (!light.folder.empty())
        if (auto irradiance = load_page_irradiance(BakeFolder::lightmap_file(light.folder, page), light.key, g.texels.pages[page].texels.size()))
            return std::move(*irradiance);
    if (!light.patch_irradiance)
        throw Error(ErrorCode::damaged_store, light.folder.string(), "page " + std::to_string(page) + " is gone",
                    "run the same command again");
    return interpolate_page(g.atlas, g.texels, g.patches, *light.patch_irradiance, page, options.patch_texels, options.interpolation);
}

}  // namespace luxel
