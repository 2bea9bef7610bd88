#include "baker/sweep/error_colour.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <fmt/format.h>

#include "formats/image/image_file.h"

namespace luxel {
namespace {

constexpr std::size_t most_maps = 4;
constexpr std::uint32_t gap = 4;  ///< pixels between maps

/// Knots at equal steps of the logarithm; relative luminance rises from each to the next.
constexpr std::array<Colour8, 7> knots{{{12, 18, 70}, {58, 28, 120}, {120, 38, 130}, {178, 52, 105}, {222, 92, 60}, {244, 160, 40}, {252, 238, 130}}};

/// Root of the mean square of a map's cells.
double size_of(const ErrorMap& map) {
    double sum = 0;
    std::size_t cells = 0;
    for (const float error : map.error)
        if (error >= 0) sum += static_cast<double>(error) * static_cast<double>(error), ++cells;
    return cells ? std::sqrt(sum / static_cast<double>(cells)) : -1;
}

/// The maps to show, in their order.
std::vector<std::size_t> shown(std::span<const ErrorMap> maps) {
    std::vector<std::size_t> chosen(maps.size());
    std::iota(chosen.begin(), chosen.end(), std::size_t{0});
    std::stable_sort(chosen.begin(), chosen.end(), [&](std::size_t a, std::size_t b) { return size_of(maps[a]) > size_of(maps[b]); });
    chosen.resize(std::min(chosen.size(), most_maps));
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

}  // namespace

Colour8 error_colour(double error) {
    const double range = std::log(most_shown_error / least_shown_error);
    const double at = std::clamp(std::log(std::max(error, least_shown_error) / least_shown_error) / range, 0.0, 1.0) * static_cast<double>(knots.size() - 1);
    const auto knot = std::min(static_cast<std::size_t>(at), knots.size() - 2);
    const double part = at - static_cast<double>(knot);
    Colour8 colour{};
    for (std::size_t c = 0; c < 3; ++c)
        colour[c] = static_cast<std::uint8_t>(std::lround((1 - part) * knots[knot][c] + part * knots[knot + 1][c]));
    return colour;
}

std::string colour_text(const Colour8& colour) { return fmt::format("#{:02x}{:02x}{:02x}", colour[0], colour[1], colour[2]); }

Bytes error_map_png(std::span<const ErrorMap> maps) {
    std::uint32_t width = 0, height = 1;
    const std::vector<std::size_t> chosen = shown(maps);
    for (const std::size_t k : chosen) {
        width += maps[k].width + (width ? gap : 0);
        height = std::max(height, maps[k].height);
    }
    width = std::max(width, 1u);
    std::vector<std::uint8_t> rgba(std::size_t{width} * height * 4, 0);
    std::uint32_t left = 0;
    for (const std::size_t k : chosen) {
        const ErrorMap& map = maps[k];
        for (std::uint32_t y = 0; y < map.height; ++y)
            for (std::uint32_t x = 0; x < map.width; ++x) {
                const float error = map.error[std::size_t{y} * map.width + x];
                if (error < 0) continue;
                const Colour8 colour = error_colour(static_cast<double>(error));
                std::uint8_t* to = &rgba[(std::size_t{y} * width + left + x) * 4];
                std::copy(colour.begin(), colour.end(), to);
                to[3] = 255;
            }
        left += map.width + gap;
    }
    ImageMetadata metadata;
    metadata.quantity = "relative error";
    metadata.encoding = "false colours";
    return encode_png_rgba(width, height, rgba, metadata);
}

}  // namespace luxel
