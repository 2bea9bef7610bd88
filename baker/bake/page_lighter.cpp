#include "baker/bake/page_lighter.h"

#include <algorithm>
#include <cmath>

#include "baker/bake/first_gathering.h"
#include "baker/bake/light_stages.h"
#include "baker/bake/stopping.h"
#include "baker/light/pane_colour.h"
#include "baker/light/patch_irradiance.h"
#include "baker/light/share_light.h"

namespace luxel {
namespace {

/// Of the page's mean light: what is darker may be wrong by as much as what is as bright as this.
constexpr float dark_share = 0.01f;

Rgb to_rgb(const Channels& c) {
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
}

}  // namespace

PageLighter::PageLighter(const BakeOptions& options, const BakedGeometry& geometry, const BakedSources& sources, const BakedMatrix& matrix,
                         const BakedSolution& solution, std::span<const std::uint8_t> dark)
    : options_(options), g_(geometry), sources_(sources), matrix_(matrix), solution_(solution), dark_(dark) {
    if (sources_.sky) sky_.emplace(g_.scene.sky);
    for (PatchNumber p = 0; p < g_.patches.count(); ++p) {
        Channels rest = solution.result.radiosity[p];
        for (std::size_t c = 0; c < 3; ++c)
            rest[c] = std::max(0.0, rest[c] - static_cast<double>(g_.patches.patches[p].emission[static_cast<int>(c)]));
        reflected_.push_back(to_rgb(rest));
    }
}

std::vector<TexelLight> PageLighter::light(std::uint32_t page, ProgressCounter& progress) {
    if (options_.gather_rays > 0) return gathered(page, progress);
    find_colours();
    if (is_stopping(options_)) return {};  // there may have been no time for all colours
    std::vector<TexelLight> light;
    for (const Rgb& irradiance : interpolated(page)) light.push_back({.direct = irradiance});
    progress.add(light.size());
    return light;
}

std::vector<TexelLight> PageLighter::gathered(std::uint32_t page, ProgressCounter& progress) {
    const std::optional<GatherInput> input = gather_input();
    if (!input) return {};
    // What is nearer than a patch is wide sees it as more than one brightness.
    const float near_m = patch_side_m(options_, g_.atlas);
    const GatherOptions gathering{options_.gather_rays, true,          options_.lamp_points, options_.edge_lamp_points(),
                                  near_m,               options_.seed, options_.stop};
    auto found = gather_page(*input, page, gathering, &progress);
    if (!found) return {};
    std::vector<std::uint8_t> doublings(found->rays.size(), 0);
    for (;;) {
        if (options_.error <= 0) return shared(page, std::move(*found));
        std::vector<TexelLight> light = shared(page, *found);
        const std::vector<std::uint32_t> chosen = too_uncertain(light, doublings);
        if (chosen.empty()) return light;
        if (!double_rays(*input, page, gathering, chosen, doublings, *found)) return {};
    }
}

std::vector<std::uint32_t> PageLighter::too_uncertain(std::span<const TexelLight> light, std::span<const std::uint8_t> doublings) const {
    double sum = 0;
    for (const TexelLight& texel : light) sum += static_cast<double>(luminance(texel.irradiance()));
    const float dark = dark_share * static_cast<float>(sum / static_cast<double>(std::max<std::size_t>(light.size(), 1)));
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t k = 0; k < light.size(); ++k) {
        const float own = luminance(light[k].irradiance());
        const bool may_have_more = std::uint64_t{options_.gather_rays} << (doublings[k] + 1) <= options_.most_gather_rays;
        if (may_have_more && static_cast<double>(light[k].error * own) > options_.error * static_cast<double>(std::max(own, dark))) chosen.push_back(k);
    }
    return chosen;
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
        if (all > 0) {
            light[k].bias = std::hypot(emitted.bias[k], reflected.bias[k]) / all;
            light[k].error = std::hypot(std::hypot(emitted.standard_error[k], reflected.standard_error[k]) / all, light[k].bias);
        }
    }
    return light;
}

std::optional<GatherInput> PageLighter::gather_input() {
    find_colours();
    if (is_stopping(options_) || (!senders_ && !find_senders())) return {};
    return input_now();
}

GatherInput PageLighter::input_now() const {
    return {g_.scene, g_.atlas, g_.texels, g_.patches, *g_.tracer, senders_->emitters, senders_->radiosity, senders_->guides,
            sky_ ? &*sky_ : nullptr, dark_};
}

bool PageLighter::find_senders() {
    senders_.emplace(Senders{EmitterSet(g_.scene, g_.atlas, g_.patches), spread_radiosity(), find_guides()});
    for (std::uint32_t round = 0; round < first_rounds(options_); ++round) {
        auto first = first_gathering(options_, round, g_, input_now(), reflected_);
        if (!first) {
            senders_.reset();
            return false;
        }
        senders_->radiosity = std::move(first->radiosity);
        first_rays_ += first->rays;
    }
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
    if (!sources_.sky && std::none_of(reflected.begin(), reflected.end(), [](float b) { return b > 0; })) return {};
    ClosedMatrix strips(*matrix_.strips, matrix_.area_m2, matrix_.closure);
    return {strips, g_.patches, reflected, emitted, sources_.sky.get()};
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
