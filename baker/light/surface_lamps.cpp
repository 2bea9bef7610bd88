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

SurfaceLamps::Lamps SurfaceLamps::lamps_of(const Piece& piece) const {
    const Vec3f middle = piece.sampler.point(0.5f, 0.5f).position;
    const float reach_m = piece.sampler.reach_m(middle);
    const std::optional<Vec3f> normal = piece.sampler.one_shading_normal();
    std::vector<LampStrength> strengths = lamp_strengths(scene_.lamps, middle, reach_m, normal ? &*normal : nullptr);
    Lamps lamps;
    std::erase_if(strengths, [&](const LampStrength& strength) {
        const Lamp& lamp = scene_.lamps[strength.lamp];
        if (lamp.kind == LampKind::directional || (lamp.position - middle).length() >= reach_m) return false;
        LampCells cells(piece.sampler, lamp.position);
        if (cells.is_even()) return false;
        lamps.close.push_back({strength.lamp, std::move(cells)});
        return true;
    });
    lamps.far = rank_lamps(std::move(strengths));
    return lamps;
}

std::vector<SurfaceLamps::Sample> SurfaceLamps::samples(const Piece& piece, std::uint64_t purpose, std::uint32_t count, const LampCells* cells) const {
    const std::uint64_t seed = mix(piece.seed, purpose);
    const SobolSequence places(seed);
    const ShuffledSobol on_lamps(mix(seed, points_on_lamps));
    std::vector<Sample> samples(count);
    for (std::uint32_t k = 0; k < count; ++k) {
        const auto u = places.point(k), w = on_lamps.point(k);
        const LampCells::Place place = cells ? cells->place(u[0], u[1]) : LampCells::Place{u[0], u[1], 1};
        const SurfacePoint at = piece.sampler.point(place.u, place.v);
        samples[k] = {{at.position, at.normal, at.normal, at.triangle}, {w[0], w[1]}, u[2], place.weight};
        if (!piece.smooth) continue;
        samples[k].at.shading_normal = piece.sampler.shading_normal(at);
        samples[k].at.rise = smooth_rise(scene_, at.triangle, at.barycentric);
    }
    return samples;
}

std::vector<Rgb> SurfaceLamps::close_light(const Piece& piece, std::span<const CloseLamp> close, std::uint64_t purpose, std::uint32_t count) const {
    std::vector<Rgb> light(count, Rgb(0, 0, 0));
    for (const CloseLamp& lamp : close) {
        const std::vector<Sample> own = samples(piece, mix(purpose, lamp.lamp + 1), count, &lamp.cells);
        for (std::uint32_t k = 0; k < count; ++k) light[k] += lamps_.irradiance_of(lamp.lamp, own[k].at, own[k].on_lamp) * own[k].weight;
    }
    return light;
}

SurfaceLamps::Few SurfaceLamps::by_few(const Piece& piece, std::uint32_t points) const {
    const Lamps lamps = lamps_of(piece);
    const std::vector<Sample> shared = samples(piece, first_points, points);
    const std::vector<Rgb> close = close_light(piece, lamps.close, first_points, points);
    Few few;
    for (std::uint32_t k = 0; k < points; ++k) {
        const Sample& sample = shared[k];
        const Rgb strong = lamps_.strong_irradiance(lamps.far, sample.at, sample.on_lamp) + close[k];
        few.light += strong + lamps_.weak_irradiance(lamps.far, sample.at, sample.random, sample.on_lamp);
        few.strong += luminance(strong);
        few.range.add(luminance(strong));
    }
    few.light /= static_cast<float>(points), few.strong /= static_cast<float>(points);
    return few;
}

Rgb SurfaceLamps::by_many(const Piece& piece, std::uint32_t few_points, std::uint32_t points, float other) const {
    const Lamps all_lamps = lamps_of(piece);
    const RankedLamps& lamps = all_lamps.far;
    const std::vector<Sample> first = samples(piece, first_points, few_points), further = samples(piece, further_points, points);
    Rgb sum(0, 0, 0);
    for (const Rgb& light : close_light(piece, all_lamps.close, further_points, points)) sum += light / static_cast<float>(points);
    std::vector<LightRange> ranges(lamps.strong.size());
    float all = other + luminance(sum);
    for (std::size_t lamp = 0; lamp < ranges.size(); ++lamp) {
        float by_few = 0;
        for (const Sample& sample : first) {
            const float light = luminance(lamps_.irradiance_of(lamps.strong[lamp], sample.at, sample.on_lamp));
            ranges[lamp].add(light), by_few += light;
        }
        all += by_few / static_cast<float>(few_points);
    }
    // Of a lamp that seems to be even; the first points of a pattern are a pattern themselves.
    const std::size_t share = even_tests * further.size() / std::max<std::size_t>(lamps.strong.size(), 1);
    const std::size_t few = std::clamp(std::bit_floor(share), first.size(), further.size());
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
