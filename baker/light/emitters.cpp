#include "baker/light/emitters.h"

#include <algorithm>
#include <cmath>

#include "baker/core/units.h"

namespace luxel {
namespace {

/// Weighing costs a texel one evaluation per cluster: more than this many and it would outweigh the rays.
constexpr std::size_t most_clusters = 256;

float power_of(const Patch& patch) {
    return patch.area_m2 * (patch.emission.x + patch.emission.y + patch.emission.z);
}

}  // namespace

EmitterSet::EmitterSet(const Scene& scene, const Atlas& atlas, const PatchSet& patches)
    : patches_(patches), lamps_(scene.lamps), member_of_(patches.count(), none) {
    for (PatchNumber p = 0; p < patches.count(); ++p)
        if (power_of(patches.patches[p]) > 0 && !scene.is_see_through(patches.fragments_of(p).front().triangle))
            members_.push_back({p, 0, 0});
    // By surface, then raster: neighbours lie together, and the order does not depend on chunks.
    std::sort(members_.begin(), members_.end(), [&](const Member& a, const Member& b) { return place(a.patch) < place(b.patch); });
    for (const Member& member : members_) {
        member_of_[member.patch] = static_cast<std::uint32_t>(samplers_.size());
        samplers_.emplace_back(scene, atlas, patches, member.patch);
    }
    const std::size_t most_members = std::max<std::size_t>(8, 2 * members_.size() / most_clusters);
    std::size_t first = 0;
    for (std::size_t k = 0; k < members_.size(); ++k) {
        const Patch &own = patches.patches[members_[k].patch], &begin = patches.patches[members_[first].patch];
        if (k - first >= most_members || own.chart != begin.chart || own.is_back != begin.is_back) {
            close_cluster(first);
            first = k;
        }
        cluster_of_.push_back(static_cast<std::uint32_t>(clusters_.size()));
    }
    if (!members_.empty()) close_cluster(first);
}

std::tuple<std::uint32_t, bool, std::uint32_t, std::uint32_t> EmitterSet::place(PatchNumber number) const {
    const Patch& patch = patches_.patches[number];
    const Fragment& first = patches_.fragments_of(number).front();
    return {patch.chart, patch.is_back, (std::uint32_t{first.y} << 16) | first.x, first.triangle};
}

void EmitterSet::close_cluster(std::size_t first) {
    const std::size_t end = cluster_of_.size();
    double power = 0;
    Vec3d center(0, 0, 0), normal(0, 0, 0);
    for (std::size_t k = first; k < end; ++k) {
        const Patch& patch = patches_.patches[members_[k].patch];
        const double own = static_cast<double>(power_of(patch));
        power += own;
        center += to_double(patch.center) * own;
        normal += to_double(patch.normal) * own;
    }
    Cluster cluster{to_float(center / power), to_float(normal.normalized()), 0, 0, static_cast<float>(power), 0,
                    static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end)};
    double sum = 0;
    for (std::size_t k = first; k < end; ++k) {
        const Patch& patch = patches_.patches[members_[k].patch];
        const double own = static_cast<double>(power_of(patch));
        sum += own;
        members_[k].share = static_cast<float>(own / power);
        members_[k].power_up_to = k + 1 == end ? 1.0f : static_cast<float>(sum / power);
        cluster.area_m2 += patch.area_m2;
        cluster.radius_m = std::max(cluster.radius_m, (patch.center - cluster.center).length() + std::sqrt(patch.area_m2));
        const float cosine = patch.normal.dot(cluster.normal);
        const float sine = cosine > 0 ? std::sqrt(std::max(0.0f, 1 - cosine * cosine)) : 1.0f;
        cluster.normal_spread = std::max(cluster.normal_spread, sine);
    }
    clusters_.push_back(cluster);
}

