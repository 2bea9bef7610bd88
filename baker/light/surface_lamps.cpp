#include "baker/light/surface_lamps.h"

#include <bit>

#include "baker/core/sobol.h"
#include "baker/patches/smooth_rise.h"

namespace luxel {
namespace {

/// Lamps that seem to be even may cost as much as so many that are not.
constexpr std::size_t even_tests = 4;
/// The weak lamps, which are a tenth of the light, are asked at every so many of the points.
constexpr std::size_t weak_part = 4;
/// Names of the patterns of points, and of those on lamps.
constexpr std::uint64_t first_points = 0x6c616d7073, further_points = 0x65646765, points_on_lamps = 0x6f6e6c616d70;

}  // namespace

RankedLamps SurfaceLamps::ranked(const Piece& piece) const {
    const Vec3f middle = piece.sampler.point(0.5f, 0.5f).position;
    const std::optional<Vec3f> normal = piece.sampler.one_shading_normal();
    return rank_lamps(lamp_strengths(scene_.lamps, middle, piece.sampler.reach_m(middle), normal ? &*normal : nullptr));
}

std::vector<SurfaceLamps::Sample> SurfaceLamps::samples(const Piece& piece, std::uint64_t purpose, std::uint32_t count) const {
    const std::uint64_t seed = mix(piece.seed, purpose);
    const SobolSequence places(seed);
    const ShuffledSobol on_lamps(mix(seed, points_on_lamps));
    std::vector<Sample> samples(count);
    for (std::uint32_t k = 0; k < count; ++k) {
        const auto u = places.point(k), w = on_lamps.point(k);
        const SurfacePoint at = piece.sampler.point(u[0], u[1]);
        samples[k] = {{at.position, at.normal, at.normal, at.triangle}, {w[0], w[1]}, u[2]};
        if (!piece.smooth) continue;
        samples[k].at.shading_normal = piece.sampler.shading_normal(at);
        samples[k].at.rise = smooth_rise(scene_, at.triangle, at.barycentric);
    }
    return samples;
}

SurfaceLamps::Few SurfaceLamps::by_few(const Piece& piece, std::uint32_t points) const {
    const RankedLamps lamps = ranked(piece);
    Few few;
    for (const Sample& sample : samples(piece, first_points, points)) {
        const Rgb strong = lamps_.strong_irradiance(lamps, sample.at, sample.on_lamp);
        few.light += strong + lamps_.weak_irradiance(lamps, sample.at, sample.random, sample.on_lamp);
        few.strong += luminance(strong);
        few.range.add(luminance(strong));
    }
    few.light /= static_cast<float>(points), few.strong /= static_cast<float>(points);
    return few;
}

Rgb SurfaceLamps::by_many(const Piece& piece, std::uint32_t few_points, std::uint32_t points, float other) const {
    const RankedLamps lamps = ranked(piece);
    const std::vector<Sample> first = samples(piece, first_points, few_points), further = samples(piece, further_points, points);
    std::vector<LightRange> ranges(lamps.strong.size());
    float all = other;
    for (std::size_t lamp = 0; lamp < ranges.size(); ++lamp) {
        float sum = 0;
        for (const Sample& sample : first) {
            const float light = luminance(lamps_.irradiance_of(lamps.strong[lamp], sample.at, sample.on_lamp));
            ranges[lamp].add(light), sum += light;
        }
        all += sum / static_cast<float>(few_points);
    }
    // Of a lamp that seems to be even; the first points of a pattern are a pattern themselves.
    const std::size_t share = even_tests * further.size() / std::max<std::size_t>(lamps.strong.size(), 1);
    const std::size_t few = std::clamp(std::bit_floor(share), first.size(), further.size());
    Rgb sum(0, 0, 0);
    for (std::size_t lamp = 0; lamp < ranges.size(); ++lamp) {
        const std::size_t count = ranges[lamp].is_wide(all) ? further.size() : few;
        Rgb light(0, 0, 0);
        for (std::size_t k = 0; k < count; ++k) light += lamps_.irradiance_of(lamps.strong[lamp], further[k].at, further[k].on_lamp);
        sum += light / static_cast<float>(count);
    }
    const std::size_t weak_count = std::max<std::size_t>(further.size() / weak_part, 1);
    Rgb light(0, 0, 0);
    for (std::size_t k = 0; k < weak_count; ++k) light += lamps_.weak_irradiance(lamps, further[k].at, further[k].random, further[k].on_lamp);
    return sum + light / static_cast<float>(weak_count);
}

}  // namespace luxel
