#include "baker/solver/inner_solve.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace luxel {
namespace {

constexpr double inner_tolerance_share = 0.1;
constexpr std::uint32_t max_inner_iterations = 1000;

}  // namespace

Channels unnoticed_rest(double tolerance, const Channels& power, std::size_t chunk_count) {
    Channels rest{0, 0, 0};
    for (std::size_t c = 0; c < 3; ++c)
        rest[c] = inner_tolerance_share * tolerance * power[c] / static_cast<double>(chunk_count);
    return rest;
}

std::vector<Lanes> solve_inside(const Transport& transport, const Adjoint& adjoint, const ChunkSystem& system,
                                std::span<const Lanes> arriving, std::span<const Lanes> first_guess,
                                const InnerRest& rest) {
    std::vector<Lanes> light(arriving.begin(), arriving.end());
    if (!system.has_pairs()) return light;
    // X = f + s y with (I - s G s) y = s G f; a residual r in y leaves s r.
    const std::size_t count = light.size();
    std::vector<Lanes> right, y(count), weight(count);
    system.multiply(light, right);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const PatchNumber patch = transport.first(system.chunk()) + static_cast<PatchNumber>(i);
            const double s = system.scale()[i].v[c];
            right[i].v[c] *= s;
            weight[i].v[c] = s * transport.area_m2(patch) * adjoint.weight(patch)[c];
            y[i].v[c] = s > 0 ? (first_guess[i].v[c] - light[i].v[c]) / s : 0.0;
        }
    std::optional<Channels> limit;
    const auto stop = [&](std::span<const Lanes> residual) {
        Channels left{0, 0, 0};
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t c = 0; c < 3; ++c) left[c] += weight[i].v[c] * std::abs(residual[i].v[c]);
        if (!limit) {
            limit = rest.allowed;
            for (std::size_t c = 0; c < 3; ++c) (*limit)[c] = std::max((*limit)[c], rest.share_of_first * left[c]);
        }
        return left[0] <= (*limit)[0] && left[1] <= (*limit)[1] && left[2] <= (*limit)[2];
    };
    system.solve(right, y, stop, max_inner_iterations);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c) light[i].v[c] += system.scale()[i].v[c] * y[i].v[c];
    return light;
}

}  // namespace luxel
