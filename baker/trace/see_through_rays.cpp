#include "baker/trace/see_through_rays.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

#include "baker/core/sobol.h"

namespace luxel {
namespace {

std::uint64_t bits_of(float a, float b) {
    return (std::uint64_t{std::bit_cast<std::uint32_t>(a)} << 32) | std::bit_cast<std::uint32_t>(b);
}

/// A number in [0, 1) that looks random, of a ray and a name.
float chance(const Vec3f& origin, const Vec3f& direction, std::uint64_t name) {
    std::uint64_t hash = mix(name ^ bits_of(origin.x, origin.y), bits_of(origin.z, direction.x));
    hash = mix(hash ^ bits_of(direction.y, direction.z), 0x70616e65);
    return static_cast<float>(hash >> 40) * 0x1p-24f;
}

/// Hits on an edge that two triangles share have a weight of nothing but rounding, and differ in distance by as much.
constexpr float edge_weight = 1e-5f, edge_distance = 1e-5f;

bool is_on_edge(const Vec2f& b) { return std::min({b.x, b.y, 1 - b.x - b.y}) < edge_weight; }

}  // namespace

bool ray_meets(const Scene& scene, const Vec3f& origin, const Vec3f& direction, std::uint32_t triangle, float opacity) {
    if (opacity >= 1) return true;
    if (opacity <= 0) return false;
    const Object& object = scene.objects[scene.triangle_object[triangle]];
    return chance(origin, direction, mix(object.path_hash, triangle - object.first_triangle)) < opacity;
}

bool survives_tint(const TraceRay& ray, const Rgb& tint) {
    constexpr std::uint64_t purpose = 0x74696e74;
    return tint == Rgb(1, 1, 1) || chance(ray.origin, ray.direction, purpose) < (tint.x + tint.y + tint.z) / 3;
}

bool SeeThroughQuery::stops(std::size_t lane, const Vec3f& origin, const Vec3f& direction, std::uint32_t triangle,
                            const Vec2f& b, float distance) {
    if (triangle == from_[lane]) return false;
    const Passage at = surface_passage(scene_, triangle, b.x, b.y);
    if (at.is_hole()) return false;
    switch (wants_) {
        case Wants::anything: return true;
        case Wants::first_hit:
            if (ray_meets(scene_, origin, direction, triangle, at.opacity)) return true;
            if (at.tint != Rgb(1, 1, 1)) add({lane, triangle, b, distance, at.tint});
            return false;
        case Wants::transmittance:
            if (at.passes() == Rgb(0, 0, 0)) return true;
            add({lane, triangle, b, distance, at.passes()});
            return false;
    }
    return true;
}

void SeeThroughQuery::add(const Pane& pane) {
    const auto before = [](const Pane& a, const Pane& b) { return std::tie(a.lane, a.triangle) < std::tie(b.lane, b.triangle); };
    const auto at = std::lower_bound(panes_.begin(), panes_.end(), pane, before);
    if (at == panes_.end() || before(pane, *at)) panes_.insert(at, pane);
}

bool SeeThroughQuery::is_same(const Pane& a, const Pane& b) const {
    return scene_.triangle_object[a.triangle] == scene_.triangle_object[b.triangle] &&
           std::fabs(a.distance - b.distance) <= edge_distance * std::max(a.distance, b.distance) && is_on_edge(a.b) && is_on_edge(b.b);
}

Rgb SeeThroughQuery::passed(std::size_t lane, float distance) const {
    Rgb product(1, 1, 1);
    const auto counts = [&](const Pane& pane) { return pane.lane == lane && pane.distance <= distance; };
    for (auto pane = panes_.begin(); pane != panes_.end(); ++pane) {
        if (!counts(*pane)) continue;
        const bool is_known = std::any_of(panes_.begin(), pane, [&](const Pane& other) { return counts(other) && is_same(*pane, other); });
        if (!is_known) product *= pane->passes;
    }
    return product;
}

void see_through_filter(const RTCFilterFunctionNArguments* call) {
    auto& query = *static_cast<SeeThroughQuery*>(static_cast<EmbreeContext*>(call->context));
    const auto& geometry = *static_cast<const SeeThroughGeometry*>(call->geometryUserPtr);
    const unsigned n = call->N;
    for (unsigned k = 0; k < n; ++k) {
        if (call->valid[k] == 0) continue;
        RTCRayN* ray = call->ray;
        const Vec3f origin(RTCRayN_org_x(ray, n, k), RTCRayN_org_y(ray, n, k), RTCRayN_org_z(ray, n, k));
        const Vec3f direction(RTCRayN_dir_x(ray, n, k), RTCRayN_dir_y(ray, n, k), RTCRayN_dir_z(ray, n, k));
        const std::uint32_t triangle = geometry.triangle_of[RTCHitN_primID(call->hit, n, k)];
        const Vec2f b(RTCHitN_u(call->hit, n, k), RTCHitN_v(call->hit, n, k));
        if (!query.stops(RTCRayN_id(ray, n, k), origin, direction, triangle, b, RTCRayN_tfar(ray, n, k))) call->valid[k] = 0;
    }
}

}  // namespace luxel
