#include "baker/trace/coincident.h"

#include <algorithm>
#include <array>

namespace luxel {
namespace {

using Corners = std::array<std::array<float, 3>, 3>;

Corners sorted_corners(const Scene& scene, std::uint32_t triangle) {
    Corners corners;
    for (int k = 0; k < 3; ++k) {
        const Vec3f& p = scene.corner(triangle, k);
        // Adding zero turns -0 into +0, so that equal positions are equal keys.
        corners[static_cast<std::size_t>(k)] = {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
    }
    std::sort(corners.begin(), corners.end());
    return corners;
}

}  // namespace

CoincidentTriangles::CoincidentTriangles(const Scene& scene) {
    struct Entry {
        std::uint64_t hash;
        std::uint32_t triangle;
        bool operator<(const Entry& o) const { return hash != o.hash ? hash < o.hash : triangle < o.triangle; }
    };
    std::vector<Entry> entries;
    entries.reserve(scene.triangle_count());
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        if (!scene.object_of(t).casts) continue;
        const Corners corners = sorted_corners(scene, t);
        entries.push_back({hash64({reinterpret_cast<const std::uint8_t*>(corners.data()), sizeof corners}), t});
    }
    std::sort(entries.begin(), entries.end());
    group_begin_.push_back(0);
    for (std::size_t begin = 0; begin < entries.size();) {
        std::size_t end = begin + 1;
        while (end < entries.size() && entries[end].hash == entries[begin].hash) ++end;
        if (end - begin > 1) {
            if (group_of_.empty()) group_of_.assign(scene.triangle_count(), none);
            const auto group = static_cast<std::uint32_t>(group_begin_.size() - 1);
            const Corners corners = sorted_corners(scene, entries[begin].triangle);
            for (std::size_t i = begin; i < end; ++i)
                if (sorted_corners(scene, entries[i].triangle) == corners) {
                    group_of_[entries[i].triangle] = group;
                    members_.push_back(entries[i].triangle);
                }
            group_begin_.push_back(static_cast<std::uint32_t>(members_.size()));
        }
        begin = end;
    }
}

std::span<const std::uint32_t> CoincidentTriangles::group(std::uint32_t triangle) const {
    if (group_of_.empty() || group_of_[triangle] == none) return {};
    const std::uint32_t group = group_of_[triangle];
    return {members_.data() + group_begin_[group], members_.data() + group_begin_[group + 1]};
}

Vec2f transfer_barycentrics(const Scene& scene, std::uint32_t from, std::uint32_t to, Vec2f b) {
    const std::array<float, 3> weight{1 - b.x - b.y, b.x, b.y};
    std::array<float, 3> result{};
    std::array<bool, 3> used{};
    for (int k = 0; k < 3; ++k)
        for (int m = 0; m < 3; ++m)
            if (!used[static_cast<std::size_t>(m)] && scene.corner(to, k) == scene.corner(from, m)) {
                result[static_cast<std::size_t>(k)] = weight[static_cast<std::size_t>(m)];
                used[static_cast<std::size_t>(m)] = true;
                break;
            }
    return {result[1], result[2]};
}

}  // namespace luxel
