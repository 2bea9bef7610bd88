#include "baker/bake/light_stages.h"

#include <algorithm>
#include <limits>

#include "baker/bake/stage_files.h"
#include "baker/bake/stopping.h"
#include "baker/light/gather.h"
#include "baker/light/pane_colour.h"
#include "baker/light/patch_irradiance.h"
#include "baker/light/share_light.h"
#include "baker/light/sky.h"

namespace luxel {
namespace {

Rgb to_rgb(const Channels& c) {
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
}

/// Fills the pages of one light in the bake folder, as many as there is time for.
class PageLighter {
  public:
    PageLighter(const BakeOptions& options, const BakedGeometry& geometry, const BakedSources& sources, const BakedMatrix& matrix,
                const BakedSolution& solution)
        : options_(options), g_(geometry), sources_(sources), matrix_(matrix), solution_(solution) {
        if (!g_.scene.sky.empty()) sky_.emplace(g_.scene.sky);
        for (PatchNumber p = 0; p < g_.patches.count(); ++p) {
            Channels rest = solution.result.radiosity[p];
            for (std::size_t c = 0; c < 3; ++c)
                rest[c] = std::max(0.0, rest[c] - static_cast<double>(g_.patches.patches[p].emission[static_cast<int>(c)]));
            reflected_.push_back(to_rgb(rest));
        }
    }

    /// Empty: there was no time for it.
    std::vector<Rgb> light(std::uint32_t page, ProgressCounter& progress) {
        if (is_stopping(options_)) return {};
        find_colours();
        if (is_stopping(options_)) return {};  // there may have been no time for all colours
        if (options_.gather_rays == 0) {
            progress.add(g_.texels.pages[page].texels.size());
            return interpolated(page);
        }
        if (!senders_) senders_.emplace(*this);
        // What is nearer than a patch is wide sees it as more than one brightness.
        const float near_m = patch_side_m(options_, g_.atlas);
        const GatherInput input{g_.scene, g_.atlas, g_.texels, g_.patches, *g_.tracer, senders_->emitters, senders_->radiosity, senders_->guides,
                                sky_ ? &*sky_ : nullptr};
        const auto gathered = gather_page(input, page, {options_.gather_rays, true, options_.lamp_points, near_m, options_.seed, options_.stop}, &progress);
        if (!gathered) return {};
        const PageTexels& texels = g_.texels.pages[page];
        std::vector<Rgb> sum = gathered->lamps;
        for (const GatheredLight* part : {&gathered->emitted, &gathered->reflected}) {
            const SharedLight shared = share_light(texels, g_.texels.page_size, *part, options_.share_texels);
            for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += shared.irradiance[k];
        }
        return sum;
    }

  private:
    /// What the rays of texels meet.
    struct Senders {
        EmitterSet emitters;
        RadiosityDetail radiosity;
        LightGuides guides;

        explicit Senders(PageLighter& of) : emitters(of.g_.scene, of.g_.atlas, of.g_.patches), radiosity(of.reflected_) {
            std::vector<Rgb> irradiance = add_lamps(of.solution_.result.irradiance, of.sources_.lamp_irradiance);
            of.recolour(irradiance);
            for (std::uint32_t page = 0; page < of.g_.atlas.page_count; ++page)
                radiosity.add_page(of.g_.texels, of.g_.patches, page,
                                   interpolate_page(of.g_.atlas, of.g_.texels, of.g_.patches, irradiance, page, of.options_.patch_texels,
                                                    Interpolation::linear));
            radiosity.finish();
            std::vector<float> reflected, emitted;
            for (const Rgb& b : of.reflected_) reflected.push_back(luminance(b));
            for (const Patch& patch : of.g_.patches.patches) emitted.push_back(luminance(patch.emission));
            const bool is_dark = std::none_of(reflected.begin(), reflected.end(), [](float b) { return b > 0; });
            if (is_dark) return;
            ClosedMatrix strips(*of.matrix_.strips, of.matrix_.area_m2, of.matrix_.closure);
            guides = LightGuides(strips, of.g_.patches, reflected, emitted);
        }
    };

    /// Irradiance of the patches, spread over the texels of a page.
    std::vector<Rgb> interpolated(std::uint32_t page) {
        if (irradiance_.empty()) {
            ClosedMatrix strips(*matrix_.strips, matrix_.area_m2, matrix_.closure);
            irradiance_ = patch_irradiance(strips, solution_.result.radiosity, sources_.lamp_irradiance);
            recolour(irradiance_);
        }
        return interpolate_page(g_.atlas, g_.texels, g_.patches, irradiance_, page, options_.patch_texels, options_.interpolation);
    }

    void recolour(std::vector<Rgb>& irradiance) const {
        for (std::size_t p = 0; p < colours_.size(); ++p)
            irradiance[p] = recoloured(irradiance[p], sources_.lamp_irradiance[p], colours_[p]);
    }

    /// Once, when the first page needs them.
    void find_colours() {
        if (has_colours_) return;
        has_colours_ = true;
        colours_ = pane_colours({g_.scene, g_.atlas, g_.patches, *g_.tracer, reflected_, sources_.lamp_irradiance},
                                {.seed = options_.seed, .stop = options_.stop});
        for (std::size_t p = 0; p < colours_.size(); ++p)
            reflected_[p] = recoloured(reflected_[p], g_.patches.patches[p].reflectance * sources_.lamp_irradiance[p], colours_[p]);
    }

    const BakeOptions& options_;
    const BakedGeometry& g_;
    const BakedSources& sources_;
    const BakedMatrix& matrix_;
    const BakedSolution& solution_;
    std::optional<Sky> sky_;
    std::vector<Rgb> reflected_;   // per patch
    std::vector<Rgb> irradiance_;  // per patch, only for drafts
    std::vector<Rgb> colours_;     // per patch, only where panes tint
    bool has_colours_ = false;
    std::optional<Senders> senders_;
};

Key light_key(const BakeOptions& options, const Key& solution) {
    return KeyBuilder("light 8")
        .key(solution)
        .integer(options.gather_rays)
        .integer(options.share_texels)
        .integer(options.lamp_points)
        .integer(static_cast<std::int64_t>(options.seed))
        .integer(static_cast<int>(options.interpolation))
        .finish();
}

}  // namespace

// Both ways to light, gathered and interpolated, know only the sum so far.
bool parts_light(const BakeOptions&) { return false; }

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
        ProgressCounter progress(g.texels.texel_count(), clock.progress("texels"));
        PageLighter lighter(options, g, sources, matrix, solution);
        bool reused = true;
        missing = 0;
        for (std::uint32_t page = 0; page < g.atlas.page_count; ++page) {
            const auto path = BakeFolder::lightmap_file(light.folder, page);
            const std::size_t texels = g.texels.pages[page].texels.size();
            if (load_lightmap(path, light.key, texels)) continue;
            reused = false;
            const std::vector<Rgb> irradiance = lighter.light(page, progress);
            if (irradiance.size() == texels) save_lightmap(path, light.key, irradiance);
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
        if (auto irradiance = load_lightmap(BakeFolder::lightmap_file(light.folder, page), light.key, g.texels.pages[page].texels.size()))
            return std::move(*irradiance);
    if (!light.patch_irradiance)
        throw Error(ErrorCode::damaged_store, light.folder.string(), "page " + std::to_string(page) + " is gone",
                    "run the same command again");
    return interpolate_page(g.atlas, g.texels, g.patches, *light.patch_irradiance, page, options.patch_texels, options.interpolation);
}

}  // namespace luxel
