#include "baker/light/sky.h"

#include <algorithm>
#include <cmath>

#include "baker/core/units.h"
#include "baker/light/sky_cells.h"

namespace luxel {
namespace {

/// Relative variance of the luminance over the sphere from which on it pays to aim.
constexpr double much_variance = 0.5;

/// The interval of `random` in a cumulative table, and where in it `random` is.
std::pair<std::size_t, double> choose(const float* up_to, std::size_t count, float random) {
    const auto at = static_cast<std::size_t>(std::upper_bound(up_to, up_to + count - 1, random) - up_to);
    const float before = at ? up_to[at - 1] : 0.0f;
    const double rest = static_cast<double>(random - before) / static_cast<double>(std::max(up_to[at] - before, 1e-30f));
    return {at, std::clamp(rest, 0.0, 1.0)};
}

}  // namespace

Sky::Sky(const SkyMap& map) : map_(map), column_up_to_(map.nits.size(), 1.0f) {
    std::vector<double> rows(map.height);
    double square = 0;
    for (std::uint32_t y = 0; y <= map.height; ++y) row_edge_.push_back(std::cos(pi * y / map.height));
    for (std::uint32_t y = 0; y < map.height; ++y) {
        const double solid_angle = (row_edge_[y] - row_edge_[y + 1]) * 2 * pi / map.width;
        const Rgb* nits = map.nits.data() + std::size_t{y} * map.width;
        float* up_to = column_up_to_.data() + std::size_t{y} * map.width;
        double row = 0;
        for (std::uint32_t x = 0; x < map.width; ++x) row += static_cast<double>(luminance(nits[x]));
        rows[y] = row * solid_angle;
        total_ += rows[y];
        double sum = 0;
        for (std::uint32_t x = 0; x < map.width; ++x) {
            const double light = static_cast<double>(luminance(nits[x]));
            square += light * light * solid_angle;
            sum += light;
            if (row > 0) up_to[x] = static_cast<float>(sum / row);
        }
        up_to[map.width - 1] = 1;
    }
    double sum = 0;
    for (const double row : rows) row_up_to_.push_back(static_cast<float>(total_ > 0 ? (sum += row) / total_ : 1.0));
    row_up_to_.back() = 1;
    is_uneven_ = square * 4 * pi > (1 + much_variance) * total_ * total_;
}

std::size_t Sky::pixel(const Vec3f& direction) const {
    if (map_.nits.size() == 1) return 0;
    const double down = std::acos(std::clamp(static_cast<double>(direction.y), -1.0, 1.0)) / pi;
    double along = (std::atan2(static_cast<double>(direction.z), static_cast<double>(direction.x)) + map_.turn) / (2 * pi) + 0.5;
    along -= std::floor(along);
    const auto row = std::min(static_cast<std::uint32_t>(down * map_.height), map_.height - 1);
    const auto column = std::min(static_cast<std::uint32_t>(along * map_.width), map_.width - 1);
    return std::size_t{row} * map_.width + column;
}

Sky::Sample Sky::sample(float u, float v) const {
    const auto [row, down] = choose(row_up_to_.data(), map_.height, v);
    const auto [column, right] = choose(column_up_to_.data() + row * map_.width, map_.width, u);
    const double height = row_edge_[row] + (row_edge_[row + 1] - row_edge_[row]) * down;
    const double along = 2 * pi * ((static_cast<double>(column) + right) / map_.width - 0.5) - map_.turn;
    const double ring = std::sqrt(std::max(0.0, 1 - height * height));
    const Vec3f direction(static_cast<float>(ring * std::cos(along)), static_cast<float>(height),
                          static_cast<float>(ring * std::sin(along)));
    return {direction, density(direction)};
}

float Sky::density(const Vec3f& direction) const {
    const std::size_t at = pixel(direction);
    const std::size_t row = at / map_.width, column = at % map_.width;
    // From the tables themselves, so that it is the density of sample() whatever their rounding.
    const float of_row = row_up_to_[row] - (row ? row_up_to_[row - 1] : 0.0f);
    const float of_column = column_up_to_[at] - (column ? column_up_to_[at - 1] : 0.0f);
    const double solid_angle = (row_edge_[row] - row_edge_[row + 1]) * 2 * pi / map_.width;
    return static_cast<float>(static_cast<double>(of_row) * static_cast<double>(of_column) / solid_angle);
}

Rgb Sky::irradiance(const Vec3f& normal) const {
    std::array<double, 3> sum{};
    const Vec3d n = to_double(normal);
    for_each_sky_cell(map_, 512, [&](const Vec3d& direction, double solid_angle, std::size_t at) {
        const double cosine = direction.dot(n);
        if (cosine <= 0) return;
        for (int c = 0; c < 3; ++c)
            sum[static_cast<std::size_t>(c)] += static_cast<double>(map_.nits[at][c]) * cosine * solid_angle;
    });
    return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

}  // namespace luxel
