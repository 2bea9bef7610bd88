#include "baker/output/fill_hidden.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <vector>

#include "baker/output/page_neighbours.h"
#include "formats/base/error.h"

namespace luxel {
namespace {

constexpr std::uint32_t straight = 5, across = 7;
constexpr std::uint32_t unreached = std::numeric_limits<std::uint32_t>::max();

class Filler {
  public:
    Filler(std::span<Rgb> values, std::span<std::uint8_t> mask, std::span<const std::uint32_t> charts,
           std::uint32_t width, std::uint32_t height)
        : values_(values),
          mask_(mask),
          charts_(charts),
          width_(width),
          height_(height),
          distance_(values.size(), unreached) {}

    void fill() {
        for (std::uint64_t texel = 0; texel < mask_.size(); ++texel)
            if (mask_[texel] == texel_hidden) approach(texel);
        // Nearest first, so that what a texel is reached from has its value already.
        while (!front_.empty()) {
            const auto [distance, texel] = front_.top();
            front_.pop();
            if (distance != distance_[texel] || mask_[texel] == texel_filled) continue;
            settle(texel);
        }
        std::replace(mask_.begin(), mask_.end(), texel_hidden, texel_empty);
    }

  private:
    /// Calls visit(near, cost) for the neighbours of the same chart.
    template <class Visit>
    void for_near(std::uint64_t texel, const Visit& visit) const {
        for_neighbours(texel, width_, height_, [&](std::uint64_t near) {
            if (mask_[near] == texel_empty || charts_[near] != charts_[texel]) return;
            const bool is_straight = near / width_ == texel / width_ || near % width_ == texel % width_;
            visit(near, is_straight ? straight : across);
        });
    }
    /// 0 for what has light of its own; a filled texel keeps the one that it was reached at.
    [[nodiscard]] std::uint32_t distance(std::uint64_t texel) const {
        return mask_[texel] == texel_covered ? 0 : distance_[texel];
    }
    void offer(std::uint64_t texel, std::uint32_t distance) {
        if (distance >= distance_[texel]) return;
        distance_[texel] = distance;
        front_.push({distance, texel});
    }
    /// The first step from covered texels.
    void approach(std::uint64_t texel) {
        for_near(texel, [&](std::uint64_t near, std::uint32_t cost) {
            if (mask_[near] == texel_covered) offer(texel, cost);
        });
    }
    void settle(std::uint64_t texel) {
        Vec3d sum(0, 0, 0);
        double count = 0;
        for_near(texel, [&](std::uint64_t near, std::uint32_t cost) {
            const bool has_value = mask_[near] == texel_covered || mask_[near] == texel_filled;
            if (!has_value || distance(near) + cost != distance_[texel]) return;
            sum += to_double(values_[near]);
            ++count;
        });
        values_[texel] = to_float(sum / count);
        mask_[texel] = texel_filled;
        for_near(texel, [&](std::uint64_t near, std::uint32_t cost) {
            if (mask_[near] == texel_hidden) offer(near, distance_[texel] + cost);
        });
    }

    using Step = std::pair<std::uint32_t, std::uint64_t>;  // distance, texel

    const std::span<Rgb> values_;
    const std::span<std::uint8_t> mask_;
    const std::span<const std::uint32_t> charts_;
    const std::uint32_t width_, height_;
    std::vector<std::uint32_t> distance_;
    std::priority_queue<Step, std::vector<Step>, std::greater<>> front_;
};

}  // namespace

void fill_hidden(std::span<Rgb> values, std::span<std::uint8_t> mask, std::span<const std::uint32_t> charts,
                 std::uint32_t width, std::uint32_t height) {
    if (values.size() != std::uint64_t{width} * height || mask.size() != values.size() ||
        charts.size() != values.size())
        throw Error(ErrorCode::internal, "fill hidden texels", "the number of values is not width * height");
    Filler(values, mask, charts, width, height).fill();
}

}  // namespace luxel
