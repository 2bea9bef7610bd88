#include "baker/light/lit_sides.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/light/lamps.h"
#include "baker/light/sky.h"
#include "baker/scene/texture_sample.h"
#include "baker/trace/surface_start.h"

namespace luxel {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr std::uint64_t purpose = 0x6c697473696465;  // separates these points from those of the evidence
constexpr std::uint32_t paths_at_once = 8, most_paths = 64;
constexpr std::uint32_t most_bounces = 8;
constexpr double dark_share = 0.01;
/// A little more comes through gaps into a crack: where the front sees less than crack_depth as far as the back does.
constexpr double crack_share = 0.05, crack_depth = 0.1;
/// Fronts with more than this share of the back's light are left after the first paths.
constexpr double clear_share = 0.2;
/// Of the paths from the back, as many must find light: if the front had as much, all of its paths would miss it with a chance of 2e-4.
constexpr std::uint32_t least_lit_paths = most_paths / 8;
/// And no more of those from the front: a room behind small windows has little light, but nearly all that is in it get some.
constexpr std::uint32_t most_lit_paths = most_paths / 8;

/// Triangles to choose from in proportion to a weight.
class WeightedTriangles {
  public:
    void add(std::uint32_t triangle, double weight) {
        sum_ += weight;
        triangles_.push_back(triangle);
        up_to_.push_back(sum_);
    }
    [[nodiscard]] bool empty() const { return !(sum_ > 0); }
    [[nodiscard]] double sum() const { return sum_; }
    struct Choice {
        std::uint32_t triangle;
        float rest;  ///< uniform in [0, 1) again
    };
    [[nodiscard]] Choice choose(float u) const {
        const double at = static_cast<double>(u) * sum_;
        const auto found = std::min(std::upper_bound(up_to_.begin(), up_to_.end(), at), up_to_.end() - 1);
        const double before = found == up_to_.begin() ? 0 : *(found - 1), width = *found - before;
        const double rest = width > 0 ? std::clamp((at - before) / width, 0.0, 0x1.fffffep-1) : 0.5;
        return {triangles_[static_cast<std::size_t>(found - up_to_.begin())], static_cast<float>(rest)};
    }

  private:
    std::vector<std::uint32_t> triangles_;
    std::vector<double> up_to_;
    double sum_ = 0;
};

struct PathPoint {
    std::uint32_t triangle;
    Vec2f barycentric;
    Vec3f normal;  ///< unit geometric, of the side that the path is on
};

class Paths {
  public:
    Paths(const Scene& scene, const Tracer& tracer)
        : scene_(scene), tracer_(tracer), lamps_(scene, tracer), sky_(scene.sky.empty() ? nullptr : std::make_unique<Sky>(scene.sky)) {
        Vec3f low = scene.corner(0, 0), high = low;
        for (const Vec3f& p : scene.positions)
            for (int axis = 0; axis < 3; ++axis) low[axis] = std::min(low[axis], p[axis]), high[axis] = std::max(high[axis], p[axis]);
        width_m_ = static_cast<double>((high - low).length());
        for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
            const Material& material = scene.material_of(t);
            if (scene.object_of(t).casts && material.emission != Rgb(0, 0, 0))
                emitters_.add(t, scene.area_m2(t) * static_cast<double>(luminance(material.emission)));
        }
    }
    [[nodiscard]] bool is_dark() const { return lamps_.empty() && emitters_.empty() && (!sky_ || sky_->is_dark()); }

    /// What paths have found so far.
    struct Found {
        double light = 0;            ///< lux of luminance, summed
        double depth_m = 0;          ///< how far they saw, summed; out of the scene is as far as it is wide
        std::uint32_t lit_paths = 0;
    };
    /// Adds one path of light from a point. `number`: of the path, in the sequence of `seed`.
    void add(const PathPoint& from, std::uint64_t seed, std::uint32_t number, Found& found) const {
        double depth_m = 0;
        const double light = follow(from, seed, number, depth_m);
        found.light += light;
        found.depth_m += depth_m;
        found.lit_paths += light > 0;
    }

