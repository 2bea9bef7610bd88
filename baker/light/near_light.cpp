#include "baker/light/near_light.h"

#include <algorithm>
#include <cmath>

#include "baker/core/sampling.h"
#include "baker/core/units.h"
#include "baker/light/lamps.h"
#include "baker/light/sky_gather.h"
#include "baker/patches/patch_sampler.h"
#include "baker/scene/texture_sample.h"
#include "baker/core/ray_offset.h"

namespace luxel {
namespace {

/// The share of the light that makes another bounce worth its rays. What is left then is what the patches say: in a dark gap
/// behind a lit wall that is too much, so it must be little.
constexpr float least_share = 0.002f;
/// Radius of the spot that a lamp makes on a surface close to it, over what is near: half a texel by default.
constexpr float lamp_spot_share = 0.125f;
constexpr std::uint64_t path_purpose = 0x6e656172, aim_purpose = 0x6e61696d, thin_purpose = 0x7468696e;

TraceRay leave(const Scene& scene, const NearVertex& at, const Vec3f& direction) {
    return {offset_origin(at.position, at.normal, scene.corner_extent(at.triangle)), direction, at.triangle};
}

/// Leaves at most half of the vertices, chosen in their order and in proportion to what depends on them, to stand for all, with the
/// weight that all had together: even light stays without noise. In a gap most paths stay for many bounces, and the later ones
/// matter less and less. One that is chosen more than once stays one, with that much more weight. Systematic resampling: Kitagawa, Monte Carlo Filter and Smoother for Non-Gaussian Nonlinear
/// State Space Models, JCGS 5(1) 1996, appendix. `u` in [0, 1).
void thin_out(std::vector<NearVertex>& vertices, float u) {
    if (vertices.size() < 2) return;
    const auto weight = [](const NearVertex& at) {
        return static_cast<double>(std::max({at.throughput.x, at.throughput.y, at.throughput.z}));
    };
    double total = 0;
    for (const NearVertex& at : vertices) total += weight(at);
    if (!(total > 0)) return vertices.clear();
    const std::size_t count = (vertices.size() + 1) / 2;
    const double each = total / static_cast<double>(count);
    std::vector<NearVertex> chosen;
    std::size_t choices = 0;
    double up_to = 0;
    for (const NearVertex& at : vertices) {
        const double own = weight(at);
        const std::size_t before = choices;
        for (up_to += own; (static_cast<double>(u) + static_cast<double>(choices)) * each < up_to && choices < count;) ++choices;
        if (choices == before) continue;
        chosen.push_back(at);
        chosen.back().throughput *= static_cast<float>(static_cast<double>(choices - before) * each / own);
    }
    vertices = std::move(chosen);
}

}  // namespace

struct NearLight::Rays {
    std::array<TraceRay, batch> rays;
    std::array<TraceHit, batch> hits;
    std::array<std::uint32_t, batch> vertex;  ///< which one it left from
    std::array<PatchNumber, batch> target;    ///< of aimed rays
    std::array<float, batch> cosine;
    std::size_t count = 0;
    void push(const TraceRay& ray, std::size_t from, float cosine_there, PatchNumber aimed_at = no_patch) {
        rays[count] = ray, vertex[count] = static_cast<std::uint32_t>(from), cosine[count] = cosine_there;
        target[count++] = aimed_at;
    }
    void trace(const Tracer& tracer) { tracer.first_hits({rays.data(), count}, {hits.data(), count}); }
};

NearVertex NearLight::vertex(const TraceRay& ray, const TraceHit& hit, PatchNumber patch, std::uint32_t number,
                             const Rgb& weight, float share) const {
    // The detail of its colour shows in what comes straight from it; farther on the mean will do.
    const bool has_detail = share == 1 && has_varied_base(in_.scene, hit.triangle);
    const Rgb reflectance = has_detail ? surface_reflectance(in_.scene, hit.triangle, hit.b1, hit.b2)
                                        : in_.patches.patches[patch].reflectance;
    const Vec3f normal = in_.scene.geometric_normal(hit.triangle);
    return {surface_position(in_.scene, hit.triangle, {hit.b1, hit.b2}),
            normal.dot(ray.direction) < 0 ? normal : -normal,
            hit.triangle,
            number,
            share * std::max({reflectance.x, reflectance.y, reflectance.z}),
            weight * reflectance};
}

void NearLight::make_tables() {
    if (has_tables_) return;
    has_tables_ = true;
    // Half of all paths stay within two steps; farther ones only choose less well.
    const float around_m = 2 * reach_m_;
    if (aim_ && !in_.emitters.empty()) in_.emitters.weigh_around(position_, around_m, emitters_up_to_);
}

void NearLight::add(std::vector<NearVertex>& vertices, LightSum& sum) {
    make_tables();
    std::vector<std::array<float, 4>> random;
    for (std::uint32_t depth = 0; !vertices.empty(); ++depth) {
        const ShuffledSobol sequence(mix(seed_, path_purpose + depth));
        random.clear();
        for (const NearVertex& at : vertices) random.push_back(sequence.point(at.ray));
        if (!in_.scene.lamps.empty()) add_lamps(vertices, random, sum);
        if (!emitters_up_to_.empty()) add_aimed(vertices, depth, sum);
        add_aimed_sky(in_, vertices, mix(seed_, depth), sum);
        ray_count_ += aimed_sky_rays(in_.sky, 1) * static_cast<std::uint32_t>(vertices.size());
        follow(vertices, random, depth, sum);
        if (depth > 0) thin_out(vertices, ShuffledSobol(mix(seed_, thin_purpose + depth)).point(batch_number_)[0]);
    }
    ++batch_number_;
}

void NearLight::add_lamps(std::span<const NearVertex> vertices, std::span<const std::array<float, 4>> random,
                          LightSum& sum) const {
    const LampLight light(in_.scene, in_.tracer);
    const float spot_m = lamp_spot_share * reach_m_;
    for (std::size_t k = 0; k < vertices.size(); ++k) {
        const NearVertex& at = vertices[k];
        const auto choice = in_.emitters.lamps().choose({at.position, at.normal}, random[k][2], spot_m);
        if (!choice) continue;
        const float part = spread_in_spot(in_.scene.lamps[choice->lamp], at.position, at.normal, spot_m) / choice->probability;
        sum.add(light.irradiance_of(choice->lamp, {at.position, at.normal, at.normal, at.triangle}, {choice->rest, random[k][3]}) * part, at.throughput);
    }
}

float NearLight::emitter_weight(const TraceRay& ray, const TraceHit& hit, PatchNumber patch, float cosine) const {
    if (emitters_up_to_.empty()) return 1;
    const float by_cosine = cosine * static_cast<float>(1 / pi);
    const float aimed = in_.emitters.density_per_sr(emitters_up_to_, patch, in_.scene, ray, hit);
    return by_cosine / std::max(by_cosine + aimed, 1e-30f);
}

void NearLight::add_aimed(std::span<const NearVertex> vertices, std::uint32_t depth, LightSum& sum) {
    const ShuffledSobol aims(mix(seed_, aim_purpose + depth));
    Rays aimed;
    for (std::size_t k = 0; k < vertices.size(); ++k) {
        const NearVertex& at = vertices[k];
        const auto u = aims.point(at.ray);
        const EmitterSet::Aim target = in_.emitters.aim(emitters_up_to_, u[0], u[1], u[2]);
        const Vec3f to = target.point.position - at.position;
        const float distance = to.length();
        if (!(distance > 0)) continue;
        const Vec3f direction = to / distance;
        const float cosine = direction.dot(at.normal);
        if (cosine > 0 && direction.dot(target.point.normal) < 0)
            aimed.push(leave(in_.scene, at, direction), k, cosine, target.patch);
    }
    aimed.trace(in_.tracer);
    ray_count_ += static_cast<std::uint32_t>(aimed.count);
    for (std::size_t k = 0; k < aimed.count; ++k) {
        const Landing at = landing(in_.scene, in_.atlas, in_.patches, aimed.hits[k]);
        if (at.end != RayEnd::patch || at.patch != aimed.target[k]) continue;
        sum.add(in_.patches.patches[at.patch].emission *
                    emitter_weight(aimed.rays[k], aimed.hits[k], at.patch, aimed.cosine[k]),
                vertices[aimed.vertex[k]].throughput * aimed.hits[k].tint);
    }
}

void NearLight::follow(std::vector<NearVertex>& vertices, std::span<const std::array<float, 4>> random,
                       std::uint32_t depth, LightSum& sum) {
    Rays rays;
    for (std::size_t k = 0; k < vertices.size(); ++k) {
        const Vec3f local = cosine_direction(random[k][0], random[k][1]);
        rays.push(leave(in_.scene, vertices[k], Frame(vertices[k].normal).to_world(local)), k, local.z);
    }
    rays.trace(in_.tracer);
    ray_count_ += static_cast<std::uint32_t>(rays.count);
    std::vector<NearVertex> further;
    for (std::size_t k = 0; k < rays.count; ++k) {
        const NearVertex& from = vertices[rays.vertex[k]];
        const TraceHit& hit = rays.hits[k];
        if (hit.triangle == none) {
            sum.add(open_ray_light(in_.sky, rays.rays[k].direction, rays.cosine[k], 1, aimed_sky_rays(in_.sky, 1)), from.throughput * hit.tint);
            continue;
        }
        const SurfaceTexel texel = surface_texel(in_.atlas, in_.patches, hit.triangle, hit.b1, hit.b2);
        const Landing at = landing(in_.patches, hit, texel);
        if (at.end != RayEnd::patch) continue;
        const Patch& patch = in_.patches.patches[at.patch];
        const Rgb throughput = from.throughput * rays.hits[k].tint;
        if (patch.emission != Rgb(0, 0, 0))
            sum.add(patch.emission * emitter_weight(rays.rays[k], rays.hits[k], at.patch, rays.cosine[k]),
                    throughput);
        const NearVertex next = vertex(rays.rays[k], rays.hits[k], at.patch, from.ray, throughput, from.share);
        if (follows(hit, texel) && depth + 1 < most_bounces && next.share >= least_share)
            further.push_back(next);
        else
            sum.add(in_.radiosity.at(at.patch, in_.patches, texel), throughput);
    }
    vertices = std::move(further);
}

}  // namespace luxel
