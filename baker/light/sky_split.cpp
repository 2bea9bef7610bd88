#include "baker/light/sky_split.h"

#include <algorithm>

#include "baker/formfactors/sky_bins.h"
#include "baker/light/sky_cells.h"

namespace luxel {
namespace {

/// Cells along the horizon: four across a bin.
constexpr std::uint32_t cell_columns = 4 * sky_parts;
/// Each round finds what was hidden behind something brighter.
constexpr int most_rounds = 4;

struct BinMean {
    std::array<double, 3> light{};
    double solid_angle = 0;
    [[nodiscard]] Rgb nits() const {
        if (!(solid_angle > 0)) return {0, 0, 0};
        return {static_cast<float>(light[0] / solid_angle), static_cast<float>(light[1] / solid_angle),
                static_cast<float>(light[2] / solid_angle)};
    }
};

/// Means of the bins over pixels less `excess`; with `skip`, over those alone that are not skipped.
std::vector<Rgb> bin_means(const SkyMap& map, const std::vector<Rgb>* excess, const std::vector<bool>* skip) {
    std::vector<BinMean> bins(sky_bin_count);
    for_each_sky_cell(map, cell_columns, [&](const Vec3d& direction, double solid_angle, std::size_t pixel) {
        if (skip && (*skip)[pixel]) return;
        BinMean& bin = bins[sky_bin(to_float(direction))];
        bin.solid_angle += solid_angle;
        for (int c = 0; c < 3; ++c)
            bin.light[static_cast<std::size_t>(c)] +=
                solid_angle * (static_cast<double>(map.nits[pixel][c]) - (excess ? static_cast<double>((*excess)[pixel][c]) : 0.0));
    });
    std::vector<Rgb> means;
    for (const BinMean& bin : bins) means.push_back(bin.nits());
    return means;
}

/// Per pixel the bin of its middle.
std::vector<SkyBin> bins_of_pixels(const SkyMap& map) {
    std::vector<SkyBin> bins(map.nits.size());
    for_each_sky_cell(map, 1, [&](const Vec3d& direction, double, std::size_t pixel) { bins[pixel] = sky_bin(to_float(direction)); });
    return bins;
}

}  // namespace

SkySplit split_sky(const SkyMap& map) {
    const std::vector<SkyBin> bin_of = bins_of_pixels(map);
    std::vector<bool> is_bright(map.nits.size(), false);
    std::vector<Rgb> rest;
    bool found = false, more = true;
    for (int round = 0; round < most_rounds && more; ++round) {
        rest = bin_means(map, nullptr, &is_bright);
        more = false;
        for (std::size_t k = 0; k < map.nits.size(); ++k)
            if (!is_bright[k] && static_cast<double>(luminance(map.nits[k])) > bright_ratio * static_cast<double>(luminance(rest[bin_of[k]])))
                is_bright[k] = more = found = true;
    }
    if (!found) return {bin_means(map, nullptr, nullptr), {}};
    if (more) rest = bin_means(map, nullptr, &is_bright);
    std::vector<Rgb> excess(map.nits.size(), Rgb(0, 0, 0));
    for (std::size_t k = 0; k < excess.size(); ++k)
        if (is_bright[k])
            for (int c = 0; c < 3; ++c) excess[k][c] = std::max(0.0f, map.nits[k][c] - rest[bin_of[k]][c]);
    SkySplit split{bin_means(map, &excess, nullptr), {map.width, map.height, {}, map.turn}};
    split.bright.nits = std::move(excess);
    return split;
}

}  // namespace luxel
