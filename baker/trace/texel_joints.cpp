#include "baker/trace/texel_joints.h"

#include <algorithm>
#include <bit>

#include "baker/core/parallel.h"
#include "baker/patches/fragment_polygon.h"
#include "baker/trace/surface_start.h"

namespace luxel {
namespace {

/// Height of the way between two texels, in texels.
constexpr float lift = 1.0f / 64;
/// Where normals differ by more than this cosine, a straight way might meet the surface itself: over a texel of a
/// surface bent by an angle t it dips by t / 8, and the arc cosine of this is less than 8 / 64.
constexpr float flat_cosine = 0.9975f;

}  // namespace

std::optional<JointProbe::Post> JointProbe::post(const PageTexels& page, const Texel& texel) const {
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
    const Vec3f origin = surface_start(scene_, largest->triangle, at, normal);
    return Post{origin + normal * (lift / atlas_.texels_per_metre), normal, largest->triangle};
}

bool JointProbe::joined(const std::optional<Post>& a, const std::optional<Post>& b) const {
    if (!a || !b) return !a && !b;
    if (a->normal.dot(b->normal) < flat_cosine) return true;
    const Vec3f way = b->above - a->above;
    const float length = way.length();
    return !(length > 0) || !tracer_.occluded({a->above, way / length, a->triangle}, length);
}

void find_texel_joints(const Scene& scene, const Atlas& atlas, const Tracer& tracer, TexelSet& texels) {
    const JointProbe probe(scene, atlas, tracer);
    for (PageTexels& page : texels.pages) {
        std::vector<std::optional<JointProbe::Post>> posts(page.texels.size());
        parallel_for(posts.size(), 256, [&](std::size_t t) { posts[t] = probe.post(page, page.texels[t]); });
        parallel_for(posts.size(), 256, [&](std::size_t t) {
            Texel& texel = page.texels[t];
            const auto joined = [&](std::uint32_t next) { return next == none || probe.joined(posts[t], posts[next]); };
            texel.joined_right = joined(page.find(texel.x + 1u, texel.y, texel.chart));
            texel.joined_down = joined(page.find(texel.x, texel.y + 1u, texel.chart));
        });
    }
}

}  // namespace luxel
