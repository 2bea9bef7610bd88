#include "baker/trace/visible_area.h"

#include <algorithm>
#include <array>

#include "baker/core/parallel.h"
#include "baker/patches/fragment_polygon.h"
#include "baker/patches/texel_means.h"
#include "baker/trace/hidden_point.h"
#include "baker/trace/surface_start.h"

namespace luxel {
namespace {

/// How far from the border of a fragment it is looked at, as a share of its width. On the border its neighbours touch it.
constexpr float border = 1.0f / 256;
/// Area by the trapezoidal rule: points along the border of a cell count half, those of its corners a quarter.
constexpr std::uint16_t cell_parts = 36;
static_assert(fragment_parts == cell_parts * cells_across * cells_across);
/// Fragments below this share of a texel are not divided into cells: dense meshes have many in each.
constexpr float small_fragment = 1.0f / 16;

constexpr float inside_border(float place) { return std::clamp(place, border, 1 - border); }
/// Places of the 5 lines between and around cells, 0..1.
constexpr float line_place(std::uint32_t k) { return inside_border(static_cast<float>(k) / cells_across); }

class FragmentProbe {
  public:
    FragmentProbe(const Scene& scene, const Tracer& tracer, float near_m, float texels_per_metre)
        : scene_(scene), tracer_(tracer), texels_per_metre_(texels_per_metre), hidden_(scene, tracer, near_m) {}

    void probe(const FragmentPolygon& polygon, Fragment& fragment) const {
        const std::uint32_t triangle = fragment.triangle;
        const Vec3f normal = scene_.geometric_normal(triangle);
        if (!is_cut(polygon, triangle, normal)) {
            const bool hidden = hidden_.is_hidden(polygon.centroid(), triangle, normal);
            fragment.visible = hidden ? none_visible : all_visible;
            fragment.visible_parts = hidden ? 0 : fragment_parts;
            return;
        }
        const float texel_m = 1 / scene_.object_of(triangle).density(texels_per_metre_);
        if (fragment.area_m2 < small_fragment * texel_m * texel_m) probe_small(polygon, normal, fragment);
        else probe_cells(polygon, normal, fragment);
    }

  private:
    [[nodiscard]] bool is_visible(const FragmentPolygon& polygon, float s, float t, std::uint32_t triangle, const Vec3f& normal) const {
        return !hidden_.is_hidden(polygon.point(s, t), triangle, normal);
    }

    /// 3 x 3 points. Rays may start if all are visible.
    void probe_small(const FragmentPolygon& polygon, const Vec3f& normal, Fragment& fragment) const {
        constexpr std::uint32_t weights[] = {1, 2, 1};
        std::uint32_t sum = 0;
        for (std::uint32_t row = 0; row < 3; ++row)
            for (std::uint32_t column = 0; column < 3; ++column)
                if (is_visible(polygon, line_place(2 * column), line_place(2 * row), fragment.triangle, normal))
                    sum += weights[row] * weights[column];
        fragment.visible = sum == 16 ? all_visible : none_visible;
        fragment.visible_parts = static_cast<std::uint16_t>(sum * (fragment_parts / 16));
    }

    /// The 5 x 5 corners of the cells, and 4 x 4 points of those with a visible one.
    void probe_cells(const FragmentPolygon& polygon, const Vec3f& normal, Fragment& fragment) const {
        std::array<std::array<bool, cells_across + 1>, cells_across + 1> corner;
        for (std::uint32_t row = 0; row <= cells_across; ++row)
            for (std::uint32_t column = 0; column <= cells_across; ++column)
                corner[row][column] = is_visible(polygon, line_place(column), line_place(row), fragment.triangle, normal);
        std::uint32_t parts = 0;
        fragment.visible = none_visible;
        for (std::uint32_t cell = 0; cell < cells_across * cells_across; ++cell) {
            const std::uint32_t row = cell / cells_across, column = cell % cells_across;
            const std::array<bool, 4> corners{corner[row][column], corner[row][column + 1], corner[row + 1][column], corner[row + 1][column + 1]};
            const std::uint32_t of_cell = cell_parts_of(polygon, row, column, corners, fragment.triangle, normal);
            if (of_cell == cell_parts) fragment.visible = static_cast<VisibleCells>(fragment.visible | (1u << cell));
            parts += of_cell;
        }
        fragment.visible_parts = static_cast<std::uint16_t>(parts);
    }