  private:
    [[nodiscard]] double follow(PathPoint at, std::uint64_t seed, std::uint32_t number, double& depth_m) const {
        double sum = 0;
        Rgb share(1, 1, 1);
        for (std::uint32_t bounce = 0; bounce <= most_bounces; ++bounce) {
            const auto u = SobolSequence(mix(seed, 2 * bounce + 1)).point(number);
            sum += static_cast<double>(luminance(share * (of_lamps(at, {u[2], u[3]}, u[0]) + of_emitters(at, SobolSequence(mix(seed, 2 * bounce + 2)).point(number)))));
            const Vec3f direction = Frame(at.normal).to_world(cosine_direction(u[0], u[1]));
            const TraceHit hit = tracer_.first_hit({surface_start(scene_, at.triangle, at.barycentric, at.normal), direction, at.triangle});
            if (bounce == 0) depth_m = hit.triangle == none ? width_m_ : static_cast<double>(hit.distance_m);
            share *= hit.tint;
            if (hit.triangle == none) return sum + (sky_ ? static_cast<double>(pi * luminance(share * sky_->radiance(direction))) : 0);
            if (!hit.front && !scene_.object_of(hit.triangle).double_sided) return sum;
            share *= surface_reflectance(scene_, hit.triangle, hit.b1, hit.b2);
            if (share == Rgb(0, 0, 0)) return sum;
            const Vec3f outside = scene_.geometric_normal(hit.triangle);
            at = {hit.triangle, {hit.b1, hit.b2}, hit.front ? outside : -outside};
        }
        return sum;
    }
    [[nodiscard]] Rgb of_lamps(const PathPoint& at, const Vec2f& on_lamp, float random) const {
        if (lamps_.empty()) return {0, 0, 0};
        const Vec3f position = surface_position(scene_, at.triangle, at.barycentric);
        return lamps_.irradiance({position, at.normal, at.normal, at.triangle}, random, on_lamp);
    }
    /// One point of all surfaces that shine: M / pi cos cos' / d^2 over its density.
    [[nodiscard]] Rgb of_emitters(const PathPoint& at, const std::array<float, 4>& u) const {
        if (emitters_.empty()) return {0, 0, 0};
        const std::uint32_t triangle = emitters_.choose(u[0]).triangle;
        const Vec2f b = triangle_point(u[1], u[2]);
        const Vec3f origin = surface_start(scene_, at.triangle, at.barycentric, at.normal);
        const Vec3f to = surface_position(scene_, triangle, b) - origin;
        const float distance2 = to.length2();
        if (triangle == at.triangle || !(distance2 > 0)) return {0, 0, 0};
        const Vec3f direction = to / std::sqrt(distance2);
        const float cosine = at.normal.dot(direction);
        float sends = -scene_.geometric_normal(triangle).dot(direction);
        if (scene_.object_of(triangle).double_sided) sends = std::fabs(sends);
        if (cosine <= 0 || sends <= 0) return {0, 0, 0};
        const Rgb passes = tracer_.transmittance({origin, direction, at.triangle}, std::sqrt(distance2));
        // Per m2: the triangle was chosen by area times luminance, the point in it evenly.
        const double density = static_cast<double>(luminance(scene_.material_of(triangle).emission)) / emitters_.sum();
        return passes * surface_emission(scene_, triangle, b.x, b.y) *
               static_cast<float>(static_cast<double>(cosine * sends / (pi * distance2)) / density);
    }

    const Scene& scene_;
    const Tracer& tracer_;
    LampLight lamps_;
    std::unique_ptr<Sky> sky_;  ///< null: there is none
    double width_m_ = 0;  ///< of the scene
    WeightedTriangles emitters_;
};

/// What is known of a chart, per path.
struct Sides {
    double front = 0, back = 0;  ///< lux of luminance
    double dark_share = 0;       ///< of the back's light, below which the front is dark; 0 where the back is not bright for certain
    double area_m2 = 0;
};

Sides look_at(const Scene& scene, const Paths& paths, std::span<const std::uint32_t> triangles, std::uint64_t seed, bool find_unlit) {
    const bool is_two_sided = scene.object_of(triangles.front()).double_sided;
    WeightedTriangles places;
    for (const std::uint32_t t : triangles) places.add(t, scene.area_m2(t));
    const SobolSequence starts(seed);
    Paths::Found front, back;
    for (std::uint32_t k = 0; k < most_paths; ++k) {
        const auto u = starts.point(k);
        const auto [triangle, rest] = places.choose(u[0]);
        const Vec2f b = triangle_point(rest, u[1]);
        const Vec3f normal = scene.geometric_normal(triangle);
        paths.add({triangle, b, normal}, mix(seed, 1), k, front);
        if (is_two_sided) paths.add({triangle, b, -normal}, mix(seed, 2), k, back);
        if ((k + 1) % paths_at_once == 0 && front.light >= clear_share * back.light && (front.light > 0 || !find_unlit))
            return {front.light / (k + 1), back.light / (k + 1), 0, places.sum()};
    }
    const double share = front.depth_m < crack_depth * back.depth_m ? crack_share : dark_share;
    return {front.light / most_paths, back.light / most_paths, back.lit_paths >= least_lit_paths && front.lit_paths <= most_lit_paths ? share : 0, places.sum()};
}

/// Median by area of what fronts get that get any: a lamp or the sun on the back of a chart does not make its front dark.
double usual_light(std::span<const Sides> charts) {
    std::vector<std::pair<double, double>> light;  // and area
    double area_m2 = 0;
    for (const Sides& sides : charts)
        if (sides.front > 0) light.emplace_back(sides.front, sides.area_m2), area_m2 += sides.area_m2;
    std::ranges::sort(light);
    double before = 0;
    for (const auto& [lux, m2] : light)
        if ((before += m2) >= area_m2 / 2) return lux;
    return 0;
}

}  // namespace

DarkFronts find_dark_fronts(const Scene& scene, const Atlas& atlas, const Tracer& tracer, bool find_unlit) {
    DarkFronts found;
    found.charts.assign(atlas.charts.size(), false);
    std::vector<std::vector<std::uint32_t>> triangles(atlas.charts.size());
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        const Object& object = scene.object_of(t);
        if (object.has_lightmap) triangles[atlas.triangle_chart[t]].push_back(t);
    }
    const Paths paths(scene, tracer);
    std::vector<Sides> sides(atlas.charts.size());
    parallel_for(triangles.size(), 16, [&](std::size_t c) {
        if (triangles[c].empty() || paths.is_dark()) return;
        const Chart& chart = atlas.charts[c];
        sides[c] = look_at(scene, paths, triangles[c], mix(mix(scene.objects[chart.object].path_hash, chart.ordinal), purpose), find_unlit);
    });
    if (find_unlit)
        for (std::size_t c = 0; c < sides.size(); ++c) found.unlit.push_back(!triangles[c].empty() && sides[c].front <= 0);
    const double usual = usual_light(sides);  // 0: no front gets light, so all of them are dark
    for (std::size_t c = 0; c < sides.size(); ++c) {
        if (!(sides[c].front < sides[c].dark_share * (usual > 0 ? std::min(sides[c].back, usual) : sides[c].back))) continue;
        found.charts[c] = true;
        ++found.chart_count;
        found.area_m2 += sides[c].area_m2;
    }
    return found;
}

}  // namespace luxel