namespace {

/// From sums so far to shares of the last; empty if there is nothing.
void make_cumulative(std::vector<float>& up_to, float total) {
    if (!(total > 0)) return up_to.clear();
    // Behind the last that counts nothing may be chosen, whatever rounding makes of it.
    for (float& sum : up_to) sum = sum < total ? sum / total : 1.0f;
}

float before(std::span<const float> up_to, std::size_t k) { return k == 0 ? 0.0f : up_to[k - 1]; }
float probability(std::span<const float> up_to, std::size_t k) { return up_to[k] - before(up_to, k); }

}  // namespace

float EmitterSet::weigh(const Vec3f& position, const Vec3f& normal, std::vector<float>& up_to) const {
    up_to.resize(clusters_.size());
    float total = 0, seen = 0;
    for (std::size_t k = 0; k < clusters_.size(); ++k) {
        const Cluster& cluster = clusters_[k];
        const Vec3f to = cluster.center - position;
        const float distance = to.length(), far = std::max(distance, cluster.radius_m);
        // How far the cluster reaches beyond its centre, as seen from here, widens both cosines.
        const float slack = cluster.radius_m / far;
        const float receives = distance > 0 ? to.dot(normal) / distance : 1.0f;
        const float sends = distance > 0 ? -to.dot(cluster.normal) / distance : 1.0f;
        const float bound_receives = std::clamp(receives + slack, 0.0f, 1.0f);
        const float bound_sends = std::clamp(sends + slack + cluster.normal_spread, 0.0f, 1.0f);
        const float density = bound_receives * bound_sends / (far * far);
        up_to[k] = total += cluster.power * density;
        seen += cluster.area_m2 * density * static_cast<float>(1 / pi);
    }
    make_cumulative(up_to, total);
    return std::min(seen, 1.0f);
}

void EmitterSet::weigh_around(const Vec3f& position, float around_m, std::vector<float>& up_to) const {
    up_to.resize(clusters_.size());
    float total = 0;
    for (std::size_t k = 0; k < clusters_.size(); ++k) {
        const Cluster& cluster = clusters_[k];
        const Vec3f to = cluster.center - position;
        const float distance = to.length(), far = std::max({distance, cluster.radius_m, around_m});
        const float sends = distance > 0 ? -to.dot(cluster.normal) / distance : 1.0f;
        const float bound_sends = std::clamp(sends + (cluster.radius_m + around_m) / far + cluster.normal_spread, 0.0f, 1.0f);
        up_to[k] = total += cluster.power * bound_sends / (far * far);
    }
    make_cumulative(up_to, total);
}

EmitterSet::Aim EmitterSet::aim(std::span<const float> up_to, float choice, float u, float v) const {
    const auto k = static_cast<std::size_t>(std::upper_bound(up_to.begin(), up_to.end() - 1, choice) - up_to.begin());
    const Cluster& cluster = clusters_[k];
    const float inside = std::clamp((choice - before(up_to, k)) / probability(up_to, k), 0.0f, 0x1.fffffep-1f);
    const auto begin = members_.begin() + cluster.first, end = members_.begin() + cluster.end;
    const auto member = std::upper_bound(begin, end - 1, inside,
                                         [](float value, const Member& m) { return value < m.power_up_to; });
    return {member->patch, samplers_[static_cast<std::size_t>(member - members_.begin())].point(u, v)};
}

float EmitterSet::density(std::span<const float> up_to, PatchNumber patch) const {
    const std::uint32_t member = member_of_[patch];
    if (member == none) return 0;
    return probability(up_to, cluster_of_[member]) * members_[member].share / patches_.patches[patch].area_m2;
}

float EmitterSet::density_per_sr(std::span<const float> up_to, PatchNumber patch, const Scene& scene, const TraceRay& ray,
                                 const TraceHit& hit) const {
    const float sends = std::fabs(scene.geometric_normal(hit.triangle).dot(ray.direction));
    return density(up_to, patch) * hit.distance_m * hit.distance_m / std::max(sends, 1e-6f);
}

}  // namespace luxel
