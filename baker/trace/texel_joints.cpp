#include "baker/trace/texel_joints.h"

#include <algorithm>
#include <bit>
#include <cmath>

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

/// Weights of corners 1 and 2 at a place on the chart's grid, if the triangle covers it.
std::optional<Vec2f> barycentrics_at(const Atlas& atlas, std::uint32_t triangle, const Vec2f& place) {
    const Vec2f* uv = &atlas.corner_uv[std::size_t{3} * triangle];
    const Vec2f a = uv[1] - uv[0], b = uv[2] - uv[0], p = place - uv[0];
    const float determinant = a.x * b.y - a.y * b.x;
    if (!(std::fabs(determinant) > 1e-12f)) return {};
    const Vec2f at((p.x * b.y - p.y * b.x) / determinant, (a.x * p.y - a.y * p.x) / determinant);
    if (at.x < 0 || at.y < 0 || at.x + at.y > 1) return {};
    return at;
}

}  // namespace

std::optional<JointProbe::Post> JointProbe::post(const PageTexels& page, const Texel& texel) const {
    const Fragment* largest = nullptr;
    for (std::uint32_t f = texel.first_fragment; f < texel.first_fragment + texel.fragment_count; ++f) {
        const Fragment& fragment = page.fragments[f];
        if (fragment.visible && (!largest || fragment.visible_m2() > largest->visible_m2())) largest = &fragment;
    }
    if (!largest) return {};
    const FragmentPolygon polygon = fragment_polygon(scene_, atlas_, *largest);
    // Beside the middle: walls often stand where texels have theirs, and a point in a wall is on neither side of it.
    Vec2f at = polygon.centroid() + (polygon.corners()[0] - polygon.centroid()) * 0.07f;
    if (largest->visible != all_visible) {
        const Vec2f middle = cell_middle(static_cast<std::uint32_t>(std::countr_zero(largest->visible)));
        at = polygon.point(middle.x, middle.y);
    }
    return post_at(largest->triangle, at);
}

JointProbe::Post JointProbe::post_at(std::uint32_t triangle, const Vec2f& barycentric) const {
    const Vec3f normal = scene_.geometric_normal(triangle);
    return {surface_start(scene_, triangle, barycentric, normal) + normal * (lift / scene_.object_of(triangle).density(atlas_.texels_per_metre)), normal, triangle};
}

bool JointProbe::joined(const std::optional<Post>& a, const std::optional<Post>& b) const {
    if (!a || !b) return !a && !b;
    if (a->normal.dot(b->normal) < flat_cosine) return true;
    const Vec3f way = b->above - a->above;
    const float length = way.length();
    return !(length > 0) || !tracer_.occluded({a->above, way / length, a->triangle}, length);
}

VisibleCells JointProbe::own_side(const PageTexels& page, const Texel& texel, const Post& post) const {
    const Chart& chart = atlas_.charts[texel.chart];
    VisibleCells own = all_visible;
    for (std::uint32_t cell = 0; cell < cells_across * cells_across; ++cell) {
        const Vec2f middle = cell_middle(cell);
        const Vec2f place(static_cast<float>(texel.x - chart.x) + middle.x, static_cast<float>(texel.y - chart.y) + middle.y);
        for (std::uint32_t f = texel.first_fragment; f < texel.first_fragment + texel.fragment_count; ++f) {
            const std::uint32_t triangle = page.fragments[f].triangle;
            const auto at = barycentrics_at(atlas_, triangle, place);
            if (!at) continue;
            if (!joined(post, post_at(triangle, *at))) own = static_cast<VisibleCells>(own & ~(1u << cell));
            break;
        }
    }
    return own == none_visible ? all_visible : own;
}

namespace {

/// Has the texel one beside it that is visible too, and from which something parts it?
bool has_wall_beside(const PageTexels& page, const std::vector<std::optional<JointProbe::Post>>& posts, std::uint32_t number) {
    const Texel& texel = page.texels[number];
    const auto visible = [&](std::uint32_t x, std::uint32_t y) {
        const std::uint32_t other = page.find(x, y, texel.chart);
        return other != none && posts[other] ? &page.texels[other] : nullptr;
    };
    if (!texel.joined_right && visible(texel.x + 1u, texel.y)) return true;
    if (!texel.joined_down && visible(texel.x, texel.y + 1u)) return true;
    const Texel* left = texel.x > 0 ? visible(texel.x - 1u, texel.y) : nullptr;
    const Texel* above = texel.y > 0 ? visible(texel.x, texel.y - 1u) : nullptr;
    return (left && !left->joined_right) || (above && !above->joined_down);
}

}  // namespace

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
        parallel_for(posts.size(), 256, [&](std::size_t t) {
            if (posts[t] && has_wall_beside(page, posts, static_cast<std::uint32_t>(t)))
                page.texels[t].own_side = probe.own_side(page, page.texels[t], *posts[t]);
        });
    }
}

}  // namespace luxel
