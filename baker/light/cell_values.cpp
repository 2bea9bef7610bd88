#include "baker/light/cell_values.h"

#include <algorithm>
#include <bitset>

namespace luxel {
namespace {

/// The cells next to (dx, dy) and beyond that, inwards along one axis.
struct Inwards {
    int next_x, next_y, beyond_x, beyond_y;
};

int sign(int d) { return d > 0 ? 1 : -1; }

Vec3d continued(const Vec3d& next, const Vec3d& beyond) {
    const Vec3d slope = next * 2.0 - beyond;
    return {std::max(slope.x, 0.0), std::max(slope.y, 0.0), std::max(slope.z, 0.0)};
}

}  // namespace

CellValues::CellValues(const CellWindow& window, std::span<const Rgb> values, int reach) {
    std::bitset<side * side> known;
    const auto bit = [](int dx, int dy) { return index(dy) * side + index(dx); };
    for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx)
            if (const PatchNumber patch = window.at(dx, dy); patch != no_patch) {
                value_[index(dy)][index(dx)] = to_double(values[patch]);
                known.set(bit(dx, dy));
            }

    // One sweep: every cell that is not known yet becomes the mean over the axes along which `value` finds one. What a
    // sweep finds counts from the next on, so the order of cells and axes does not matter.
    const auto sweep = [&](const auto& value) {
        const std::bitset<side* side> before = known;
        for (int dy = -reach; dy <= reach; ++dy)
            for (int dx = -reach; dx <= reach; ++dx) {
                if (before.test(bit(dx, dy))) continue;
                Vec3d sum(0, 0, 0);
                int axes = 0;
                if (dx != 0) axes += value(before, sum, Inwards{dx - sign(dx), dy, dx - 2 * sign(dx), dy});
                if (dy != 0) axes += value(before, sum, Inwards{dx, dy - sign(dy), dx, dy - 2 * sign(dy)});
                if (axes == 0) continue;
                value_[index(dy)][index(dx)] = sum / axes;
                known.set(bit(dx, dy));
            }
        return known != before;
    };
    const auto slope = [&](const auto& before, Vec3d& sum, const Inwards& in) {
        if (!before.test(bit(in.next_x, in.next_y)) || !before.test(bit(in.beyond_x, in.beyond_y))) return 0;
        sum += continued(at(in.next_x, in.next_y), at(in.beyond_x, in.beyond_y));
        return 1;
    };
    const auto flat = [&](const auto& before, Vec3d& sum, const Inwards& in) {
        if (!before.test(bit(in.next_x, in.next_y))) return 0;
        sum += at(in.next_x, in.next_y);
        return 1;
    };
    // The middle is known, so that a flat sweep always finds something.
    const std::size_t cells = static_cast<std::size_t>(2 * reach + 1) * static_cast<std::size_t>(2 * reach + 1);
    while (known.count() < cells)
        if (!sweep(slope)) sweep(flat);
}

}  // namespace luxel
