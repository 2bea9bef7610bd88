#include "baker/output/dilate.h"

#include <algorithm>
#include <vector>

#include "formats/base/error.h"

namespace luxel {
namespace {

/// Calls visit(index) for the up to eight neighbours of a texel, in raster order.
template <class Visit>
void for_neighbours(std::uint64_t texel, std::uint32_t width, std::uint32_t height, const Visit& visit) {
    const auto x = static_cast<std::int64_t>(texel % width), y = static_cast<std::int64_t>(texel / width);
    for (std::int64_t ny = std::max<std::int64_t>(y - 1, 0); ny <= std::min<std::int64_t>(y + 1, height - 1); ++ny)
        for (std::int64_t nx = std::max<std::int64_t>(x - 1, 0); nx <= std::min<std::int64_t>(x + 1, width - 1); ++nx)
            if (nx != x || ny != y) visit(static_cast<std::uint64_t>(ny) * width + static_cast<std::uint64_t>(nx));
}

bool has_value(std::uint8_t state) { return state != texel_empty && state != texel_hidden; }

/// Texels in the state `wanted` beside one of `sources`, ascending, each once.
std::vector<std::uint64_t> wanted_beside(const std::vector<std::uint64_t>& sources, std::span<const std::uint8_t> mask,
                                         std::uint8_t wanted, std::uint32_t width, std::uint32_t height) {
    std::vector<std::uint64_t> found;
    for (const std::uint64_t source : sources)
        for_neighbours(source, width, height, [&](std::uint64_t near) {
            if (mask[near] == wanted) found.push_back(near);
        });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

/// The first front: wanted texels of the page beside one with a value.
std::vector<std::uint64_t> first_front(std::span<const std::uint8_t> mask, std::uint8_t wanted, std::uint32_t width,
                                       std::uint32_t height) {
    std::vector<std::uint64_t> front;
    for (std::uint64_t texel = 0; texel < mask.size(); ++texel) {
        if (mask[texel] != wanted) continue;
        bool beside = false;
        for_neighbours(texel, width, height, [&](std::uint64_t near) { beside = beside || has_value(mask[near]); });
        if (beside) front.push_back(texel);
    }
    return front;
}

/// Grows what has a value into texels in the state `wanted`.
void grow(std::span<Rgb> values, std::span<std::uint8_t> mask, std::uint8_t wanted, std::uint32_t width,
          std::uint32_t height, std::uint64_t steps) {
    if (values.size() != std::uint64_t{width} * height || mask.size() != values.size())
        throw Error(ErrorCode::internal, "dilate", "the number of values is not width * height");
    if (steps == 0 || values.empty()) return;
    std::vector<std::uint64_t> front = first_front(mask, wanted, width, height);
    for (std::uint64_t step = 0; step < steps && !front.empty(); ++step) {
        // Filled texels count as sources only after the step, so the mask is marked afterwards.
        for (const std::uint64_t texel : front) {
            Vec3d sum(0, 0, 0);
            double count = 0;
            for_neighbours(texel, width, height, [&](std::uint64_t near) {
                if (!has_value(mask[near])) return;
                sum += to_double(values[near]);
                ++count;
            });
            values[texel] = to_float(sum / count);
        }
        for (const std::uint64_t texel : front) mask[texel] = texel_filled;
        front = wanted_beside(front, mask, wanted, width, height);
    }
}

}  // namespace

void dilate(std::span<Rgb> values, std::span<std::uint8_t> mask, std::uint32_t width, std::uint32_t height,
            std::uint32_t steps) {
    grow(values, mask, texel_empty, width, height, steps);
}

void fill_hidden(std::span<Rgb> values, std::span<std::uint8_t> mask, std::uint32_t width, std::uint32_t height) {
    grow(values, mask, texel_hidden, width, height, mask.size());
    std::replace(mask.begin(), mask.end(), texel_hidden, texel_empty);
}

}  // namespace luxel
