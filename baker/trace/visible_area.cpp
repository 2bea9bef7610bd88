#include "baker/trace/visible_area.h"

#include <algorithm>
#include <array>
#include <limits>

#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/patches/fragment_polygon.h"
#include "baker/patches/texel_means.h"
#include "baker/trace/ray_offset.h"

namespace luxel {
namespace {

/// A point that one tenth of its half space lights is missed by all of them with a chance of 3 %.
constexpr std::size_t enclosed_rays = 32;
/// Where some find the open, the point is not enclosed: only fronts with less than a hundredth of its light are missed.
constexpr std::size_t probe_rays = 256;

std::array<Vec3f, probe_rays> probe_directions() {
    const SobolSequence sequence(0x76697369626c65);  // any: one fixed set serves all points
    std::array<Vec3f, probe_rays> directions;
    for (std::size_t k = 0; k < probe_rays; ++k) {
        const auto u = sequence.point(static_cast<std::uint32_t>(k));
        directions[k] = cosine_direction(u[0], u[1]);
    }
    return directions;
}

class FragmentProbe {
  public:
    FragmentProbe(const Scene& scene, const Tracer& tracer, float near_m)
        : scene_(scene), tracer_(tracer), near_m_(near_m), directions_(probe_directions()) {}

    [[nodiscard]] VisibleCells visible_cells(const FragmentPolygon& polygon, std::uint32_t triangle) const {
        const Vec3f normal = scene_.geometric_normal(triangle);
        if (!is_cut(polygon, triangle, normal))
            return is_hidden(polygon.centroid(), triangle, normal) ? none_visible : all_visible;
        VisibleCells cells = none_visible;
        for (std::uint32_t cell = 0; cell < cells_across * cells_across; ++cell) {
            const Vec2f middle = cell_middle(cell);
            if (!is_hidden(polygon.point(middle.x, middle.y), triangle, normal))
                cells = static_cast<VisibleCells>(cells | (1u << cell));
        }
        return cells;
    }

  private:
    [[nodiscard]] Vec3f start(const Vec2f& at, std::uint32_t triangle, const Vec3f& normal) const {
        return offset_origin(surface_position(scene_, triangle, at), normal, scene_.corner_extent(triangle));
    }

    /// Does anything cross the polygon? Chords along two directions, as far apart as cells, just above it.
    [[nodiscard]] bool is_cut(const FragmentPolygon& polygon, std::uint32_t triangle, const Vec3f& normal) const {
        for (const bool second : {false, true}) {
            const auto across = [&](const Vec2f& b) { return second ? b.y : b.x; };
            float low = across(polygon.centroid()), high = low;
            for (const Vec2f& corner : polygon.corners())
                low = std::min(low, across(corner)), high = std::max(high, across(corner));
            for (std::uint32_t k = 0; k < cells_across; ++k) {
                const float at = low + (high - low) * (static_cast<float>(k) + 0.5f) / cells_across;
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
        // The ends touch the neighbours, which is no cut: a quarter of a cell is left out.
        const Vec2f inset = (ends[1] - ends[0]) / (4 * cells_across);
        const Vec3f from = start(ends[0] + inset, triangle, normal), to = start(ends[1] - inset, triangle, normal);
        const float length = (to - from).length();
        return length > 0 && tracer_.occluded({from, (to - from) / length, triangle}, length);
    }

    [[nodiscard]] bool is_hidden(const Vec2f& at, std::uint32_t triangle, const Vec3f& normal) const {
        return side_is_hidden(at, triangle, normal) &&
               (!scene_.material_of(triangle).double_sided || side_is_hidden(at, triangle, -normal));
    }

    [[nodiscard]] bool side_is_hidden(const Vec2f& at, std::uint32_t triangle, const Vec3f& normal) const {
        const Vec3f origin = start(at, triangle, normal);
        const Frame frame(normal);
        bool open = false;
        float nearest = std::numeric_limits<float>::infinity(), farthest = 0;
        for (std::size_t k = 0; k < (open ? probe_rays : enclosed_rays); ++k) {
            const TraceHit hit = tracer_.first_hit({origin, frame.to_world(directions_[k]), triangle});
            if (hit.triangle == none) {
                open = true;
                continue;
            }
            if (hit.front || scene_.material_of(hit.triangle).double_sided) return false;
            nearest = std::min(nearest, hit.distance_m), farthest = std::max(farthest, hit.distance_m);
        }
        if (open && !(nearest <= near_m_)) return false;
        return !sees_lamp(origin, triangle, normal, open ? std::numeric_limits<float>::infinity() : 2 * farthest);
    }

    /// `reach`: lamps farther away than this lie outside of what encloses the point, m.
    [[nodiscard]] bool sees_lamp(const Vec3f& origin, std::uint32_t triangle, const Vec3f& normal, float reach) const {
        for (const Lamp& lamp : scene_.lamps) {
            const bool far = lamp.kind == LampKind::directional;
            const Vec3f to = far ? -lamp.direction : lamp.position - origin;
            const float distance = far ? std::numeric_limits<float>::infinity() : to.length();
            if (to.dot(normal) <= 0 || distance > reach) continue;
            if (!tracer_.occluded({origin, to.normalized(), triangle}, distance)) return true;
        }
        return false;
    }

    const Scene& scene_;
    const Tracer& tracer_;
    float near_m_;
    std::array<Vec3f, probe_rays> directions_;
};

}  // namespace

VisibleAreaTally find_visible_area(const Scene& scene, const Atlas& atlas, const Tracer& tracer, float near_m,
                                   TexelSet& texels) {
    const FragmentProbe probe(scene, tracer, near_m);
    VisibleAreaTally tally;
    for (PageTexels& page : texels.pages) {
        parallel_for(page.texels.size(), 256, [&](std::size_t t) {
            Texel& texel = page.texels[t];
            bool changed = false;
            for (std::uint32_t f = 0; f < texel.fragment_count; ++f) {
                Fragment& fragment = page.fragments[texel.first_fragment + f];
                fragment.visible = probe.visible_cells(fragment_polygon(scene, atlas, fragment), fragment.triangle);
                changed = changed || fragment.visible != all_visible;
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
