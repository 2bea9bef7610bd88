/// What emits, as things to aim at. Lamps: lamp_tree.h. Surfaces: small bright areas that cosine rays seldom find. Patches are gathered into
/// clusters; a texel weighs the clusters by what they could send it, picks one, then a patch by power, then a point.
/// Surfaces that let light through are left out, for their points do not all send: cosine rays find them.
/// Source: next event estimation over clustered lights; combined with cosine rays by multiple importance sampling with the
/// balance heuristic (Veach and Guibas, Optimally Combining Sampling Techniques for Monte Carlo Rendering, 1995).
#pragma once
#include <span>
#include <tuple>
#include <vector>

#include "baker/light/lamp_tree.h"
#include "baker/patches/patch.h"
#include "baker/patches/patch_sampler.h"
#include "baker/trace/tracer.h"

namespace luxel {

class EmitterSet {
  public:
    /// Keeps references to the patches, the scene and its lamps, and the atlas.
    EmitterSet(const Scene& scene, const Atlas& atlas, const PatchSet& patches);

    [[nodiscard]] bool empty() const { return clusters_.empty(); }
    [[nodiscard]] const LampTree& lamps() const { return lamps_; }
    [[nodiscard]] std::size_t cluster_count() const { return clusters_.size(); }

    /// Probability of each cluster for a receiver at `position` with unit `normal`, cumulative: the last is 1, or empty if none can be seen.
    /// Returns about which share of the receiver's cosine rays would find an emitter if nothing stood between, 0..1.
    float weigh(const Vec3f& position, const Vec3f& normal, std::vector<float>& up_to) const;

    /// The same for receivers within `around_m` of `position` that may face any way.
    void weigh_around(const Vec3f& position, float around_m, std::vector<float>& up_to) const;

    struct Aim {
        PatchNumber patch = no_patch;
        SurfacePoint point;
    };
    /// A point on an emitter for `choice`, u, v in [0, 1). `up_to`, here and below: of weigh() or weigh_around(), not empty.
    [[nodiscard]] Aim aim(std::span<const float> up_to, float choice, float u, float v) const;

    /// Density of aim() on the surface of a patch, 1/m2; 0 for patches that do not emit.
    [[nodiscard]] float density(std::span<const float> up_to, PatchNumber patch) const;

    /// The same per direction in which a ray met the patch, 1/sr.
    [[nodiscard]] float density_per_sr(std::span<const float> up_to, PatchNumber patch, const Scene& scene, const TraceRay& ray,
                                       const TraceHit& hit) const;

  private:
    struct Cluster {
        Vec3f center, normal;
        float radius_m, normal_spread, power, area_m2;  ///< spread: sine of the largest angle between its patches' normals and `normal`
        std::uint32_t first, end;              ///< run in members_
    };
    struct Member {
        PatchNumber patch;
        float power_up_to;  ///< cumulative share of the cluster's power, last is 1
        float share;
    };
    [[nodiscard]] std::tuple<std::uint32_t, bool, std::uint32_t, std::uint32_t> place(PatchNumber number) const;
    void close_cluster(std::size_t first);

    const PatchSet& patches_;
    LampTree lamps_;
    std::vector<Cluster> clusters_;
    std::vector<Member> members_;
    std::vector<PatchSampler> samplers_;        ///< per member
    std::vector<std::uint32_t> member_of_;      ///< per patch: index into members_ or none
    std::vector<std::uint32_t> cluster_of_;     ///< per member
};

}  // namespace luxel
