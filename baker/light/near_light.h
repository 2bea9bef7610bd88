/// Light that surfaces close to a texel reflect. A patch has one radiosity; seen from nearer than it is wide, that mean
/// is wrong: under furniture, between two sheets, along the foot of a wall. There the path goes on: from the point that
/// was hit to lamps, to emitters and along one more cosine ray, until a hit lies farther away than its patch is wide
/// and the solution is good enough again, or too little depends on it. Far hits are followed where the solution is coarse: on backs,
/// which have no texels of their own, and where something stands on the surface (patches/contact_texels.h). After each bounce
/// but the first, half of the paths stand for all. No roulette: in even light every path says the same.
/// Source: secondary final gathering for close geometry (Christensen, Faster Photon Map Global Illumination, JGT
/// 4(3) 1999, section 4); multiple importance sampling as in gather.h.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "baker/core/sobol.h"
#include "baker/light/gather.h"
#include "baker/light/light_sum.h"
#include "baker/trace/surface_map.h"

namespace luxel {

/// A point that a ray of a texel has met.
struct NearVertex {
    Vec3f position;  ///< on the surface
    Vec3f normal;    ///< unit geometric normal of the side that was met
    std::uint32_t triangle = none;
    std::uint32_t ray = 0;  ///< number of the texel's ray: names its random numbers
    float share = 1;        ///< of the light, that the bounces before this point leave of it
    Rgb throughput;         ///< what the texel receives per lux here
};

/// For the rays of one texel. Makes its tables on first use: most texels have nothing close to them.
class NearLight {
  public:
    static constexpr std::size_t batch = SobolSequence::batch;
    /// That a path may take without getting away from what is near.
    static constexpr std::uint32_t most_bounces = 32;

    /// References must outlive it. `reach_m`: hits closer than this are near, m; 0: no hit is followed. `aim`: send rays
    /// to emitters too; not where they fill the view.
    NearLight(const GatherInput& input, float reach_m, const Vec3f& texel_position, bool aim)
        : in_(input), reach_m_(reach_m), position_(texel_position), aim_(aim) {}

    /// Begins with other rays of the texel. `seed`: theirs.
    void start(std::uint64_t seed) { seed_ = seed, ray_count_ = 0, batch_number_ = 0; }

    /// Does the path go on from a hit at `at`? Else the solution serves.
    [[nodiscard]] bool follows(const TraceHit& hit, const SurfaceTexel& at) const {
        if (hit.distance_m < reach_m_) return true;
        return reach_m_ > 0 && (!hit.front || in_.patches.contacts.holds(at.chart->page, place_on_page(in_.patches, at)));
    }
    /// The vertex where `ray` met patch `patch`; `weight`: what the texel receives per unit of radiosity there.
    [[nodiscard]] NearVertex vertex(const TraceRay& ray, const TraceHit& hit, PatchNumber patch, std::uint32_t number,
                                    const Rgb& weight, float share = 1) const;
    /// Adds the light of at most `batch` vertices to `sum`; uses them up. Their own emission is not counted.
    void add(std::vector<NearVertex>& vertices, LightSum& sum);
    /// Traced since start() to follow paths on, without shadow rays to lamps.
    [[nodiscard]] std::uint32_t ray_count() const { return ray_count_; }

  private:
    struct Rays;
    void make_tables();
    void add_lamps(std::span<const NearVertex> vertices, std::span<const std::array<float, 4>> random,
                   LightSum& sum) const;
    void add_aimed(std::span<const NearVertex> vertices, std::uint32_t depth, LightSum& sum);
    void follow(std::vector<NearVertex>& vertices, std::span<const std::array<float, 4>> random, std::uint32_t depth,
                LightSum& sum);
    [[nodiscard]] float emitter_weight(const TraceRay& ray, const TraceHit& hit, PatchNumber patch, float cosine) const;

    const GatherInput& in_;
    float reach_m_;
    Vec3f position_;
    bool aim_;
    std::uint64_t seed_ = 0;
    std::uint32_t ray_count_ = 0;
    std::uint32_t batch_number_ = 0;  ///< of add(), since start()
    bool has_tables_ = false;
    std::vector<float> emitters_up_to_;  ///< EmitterSet::weigh_around; empty without emitters
};

}  // namespace luxel
