#include "baker/trace/hidden_point.h"

#include <algorithm>
#include <limits>

#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/trace/surface_start.h"

namespace luxel {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
/// Three times as many fronts as backs, and these besides: more than half of the view is fronts.
constexpr std::size_t sure_fronts = 4;
/// A point that one tenth of its half space lights is missed by all of them with a chance of 3 %.
constexpr std::size_t enclosed_rays = 32;
// Where some find the open, the point is not enclosed: with all of probe_rays only fronts with less than a hundredth of its light are missed.

}  // namespace

HiddenPoints::HiddenPoints(const Scene& scene, const Tracer& tracer, float near_m)
    : scene_(scene), tracer_(tracer), near_m_(near_m) {
    const SobolSequence sequence(0x76697369626c65);  // any: one fixed set serves all points
    for (std::size_t k = 0; k < probe_rays; ++k) {
        const auto u = sequence.point(static_cast<std::uint32_t>(k));
        directions_[k] = cosine_direction(u[0], u[1]);
    }
}

bool HiddenPoints::is_hidden(const Vec2f& at, std::uint32_t triangle, const Vec3f& normal) const {
    return side_is_hidden(at, triangle, normal) &&
           (!scene_.object_of(triangle).double_sided || side_is_hidden(at, triangle, -normal));
}

/// What can be seen through is no solid's inside, whichever side it shows.
bool HiddenPoints::is_front(const TraceHit& hit) const {
    return hit.front || scene_.object_of(hit.triangle).double_sided || scene_.is_see_through(hit.triangle);
}

bool HiddenPoints::side_is_hidden(const Vec2f& at, std::uint32_t triangle, const Vec3f& normal) const {
    const Vec3f origin = surface_start(scene_, triangle, at, normal);
    const Frame frame(normal);
    bool open = false;
    float nearest = infinity, farthest = 0;
    std::array<TraceHit, enclosed_rays> fronts;
    std::array<std::size_t, enclosed_rays> rays;
    std::size_t front_count = 0;
    for (std::size_t k = 0; k < (open ? probe_rays : enclosed_rays); ++k) {
        // Under the open sky with no back near: nothing encloses the point, whatever the other rays meet.
        if (k == enclosed_rays && !(nearest <= near_m_)) return false;
        const TraceHit hit = tracer_.first_hit({origin, frame.to_world(directions_[k]), triangle});
        const bool is_out = hit.triangle == none, front = !is_out && is_front(hit);
        open = open || is_out;
        if (front) {
            if (k < enclosed_rays) fronts[front_count] = hit, rays[front_count] = k;
            ++front_count;
        } else if (!is_out) {
            nearest = std::min(nearest, hit.distance_m), farthest = std::max(farthest, hit.distance_m);
        }
        const std::size_t back_count = k + 1 - front_count;
        if (front_count && (open || 2 * front_count >= enclosed_rays || front_count >= 3 * back_count + sure_fronts)) return false;
    }
    if (sees_lamp(origin, triangle, normal, open ? infinity : 2 * farthest)) return false;
    for (std::size_t f = 0; f < front_count; ++f)
        if (gets_out(fronts[f], frame.to_world(directions_[rays[f]]), rays[f], 2 * farthest)) return false;
    return true;
}

/// Follows the way that comes to a front along `direction`; `number`: of the ray, names the directions of its steps.
bool HiddenPoints::gets_out(TraceHit hit, Vec3f direction, std::size_t number, float reach) const {
    for (std::size_t step = 1; step <= most_steps; ++step) {
        if (hit.triangle == none) return true;
        if (!is_front(hit)) return false;
        if (scene_.material_of(hit.triangle).emission != Rgb(0, 0, 0)) return true;
        const Vec3f outside = scene_.geometric_normal(hit.triangle);
        const Vec3f normal = outside.dot(direction) < 0 ? outside : -outside;
        const Vec3f origin = surface_start(scene_, hit.triangle, {hit.b1, hit.b2}, normal);
        if (sees_lamp(origin, hit.triangle, normal, reach)) return true;
        // Odd, so that every ray has another order of the same directions.
        direction = Frame(normal).to_world(directions_[(number + step * (2 * number + 37)) % probe_rays]);
        hit = tracer_.first_hit({origin, direction, hit.triangle});
    }
    return true;
}

/// `reach`: lamps farther away than this lie outside of what encloses the point, m.
bool HiddenPoints::sees_lamp(const Vec3f& origin, std::uint32_t triangle, const Vec3f& normal, float reach) const {
    for (const Lamp& lamp : scene_.lamps) {
        const bool far = lamp.kind == LampKind::directional;
        const Vec3f to = far ? -lamp.direction : lamp.position - origin;
        const float distance = far ? infinity : to.length();
        if (to.dot(normal) <= 0 || distance > reach) continue;
        if (tracer_.transmittance({origin, to.normalized(), triangle}, distance) != Rgb(0, 0, 0)) return true;
    }
    return false;
}

}  // namespace luxel
