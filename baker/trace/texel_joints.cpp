#include "baker/trace/texel_joints.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <tuple>

#include "baker/core/parallel.h"
#include "baker/patches/fragment_polygon.h"
#include "baker/trace/ray_offset.h"

namespace luxel {
namespace {

/// Height of the way between two texels, in texels.
constexpr float lift = 1.0f / 64;
/// Where normals differ by more than this cosine, a straight way might meet the surface itself: over a texel of a
/// surface bent by an angle t it dips by t / 8, and the arc cosine of this is less than 8 / 64.
constexpr float flat_cosine = 0.9975f;

/// A point above the visible part of a texel.
struct Post {
    Vec3f above, normal;
    std::uint32_t triangle;
};

class JointProbe {
  public:
    JointProbe(const Scene& scene, const Atlas& atlas, const Tracer& tracer)
        : scene_(scene), atlas_(atlas), tracer_(tracer) {}

    /// On the fragment with the largest visible part; none where no ray can start.
    [[nodiscard]] std::optional<Post> post(const PageTexels& page, const Texel& texel) const {
        const Fragment* largest = nullptr;
        for (std::uint32_t f = texel.first_fragment; f < texel.first_fragment + texel.fragment_count; ++f) {
            const Fragment& fragment = page.fragments[f];
            if (fragment.visible && (!largest || fragment.visible_m2() > largest->visible_m2())) largest = &fragment;
        }
        if (!largest) return {};
        const FragmentPolygon polygon = fragment_polygon(scene_, atlas_, *largest);
        Vec2f at = polygon.centroid();
        if (largest->visible != all_visible) {
            const Vec2f middle = cell_middle(static_cast<std::uint32_t>(std::countr_zero(largest->visible)));
            at = polygon.point(middle.x, middle.y);
        }
        const Vec3f normal = scene_.geometric_normal(largest->triangle);
        const Vec3f origin = offset_origin(surface_position(scene_, largest->triangle, at), normal,
                                           scene_.corner_extent(largest->triangle));
        return Post{origin + normal * (lift / atlas_.texels_per_metre), normal, largest->triangle};
    }

    [[nodiscard]] bool joined(const std::optional<Post>& a, const std::optional<Post>& b) const {
        if (!a || !b) return !a && !b;
        if (a->normal.dot(b->normal) < flat_cosine) return true;
        const Vec3f way = b->above - a->above;
        const float length = way.length();
        return !(length > 0) || !tracer_.occluded({a->above, way / length, a->triangle}, length);
    }

  private:
    const Scene& scene_;
    const Atlas& atlas_;
    const Tracer& tracer_;
};

/// Number of the texel at (x, y) if it is of `chart`, else none. Texels are in raster order.
std::uint32_t find_texel(const PageTexels& page, std::uint32_t x, std::uint32_t y, std::uint32_t chart) {
    const auto at = std::lower_bound(page.texels.begin(), page.texels.end(), std::tuple(y, x),
                                     [](const Texel& texel, const auto& place) {
                                         return std::tuple<std::uint32_t, std::uint32_t>(texel.y, texel.x) < place;
                                     });
    if (at == page.texels.end() || at->x != x || at->y != y || at->chart != chart) return none;
    return static_cast<std::uint32_t>(at - page.texels.begin());
}

}  // namespace

void find_texel_joints(const Scene& scene, const Atlas& atlas, const Tracer& tracer, TexelSet& texels) {
    const JointProbe probe(scene, atlas, tracer);
    for (PageTexels& page : texels.pages) {
        std::vector<std::optional<Post>> posts(page.texels.size());
        parallel_for(posts.size(), 256, [&](std::size_t t) { posts[t] = probe.post(page, page.texels[t]); });
        parallel_for(posts.size(), 256, [&](std::size_t t) {
            Texel& texel = page.texels[t];
            const auto joined = [&](std::uint32_t next) { return next == none || probe.joined(posts[t], posts[next]); };
            texel.joined_right = joined(find_texel(page, texel.x + 1u, texel.y, texel.chart));
            texel.joined_down = joined(find_texel(page, texel.x, texel.y + 1u, texel.chart));
        });
    }
}

}  // namespace luxel
