#include "baker/bake/page_lighter.h"

#include <algorithm>
#include <cmath>

#include "baker/bake/light_stages.h"
#include "baker/bake/stopping.h"
#include "baker/core/sobol.h"
#include "baker/light/pane_colour.h"
#include "baker/light/patch_irradiance.h"
#include "baker/light/share_light.h"

namespace luxel {
namespace {

/// Of the first gathering, per texel: what texels send is read by many rays of the second, so its noise hardly shows.
constexpr std::uint32_t first_rays = 8;

Rgb to_rgb(const Channels& c) {
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
}

}  // namespace

PageLighter::PageLighter(const BakeOptions& options, const BakedGeometry& geometry, const BakedSources& sources, const BakedMatrix& matrix,
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

std::vector<TexelLight> PageLighter::light(std::uint32_t page, ProgressCounter& progress) {
    if (is_stopping(options_)) return {};
    find_colours();
    if (is_stopping(options_)) return {};  // there may have been no time for all colours
    if (options_.gather_rays > 0) return gathered(page, progress);
    std::vector<TexelLight> light;
    for (const Rgb& irradiance : interpolated(page)) light.push_back({.direct = irradiance});
    progress.add(light.size());
    return light;
}

std::vector<TexelLight> PageLighter::gathered(std::uint32_t page, ProgressCounter& progress) {
    if (!senders_ && !find_senders()) return {};
    // What is nearer than a patch is wide sees it as more than one brightness.
    const float near_m = patch_side_m(options_, g_.atlas);
    auto found = gather_page(input(), page, {options_.gather_rays, true, options_.lamp_points, near_m, options_.seed, options_.stop}, &progress);
    return found ? shared(page, std::move(*found)) : std::vector<TexelLight>();
}

std::vector<TexelLight> PageLighter::shared(std::uint32_t page, GatheredPage gathered) const {
    const auto share = [&](GatheredLight& light) {
        SharedLight found = share_light(g_.texels.pages[page], g_.texels.page_size, light, options_.share_texels);
        light = {};  // a page may be large
        return found;
    };
    const SharedLight emitted = share(gathered.emitted), reflected = share(gathered.reflected);
    std::vector<TexelLight> light(gathered.lamps.size());
    for (std::size_t k = 0; k < light.size(); ++k) {
        light[k] = {.direct = gathered.lamps[k] + emitted.irradiance[k], .indirect = reflected.irradiance[k], .rays = gathered.rays[k]};
        const float all = luminance(light[k].irradiance());
        if (all > 0) light[k].error = std::hypot(emitted.standard_error[k], reflected.standard_error[k]) / all;
    }
    return light;
}

GatherInput PageLighter::input() const {
    return {g_.scene, g_.atlas, g_.texels, g_.patches, *g_.tracer, senders_->emitters, senders_->radiosity, senders_->guides,
            sky_ ? &*sky_ : nullptr};
}

bool PageLighter::find_senders() {
    senders_.emplace(Senders{EmitterSet(g_.scene, g_.atlas, g_.patches), spread_radiosity(), find_guides()});
    RadiosityDetail radiosity(reflected_, PatchMean::texels);
    // Its own points, so that what this gathering happened to see does not come twice.
    const GatherOptions first{first_rays, true, 1, patch_side_m(options_, g_.atlas), mix(options_.seed, 0x6669727374), options_.stop};
    for (std::uint32_t page = 0; page < g_.atlas.page_count; ++page) {
        const auto found = gather_page(input(), page, first, nullptr);
        if (!found) {
            senders_.reset();
            return false;
        }
        radiosity.add_page(g_.texels, g_.patches, page, found->irradiance());
    }
    radiosity.finish();
    senders_->radiosity = std::move(radiosity);
    return true;
}

RadiosityDetail PageLighter::spread_radiosity() const {
    RadiosityDetail radiosity(reflected_);
    std::vector<Rgb> irradiance = add_lamps(solution_.result.irradiance, sources_.lamp_irradiance);
    recolour(irradiance);
    for (std::uint32_t page = 0; page < g_.atlas.page_count; ++page)
        radiosity.add_page(g_.texels, g_.patches, page,
                           interpolate_page(g_.atlas, g_.texels, g_.patches, irradiance, page, options_.patch_texels, Interpolation::linear));
    radiosity.finish();
    return radiosity;
}

LightGuides PageLighter::find_guides() const {
    std::vector<float> reflected, emitted;
    for (const Rgb& b : reflected_) reflected.push_back(luminance(b));
    for (const Patch& patch : g_.patches.patches) emitted.push_back(luminance(patch.emission));
    if (std::none_of(reflected.begin(), reflected.end(), [](float b) { return b > 0; })) return {};
    ClosedMatrix strips(*matrix_.strips, matrix_.area_m2, matrix_.closure);
    return {strips, g_.patches, reflected, emitted};
}

std::vector<Rgb> PageLighter::interpolated(std::uint32_t page) {
    if (irradiance_.empty()) {
        ClosedMatrix strips(*matrix_.strips, matrix_.area_m2, matrix_.closure);
        irradiance_ = patch_irradiance(strips, solution_.result.radiosity, sources_.lamp_irradiance);
        recolour(irradiance_);
    }
    return interpolate_page(g_.atlas, g_.texels, g_.patches, irradiance_, page, options_.patch_texels, options_.interpolation);
}

void PageLighter::recolour(std::vector<Rgb>& irradiance) const {
    for (std::size_t p = 0; p < colours_.size(); ++p)
        irradiance[p] = recoloured(irradiance[p], sources_.lamp_irradiance[p], colours_[p]);
}

void PageLighter::find_colours() {
    if (has_colours_) return;
    has_colours_ = true;
    colours_ = pane_colours({g_.scene, g_.atlas, g_.patches, *g_.tracer, reflected_, sources_.lamp_irradiance},
                            {.seed = options_.seed, .stop = options_.stop});
    for (std::size_t p = 0; p < colours_.size(); ++p)
        reflected_[p] = recoloured(reflected_[p], g_.patches.patches[p].reflectance * sources_.lamp_irradiance[p], colours_[p]);
}

}  // namespace luxel
