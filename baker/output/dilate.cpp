#include "baker/output/dilate.h"

#include <algorithm>
#include <vector>

#include "baker/output/page_neighbours.h"
#include "formats/base/error.h"

namespace luxel {
namespace {

/// Empty texels beside one of `sources`, ascending, each once.
std::vector<std::uint64_t> empty_beside(const std::vector<std::uint64_t>& sources, std::span<const std::uint8_t> mask,
                                        std::uint32_t width, std::uint32_t height) {
    std::vector<std::uint64_t> found;
    for (const std::uint64_t source : sources)
        for_neighbours(source, width, height, [&](std::uint64_t near) {
            if (mask[near] == texel_empty) found.push_back(near);
        });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

/// The first front: empty texels of the page beside one with a value.
std::vector<std::uint64_t> first_front(std::span<const std::uint8_t> mask, std::uint32_t width, std::uint32_t height) {
    std::vector<std::uint64_t> front;
    for (std::uint64_t texel = 0; texel < mask.size(); ++texel) {
        if (mask[texel] != texel_empty) continue;
        bool beside = false;
        for_neighbours(texel, width, height, [&](std::uint64_t near) { beside = beside || mask[near] != texel_empty; });
        if (beside) front.push_back(texel);
    }
    return front;
}

}  // namespace

void dilate(std::span<Rgb> values, std::span<std::uint8_t> mask, std::uint32_t width, std::uint32_t height,
            std::uint32_t steps) {
    if (values.size() != std::uint64_t{width} * height || mask.size() != values.size())
        throw Error(ErrorCode::internal, "dilate", "the number of values is not width * height");
    if (steps == 0 || values.empty()) return;
    std::vector<std::uint64_t> front = first_front(mask, width, height);
    for (std::uint32_t step = 0; step < steps && !front.empty(); ++step) {
        // Filled texels count as sources only after the step, so the mask is marked afterwards.
        for (const std::uint64_t texel : front) {
            Vec3d sum(0, 0, 0);
            double count = 0;
            for_neighbours(texel, width, height, [&](std::uint64_t near) {
                if (mask[near] == texel_empty) return;
                sum += to_double(values[near]);
                ++count;
            });
            values[texel] = to_float(sum / count);
        }
        for (const std::uint64_t texel : front) mask[texel] = texel_filled;
        front = empty_beside(front, mask, width, height);
    }
}

}  // namespace luxel
