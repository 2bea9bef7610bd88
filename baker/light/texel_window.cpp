#include "baker/light/texel_window.h"

#include <algorithm>

namespace luxel {
namespace {

struct PlaceTable {
    std::vector<TexelWindow::Place> places;
    std::array<std::size_t, TexelWindow::disc_count> ends{};
};

const PlaceTable& table() {
    static const PlaceTable made = [] {
        PlaceTable all;
        const auto square = [](const TexelWindow::Place& p) { return p.dx * p.dx + p.dy * p.dy; };
        constexpr int radius = TexelWindow::most_radius;
        for (int dy = -radius; dy <= radius; ++dy)
            for (int dx = -radius; dx <= radius; ++dx)
                if (dx * dx + dy * dy <= TexelWindow::disc_squares.back()) all.places.push_back({dx, dy});
        std::stable_sort(all.places.begin(), all.places.end(),
                         [&](const TexelWindow::Place& a, const TexelWindow::Place& b) { return square(a) < square(b); });
        for (std::size_t disc = 0; disc < TexelWindow::disc_count; ++disc)
            all.ends[disc] = static_cast<std::size_t>(std::count_if(all.places.begin(), all.places.end(), [&](const TexelWindow::Place& p) {
                return square(p) <= TexelWindow::disc_squares[disc];
            }));
        return all;
    }();
    return made;
}

std::size_t slot(const TexelWindow::Place& p, int radius) {
    return static_cast<std::size_t>((p.dy + radius) * (2 * radius + 1) + p.dx + radius);
}

}  // namespace

TexelGrid::TexelGrid(const PageTexels& page, std::uint32_t page_size)
    : size_(page_size), index_(std::size_t{page_size} * page_size, none), flags_(index_.size(), 0), place_(page.texels.size()) {
    for (std::size_t k = 0; k < page.texels.size(); ++k) {
        index_[std::size_t{page.texels[k].y} * size_ + page.texels[k].x] = static_cast<std::uint32_t>(k);
        place_[k] = {page.texels[k].x, page.texels[k].y};
    }
    for (std::size_t k = 0; k < page.texels.size(); ++k) {
        const Texel& texel = page.texels[k];
        const std::size_t at = std::size_t{texel.y} * size_ + texel.x;
        const auto is_one_chart = [&](std::size_t other) { return index_[other] != none && page.texels[index_[other]].chart == texel.chart; };
        if (texel.joined_right && texel.x + 1u < size_ && is_one_chart(at + 1)) flags_[at] |= to_right;
        if (texel.joined_down && texel.y + 1u < size_ && is_one_chart(at + size_)) flags_[at] |= to_below;
        if (page.can_send(texel)) flags_[at] |= sends;
    }
}

std::span<const TexelWindow::Place> TexelWindow::places() { return table().places; }
const std::array<std::size_t, TexelWindow::disc_count>& TexelWindow::disc_ends() { return table().ends; }

TexelWindow::TexelWindow(const TexelGrid& grid, std::uint32_t centre)
    : grid_(grid), x_(grid.place_[centre][0]), y_(grid.place_[centre][1]) {}

/// From a neighbour one step nearer to the centre, along x or along y.
bool TexelWindow::is_reached(const Place& to, std::size_t there) const {
    if (to.dx != 0) {
        const bool right = to.dx > 0;
        if (reached_[slot({right ? to.dx - 1 : to.dx + 1, to.dy}, most_radius)] &&
            (grid_.flags_[right ? there - 1 : there] & TexelGrid::to_right))
            return true;
    }
    if (to.dy != 0) {
        const bool below = to.dy > 0;
        if (reached_[slot({to.dx, below ? to.dy - 1 : to.dy + 1}, most_radius)] &&
            (grid_.flags_[below ? there - grid_.size_ : there] & TexelGrid::to_below))
            return true;
    }
    return to.dx == 0 && to.dy == 0;
}

std::span<const TexelWindow::Member> TexelWindow::grow(std::size_t disc) {
    const std::size_t before = count_;
    const auto size = static_cast<int>(grid_.size_);
    const PlaceTable& all = table();
    for (std::size_t k = disc ? all.ends[disc - 1] : 0; k < all.ends[disc]; ++k) {
        const Place& place = all.places[k];
        const int x = x_ + place.dx, y = y_ + place.dy;
        if (x < 0 || y < 0 || x >= size || y >= size) continue;
        const std::size_t there = static_cast<std::size_t>(y) * grid_.size_ + static_cast<std::size_t>(x);
        if (!is_reached(place, there)) continue;
        reached_[slot(place, most_radius)] = true;
        if (!(grid_.flags_[there] & TexelGrid::sends)) continue;
        members_[count_++] = {place, grid_.index_[there]};
        shape_[k / 64] |= std::uint64_t{1} << (k % 64);
    }
    return {members_.data() + before, count_ - before};
}

}  // namespace luxel
