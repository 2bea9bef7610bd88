#include "baker/light/texel_lamps.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>

#include "baker/core/parallel.h"
#include "baker/light/lamps.h"
#include "baker/light/texel_seed.h"
#include "baker/light/texel_window.h"
#include "baker/patches/patch_sampler.h"
#include "baker/patches/smooth_rise.h"

namespace luxel {
namespace {

/// Of a texel's light: values that differ by more belong to both sides of an edge.
constexpr float contrast = 0.05f;
/// Lamps that seem to be even may cost as much as so many that are not.
constexpr std::size_t even_tests = 4;
/// Names of the two patterns of points.
constexpr std::uint64_t first_points = 0x6c616d7073, further_points = 0x65646765;

/// How far values lie apart.
struct Range {
    float least = std::numeric_limits<float>::max(), most = 0;
    void add(float value) { least = std::min(least, value), most = std::max(most, value); }
    [[nodiscard]] bool is_wide(float other) const { return most - least > contrast * (most + other); }
};

struct LampSample {
    LightPoint at;
    Vec2f on_lamp;
    float random;
};

class TexelLamps {
  public:
    TexelLamps(const Scene& scene, const Atlas& atlas, const PageTexels& page, const Tracer& tracer, const TexelLampOptions& options)
        : scene_(scene), atlas_(atlas), page_(page), options_(options), lamps_(scene, tracer) {}

    /// By the first points. `is_uneven`: they differ.
    Rgb light(const Texel& texel, float other, bool& is_uneven) const {
        const SurfaceSampler sampler = sampler_of(texel);
        const RankedLamps lamps = ranked(sampler);
        Rgb sum(0, 0, 0);
        Range range;
        for (const LampSample& sample : samples(texel, sampler, first_points, options_.points)) {
            const Rgb light = lamps_.irradiance(lamps, sample.at, sample.random, sample.on_lamp);
            sum += light;
            range.add(luminance(light));
        }
        is_uneven = range.is_wide(other);
        return sum / static_cast<float>(options_.points);
    }

    /// By many further points. `all`: luminance of all that the texel gets, about.
    [[nodiscard]] Rgb light_at_edge(const Texel& texel, float all) const {
        const SurfaceSampler sampler = sampler_of(texel);
        const RankedLamps lamps = ranked(sampler);
        const std::vector<LampSample> first = samples(texel, sampler, first_points, options_.points),
                                      further = samples(texel, sampler, further_points, options_.edge_points);
        // Of a lamp that seems to be even over the texel; the first points of a pattern are a pattern themselves.
        const std::size_t share = even_tests * further.size() / std::max<std::size_t>(lamps.strong.size(), 1);
        const std::size_t few = std::clamp(std::bit_floor(share), std::min(2 * first.size(), further.size()), further.size());
        Rgb sum(0, 0, 0);
        for (const std::uint32_t lamp : lamps.strong) {
            Range range;
            for (const LampSample& sample : first) range.add(luminance(lamps_.irradiance_of(lamp, sample.at, sample.on_lamp)));
            const std::size_t count = range.most - range.least > contrast * all ? further.size() : few;
            Rgb light(0, 0, 0);
            for (std::size_t k = 0; k < count; ++k) light += lamps_.irradiance_of(lamp, further[k].at, further[k].on_lamp);
            sum += light / static_cast<float>(count);
        }
        if (lamps.weak.empty()) return sum;
        Rgb light(0, 0, 0);
        for (const LampSample& sample : further) light += lamps_.weak_irradiance(lamps, sample.at, sample.random, sample.on_lamp);
        return sum + light / static_cast<float>(further.size());
    }

  private:
    [[nodiscard]] SurfaceSampler sampler_of(const Texel& texel) const {
        return {scene_, atlas_, {page_.fragments.data() + texel.first_fragment, texel.fragment_count}, false};
    }

    [[nodiscard]] RankedLamps ranked(const SurfaceSampler& sampler) const {
        const Vec3f middle = sampler.point(0.5f, 0.5f).position;
        const std::optional<Vec3f> normal = sampler.one_shading_normal();
        return rank_lamps(lamp_strengths(scene_.lamps, middle, sampler.reach_m(middle), normal ? &*normal : nullptr));
    }

    [[nodiscard]] std::vector<LampSample> samples(const Texel& texel, const SurfaceSampler& sampler, std::uint64_t purpose,
                                                  std::uint32_t count) const {
        const std::uint64_t seed = mix(texel_seed(scene_, atlas_, texel, options_.seed), purpose);
        const SobolSequence places(seed), on_lamps(mix(seed, 0x6f6e6c616d70));
        std::vector<LampSample> samples(count);
        for (std::uint32_t k = 0; k < count; ++k) {
            const auto u = places.point(k), w = on_lamps.point(k);
            const SurfacePoint at = sampler.point(u[0], u[1]);
            samples[k] = {{at.position, at.normal, sampler.shading_normal(at), at.triangle, smooth_rise(scene_, at.triangle, at.barycentric)},
                          {w[0], w[1]}, u[2]};
        }
        return samples;
    }

    const Scene& scene_;
    const Atlas& atlas_;
    const PageTexels& page_;
    const TexelLampOptions& options_;
    LampLight lamps_;
};

/// Do the texels beside it say that an edge may run through this one? Where there are none, it may.
bool may_be_edge(const TexelGrid& grid, std::uint32_t texel, const std::vector<Rgb>& light, const std::vector<std::uint8_t>& uneven,
                 float other) {
    TexelWindow window(grid, texel);
    window.grow(0);
    const auto beside = window.grow(1);
    if (beside.size() < 2) return true;
    Range range;
    for (const TexelWindow::Member& member : beside) {
        if (uneven[member.texel]) return true;
        range.add(luminance(light[member.texel]));
    }
    return range.is_wide(other);
}

}  // namespace

std::optional<std::vector<Rgb>> texel_lamps(const Scene& scene, const Atlas& atlas, const PageTexels& page, std::uint32_t page_size,
                                            const Tracer& tracer, std::span<const float> other, const TexelLampOptions& options) {
    const std::size_t count = page.texels.size();
    std::vector<Rgb> light(count, Rgb(0, 0, 0));
    if (scene.lamps.empty()) return light;
    const TexelLamps lamps(scene, atlas, page, tracer, options);
    std::vector<std::uint8_t> uneven(count, 0);
    std::atomic<bool> stopped{false};
    const auto for_texels = [&](const auto& visit) {
        parallel_ranges(count, 256, [&](std::size_t, std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                if (options.stop && options.stop->is_asked()) stopped = true;
                if (stopped) return;
                if (page.can_send(page.texels[k])) visit(k);
            }
        });
    };
    for_texels([&](std::size_t k) {
        bool is_uneven = false;
        light[k] = lamps.light(page.texels[k], other[k], is_uneven);
        uneven[k] = is_uneven;
    });
    if (options.edge_points > options.points && !stopped) {
        std::vector<std::uint8_t> at_edge(count, 0);
        {
            const TexelGrid grid(page, page_size);
            for_texels([&](std::size_t k) { at_edge[k] = may_be_edge(grid, static_cast<std::uint32_t>(k), light, uneven, other[k]); });
        }
        for_texels([&](std::size_t k) {
            if (at_edge[k]) light[k] = lamps.light_at_edge(page.texels[k], luminance(light[k]) + other[k]);
        });
    }
    if (stopped) return {};
    return light;
}

}  // namespace luxel