    /// A point is as visible as the visible corner next to it if nothing stands between: one short ray instead of many. None
    /// of a cell without a visible corner is: hidden points are what takes time.
    [[nodiscard]] std::uint32_t cell_parts_of(const FragmentPolygon& polygon, std::uint32_t row, std::uint32_t column,
                                              const std::array<bool, 4>& corners, std::uint32_t triangle, const Vec3f& normal) const {
        constexpr std::uint32_t weights[] = {1, 2, 2, 1};
        if (!corners[0] && !corners[1] && !corners[2] && !corners[3]) return 0;
        const auto point = [&](std::uint32_t y, std::uint32_t x) {
            const auto place = [](std::uint32_t cell, std::uint32_t k) {
                return inside_border((static_cast<float>(cell) + static_cast<float>(k) / 3) / cells_across);
            };
            return polygon.point(place(column, x), place(row, y));
        };
        std::uint32_t parts = 0;
        for (std::uint32_t y = 0; y < 4; ++y)
            for (std::uint32_t x = 0; x < 4; ++x) {
                const std::uint32_t near_y = y / 2, near_x = x / 2;
                const bool corner = corners[2 * near_y + near_x], is_corner = y == 3 * near_y && x == 3 * near_x;
                const bool visible = is_corner ? corner
                                               : (corner && joined(point(y, x), point(3 * near_y, 3 * near_x), triangle, normal)) ||
                                                     !hidden_.is_hidden(point(y, x), triangle, normal);
                if (visible) parts += weights[y] * weights[x];
            }
        return parts;
    }

    /// Does anything cross the polygon? Chords along two directions, as far apart as cells and along the border, just above it.
    [[nodiscard]] bool is_cut(const FragmentPolygon& polygon, std::uint32_t triangle, const Vec3f& normal) const {
        for (const bool second : {false, true}) {
            const auto across = [&](const Vec2f& b) { return second ? b.y : b.x; };
            float low = across(polygon.centroid()), high = low;
            for (const Vec2f& corner : polygon.corners())
                low = std::min(low, across(corner)), high = std::max(high, across(corner));
            for (std::uint32_t k = 0; k <= cells_across; ++k) {
                const float at = low + (high - low) * line_place(k);
                if (chord_is_cut(polygon, at, across, triangle, normal)) return true;
            }
        }
        return false;
    }

    template <class Across>
    [[nodiscard]] bool chord_is_cut(const FragmentPolygon& polygon, float at, const Across& across, std::uint32_t triangle,
                                    const Vec3f& normal) const {
        std::array<Vec2f, 2> ends;
        std::size_t found = 0;
        const auto corners = polygon.corners();
        for (std::size_t k = 0; k < corners.size() && found < 2; ++k) {
            const Vec2f &p = corners[k], &q = corners[k + 1 < corners.size() ? k + 1 : 0];
            if ((across(p) < at) == (across(q) < at)) continue;
            ends[found++] = p + (q - p) * ((at - across(p)) / (across(q) - across(p)));
        }
        if (found < 2) return false;
        const Vec2f inset = (ends[1] - ends[0]) * border;
        return !joined(ends[0] + inset, ends[1] - inset, triangle, normal);
    }

    /// Is there nothing between two points, just above the surface?
    [[nodiscard]] bool joined(const Vec2f& a, const Vec2f& b, std::uint32_t triangle, const Vec3f& normal) const {
        const Vec3f from = surface_start(scene_, triangle, a, normal), to = surface_start(scene_, triangle, b, normal);
        const float length = (to - from).length();
        return !(length > 0 && tracer_.occluded({from, (to - from) / length, triangle}, length));
    }

    const Scene& scene_;
    const Tracer& tracer_;
    float texels_per_metre_;  ///< of the scene
    HiddenPoints hidden_;
};

}  // namespace

VisibleAreaTally find_visible_area(const Scene& scene, const Atlas& atlas, const Tracer& tracer, float near_m,
                                   TexelSet& texels) {
    const FragmentProbe probe(scene, tracer, near_m, atlas.texels_per_metre);
    VisibleAreaTally tally;
    for (PageTexels& page : texels.pages) {
        parallel_for(page.texels.size(), 256, [&](std::size_t t) {
            Texel& texel = page.texels[t];
            bool changed = false;
            for (std::uint32_t f = 0; f < texel.fragment_count; ++f) {
                Fragment& fragment = page.fragments[texel.first_fragment + f];
                probe.probe(fragment_polygon(scene, atlas, fragment), fragment);
                changed = changed || fragment.visible_parts != fragment_parts;
            }
            if (changed) average_texel(scene, atlas, page, texel);
        });
        for (const Texel& texel : page.texels) {
            tally.hidden_texels += texel.visible_m2 <= 0;
            tally.cut_texels += texel.visible_m2 > 0 && texel.visible_m2 < texel.area_m2;
            tally.hidden_m2 += static_cast<double>(texel.area_m2) - static_cast<double>(texel.visible_m2);
        }
    }
    return tally;
}

}  // namespace luxel
