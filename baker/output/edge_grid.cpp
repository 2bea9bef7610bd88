#include "baker/output/edge_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "baker/core/parallel.h"
#include "baker/core/sobol.h"

namespace luxel {
namespace {

/// Cells begin here, in sides of a cell, so that the planes between them miss the round coordinates that edges like.
constexpr double shift = 0.381966;

}  // namespace

EdgeGrid::EdgeGrid(std::vector<GridSegment> segments, double near_m) : segments_(std::move(segments)), near_m_(near_m) {
    const auto count = static_cast<std::uint32_t>(segments_.size());
    levels_.resize(count);
    parallel_for(count, 4096, [&](std::size_t s) {
        int exponent = 0;
        std::frexp((segments_[s].to - segments_[s].from).length(), &exponent);
        levels_[s] = static_cast<std::int16_t>(exponent);
    });
    for (const std::int16_t level : levels_)
        if (std::find(used_levels_.begin(), used_levels_.end(), level) == used_levels_.end())
            used_levels_.push_back(level);
    std::sort(used_levels_.begin(), used_levels_.end());
    const std::uint64_t buckets = std::bit_ceil(std::uint64_t{4} * count + 1);
    bucket_mask_ = buckets - 1;
    first_.assign(buckets + 1, 0);
    for (std::uint32_t s = 0; s < count; ++s)
        for_cells(box(s), levels_[s], [&](std::uint64_t bucket) { ++first_[bucket + 1]; });
    for (std::uint64_t b = 0; b < buckets; ++b) first_[b + 1] += first_[b];
    members_.resize(first_[buckets]);
    std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t s = 0; s < count; ++s)
        for_cells(box(s), levels_[s], [&](std::uint64_t bucket) { members_[next[bucket]++] = s; });
}

EdgeGrid::Box EdgeGrid::box(std::uint32_t segment) const {
    const GridSegment& s = segments_[segment];
    const Vec3d reach(near_m_, near_m_, near_m_);
    Box box;
    for (int k = 0; k < 3; ++k) {
        box.low[k] = std::min(s.from[k], s.to[k]) - reach[k];
        box.high[k] = std::max(s.from[k], s.to[k]) + reach[k];
    }
    return box;
}

int EdgeGrid::level(std::uint32_t segment) const { return levels_[segment]; }

template <class Visit>
void EdgeGrid::for_cells(const Box& box, int level, const Visit& visit) const {
    std::array<std::int64_t, 3> low, high;
    for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        low[axis] = static_cast<std::int64_t>(std::floor(std::ldexp(box.low[k], -level) + shift));
        high[axis] = static_cast<std::int64_t>(std::floor(std::ldexp(box.high[k], -level) + shift));
    }
    for (std::int64_t z = low[2]; z <= high[2]; ++z)
        for (std::int64_t y = low[1]; y <= high[1]; ++y)
            for (std::int64_t x = low[0]; x <= high[0]; ++x) {
                std::uint64_t hash = static_cast<std::uint64_t>(level + (1 << 14));
                for (const std::int64_t index : {x, y, z}) hash = mix(hash, static_cast<std::uint64_t>(index));
                visit(hash & bucket_mask_);
            }
}

bool EdgeGrid::meet(std::uint32_t a, std::uint32_t b) const {
    const Box one = box(a), other = box(b);
    for (int k = 0; k < 3; ++k)
        if (one.low[k] > other.high[k] || other.low[k] > one.high[k]) return false;
    return true;
}

std::vector<std::uint32_t> EdgeGrid::longer_near(std::uint32_t segment, std::size_t most) const {
    std::vector<std::uint32_t> found;
    const int own = level(segment);
    for (const int here : used_levels_) {
        if (here < own) continue;
        std::size_t looked_at = 0;
        for_cells(box(segment), here, [&](std::uint64_t bucket) {
            const auto begin = members_.begin() + static_cast<std::ptrdiff_t>(first_[bucket]);
            const auto end = members_.begin() + static_cast<std::ptrdiff_t>(first_[bucket + 1]);
            for (auto m = here == own ? std::upper_bound(begin, end, segment) : begin; m != end && looked_at < most;
                 ++m) {
                ++looked_at;
                if (level(*m) == here && meet(segment, *m)) found.push_back(*m);
            }
        });
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

}  // namespace luxel
