#include "baker/patches/parted_texels.h"

#include <algorithm>
#include <array>
#include <optional>

#include "baker/patches/fragment_polygon.h"

namespace luxel {
namespace {

/// Steps to the texels beside one.
struct Step {
    int dx, dy;
};
constexpr std::array<Step, 4> steps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

/// Cell of a texel's square at (u, v), 0..1.
std::uint32_t cell_at(float u, float v) {
    const auto step = [](float at) {
        return static_cast<std::uint32_t>(std::clamp(at * static_cast<float>(cells_across), 0.0f, static_cast<float>(cells_across) - 0.5f));
    };
    return cells_across * step(v) + step(u);
}

/// Which step leads over the wall: where a texel is parted from this one, towards the cells that lie beyond.
std::optional<std::uint8_t> step_across(const PageTexels& page, const Texel& texel) {
    float beyond_x = 0, beyond_y = 0;
    for (std::uint32_t cell = 0; cell < cells_across * cells_across; ++cell)
        if (!(texel.own_side >> cell & 1)) {
            const Vec2f middle = cell_middle(cell);
            beyond_x += middle.x - 0.5f, beyond_y += middle.y - 0.5f;
        }
    std::optional<std::uint8_t> best;
    float most = 0;
    for (std::uint8_t k = 0; k < steps.size(); ++k) {
        const std::int64_t x = std::int64_t{texel.x} + steps[k].dx, y = std::int64_t{texel.y} + steps[k].dy;
        if (x < 0 || y < 0) continue;
        const std::uint32_t other = page.find(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), texel.chart);
        if (other == none || !page.can_send(page.texels[other])) continue;
        const Texel& first = k == 0 || k == 2 ? texel : page.texels[other];
        const bool joined = steps[k].dx != 0 ? first.joined_right : first.joined_down;
        const float along = beyond_x * static_cast<float>(steps[k].dx) + beyond_y * static_cast<float>(steps[k].dy);
        if (!joined && (!best || along > most)) best = k, most = along;
    }
    return best;
}

}  // namespace

PartedTexels::PartedTexels(const TexelSet& texels) : page_size_(texels.page_size) {
    const std::size_t page_texels = std::size_t{page_size_} * page_size_;
    for (std::size_t number = 0; number < texels.pages.size(); ++number) {
        const PageTexels& page = texels.pages[number];
        for (const Texel& texel : page.texels) {
            if (texel.own_side == all_visible) continue;
            const auto step = step_across(page, texel);
            if (!step) continue;
            if (pages_.empty()) pages_.resize(texels.pages.size());
            const std::size_t place = std::size_t{texel.y} * page_size_ + texel.x;
            pages_[number].texels.push_back({static_cast<std::uint32_t>(place), texel.own_side, *step});
        }
    }
    for (Page& page : pages_) {
        page.bits.assign((page_texels + 63) / 64, 0);
        for (const Parted& parted : page.texels) page.bits[parted.place / 64] |= std::uint64_t{1} << (parted.place % 64);
    }
}

std::size_t PartedTexels::owner(std::uint32_t page, std::size_t place, float u, float v) const {
    const auto& all = pages_[page].texels;
    const auto parted = std::lower_bound(all.begin(), all.end(), place, [](const Parted& p, std::size_t at) { return p.place < at; });
    if (parted->own_side >> cell_at(u, v) & 1) return place;
    const Step& step = steps[parted->step];
    return place + static_cast<std::size_t>(step.dx) + static_cast<std::size_t>(step.dy) * page_size_;  // back by wrapping around
}

VisibleCells cells_on_own_side(const Scene& scene, const Atlas& atlas, const Texel& texel, const Fragment& fragment) {
    if (texel.own_side == all_visible) return fragment.visible;
    const FragmentPolygon polygon = fragment_polygon(scene, atlas, fragment);
    const Chart& chart = atlas.charts[texel.chart];
    const Vec2f* uv = &atlas.corner_uv[std::size_t{3} * fragment.triangle];
    VisibleCells own = fragment.visible;
    for (std::uint32_t cell = 0; cell < cells_across * cells_across; ++cell) {
        const Vec2f middle = cell_middle(cell), b = polygon.point(middle.x, middle.y);
        const Vec2f place = uv[0] + (uv[1] - uv[0]) * b.x + (uv[2] - uv[0]) * b.y;
        const std::uint32_t there = cell_at(place.x - static_cast<float>(texel.x - chart.x), place.y - static_cast<float>(texel.y - chart.y));
        if (!(texel.own_side >> there & 1)) own = static_cast<VisibleCells>(own & ~(1u << cell));
    }
    return own;
}

std::uint64_t PartedTexels::resident_bytes() const {
    std::uint64_t bytes = 0;
    for (const Page& page : pages_) bytes += page.bits.capacity() * sizeof(std::uint64_t) + page.texels.capacity() * sizeof(Parted);
    return bytes;
}

}  // namespace luxel
