#include "baker/bake/light_stages.h"

#include <algorithm>
#include <limits>

#include "baker/accuracy/dark_patches.h"
#include "baker/bake/decisions.h"
#include "baker/bake/page_lighter.h"
#include "baker/bake/stage_files.h"
#include "baker/bake/stopping.h"

namespace luxel {
namespace {

Key light_key(const BakeOptions& options, const Key& solution) {
    return KeyBuilder("light 26")
        .key(solution)
        .integer(options.gather_rays)
        .number(options.gather_rays ? options.error : 0)
        .integer(options.gather_rays && options.error > 0 ? options.most_gather_rays : 0)
        .integer(options.share_texels)
        .integer(options.lamp_points)
        .integer(static_cast<std::int64_t>(options.seed))
        .integer(static_cast<int>(options.interpolation))
        .integer(options.forced.has(Part::dark_patches))
        .integer(options.forced.has(Part::sky))
        .finish();
}

/// Errors and rays of all texels that have light of their own.
class TexelErrors {
  public:
    void add(const PageTexels& page, std::span<const TexelLight> light) {
        for (std::size_t k = 0; k < light.size(); ++k)
            if (page.can_send(page.texels[k])) errors_.push_back(light[k].error), rays_ += light[k].rays;
    }
    [[nodiscard]] std::optional<GatherReport> report() {
        if (errors_.empty()) return {};
        const auto quantile = [&](double share) {
            const auto at = errors_.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(errors_.size() - 1));
            std::nth_element(errors_.begin(), at, errors_.end());
            return static_cast<double>(*at);
        };
        return GatherReport{static_cast<double>(rays_) / static_cast<double>(errors_.size()), quantile(0.5), quantile(0.95)};
    }

  private:
    std::vector<float> errors_;
    std::uint64_t rays_ = 0;
};

/// Stage "dark patches": those whose texels need not look for light.
std::vector<std::uint8_t> dark_patches(const BakeOptions& options, const BakedGeometry& g, const BakedSources& sources, const BakedMatrix& matrix,
                                       const BakedSolution& solution, StageClock& clock, BakeReport& report) {
    std::vector<std::uint8_t> dark;
    if (!parts_light(options) || !solution.is_whole || options.forced.has(Part::dark_patches)) return dark;
    const RayTallies& tallies = matrix.strips->tallies();
    const bool lit_from_afar = has_light(g);  // what is in the open may be, by what no ray has met
    std::vector<bool> may_be_lit(g.patches.count());
    for (PatchNumber p = 0; p < may_be_lit.size(); ++p)
        may_be_lit[p] = solution.result.radiosity[p] != Channels{} || solution.result.irradiance[p] != Channels{} || sources.lamp_irradiance[p] != Rgb(0, 0, 0) ||
                        (lit_from_afar && tallies.open[p] > 0);
    if (std::ranges::all_of(may_be_lit, [](bool lit) { return lit; })) return dark;
    clock.stage("dark patches", [&] {
        ClosedMatrix strips(*matrix.strips, matrix.area_m2, matrix.closure);
        dark = find_dark_patches(strips, may_be_lit);
        return false;
    });
    const auto count = std::ranges::count(dark, std::uint8_t{1});
    if (count) report.skipped.emplace_back(part_name(Part::dark_patches), std::to_string(count) + " of " + std::to_string(dark.size()) + " patches, which no light reaches: nothing is gathered there");
    return dark;
}

}  // namespace

bool parts_light(const BakeOptions& options) { return options.gather_rays > 0; }

BakedLight light_texels(const BakeOptions& options, const BakedGeometry& g, const BakedSources& sources,
                        const BakedMatrix& matrix, const BakedSolution& solution, const BakeFolder& folder,
                        StageClock& clock, BakeReport& report) {
    BakedLight light;
    light.key = light_key(options, solution.key);
    const std::vector<std::uint8_t> dark = dark_patches(options, g, sources, matrix, solution, clock, report);
    std::uint32_t missing = g.shown_pages;
    TexelErrors errors;
    clock.stage("light", [&] {
        if (!solution.is_whole) return false;
        light.folder = folder.lightmaps(light.key);
        clock.keeps(light.folder);
        if (parts_light(options))
            light.texel_light = [&g, folder = light.folder, key = light.key](std::uint32_t page) {
                return load_page_light(BakeFolder::lightmap_file(folder, page), key, g.texels.pages[page].texels.size()).value_or(std::vector<TexelLight>());
            };
        std::uint64_t texel_count = 0;
        for (std::uint32_t page = 0; page < g.shown_pages; ++page) texel_count += g.texels.pages[page].texels.size();
        ProgressCounter progress(texel_count, clock.progress("texels"));
        PageLighter lighter(options, g, sources, matrix, solution, dark);
        bool reused = true;
        missing = 0;
        for (std::uint32_t page = 0; page < g.shown_pages; ++page) {
            const auto path = BakeFolder::lightmap_file(light.folder, page);
            const std::size_t texels = g.texels.pages[page].texels.size();
            if (const auto known = load_page_light(path, light.key, texels)) {
                errors.add(g.texels.pages[page], *known);
                continue;
            }
            reused = false;
            const std::vector<TexelLight> found = lighter.light(page, progress);
            if (found.size() == texels) {
                errors.add(g.texels.pages[page], found);
                save_page_light(path, light.key, found);
            } else {
                ++missing;
            }
        }
        return reused;
    });
    if (missing) {
        light.patch_irradiance = add_lamps(solution.result.irradiance, sources.lamp_irradiance);
        light.state = "stopped";
        std::error_code not_empty;
        if (!light.folder.empty()) std::filesystem::remove(light.folder, not_empty);
        note_stop(report, "light", std::to_string(missing) + " of " + std::to_string(g.shown_pages) +
                                       " pages are interpolated from the patches");
    } else {
        if (report.stopped) light.state = "stopped";
        if (parts_light(options)) report.gathering = errors.report();
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
