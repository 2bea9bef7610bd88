/// First hits and visibility among the scene's triangles. Only user of Embree.
///
/// Determinism: one instruction set (AVX2), robust intersection, a tree built by one thread. Where triangles coincide
/// exactly, the hit goes to the one that shows its front to the ray, among those to one that lets light through, and among
/// those to the lowest number.
///
/// Where surfaces let light through (scene/see_through.h), a first hit is one surface: each that the ray comes to it
/// meets with the chance of that surface's opacity, by a hash of the ray's own bits, so the mean over rays is
/// right and the same rays have the same hits. Shadow rays find the exact product instead. Scenes without such surfaces are traced as if
/// there were none. What casts no shadow (Object::casts) is never met; rays may start there.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "baker/scene/scene.h"

namespace luxel {

class SeeThroughQuery;

struct TraceRay {
    Vec3f origin;     ///< already off its surface (ray_offset.h)
    Vec3f direction;  ///< unit
    std::uint32_t from_triangle = none;  ///< never reported as hit
};

/// Rays by component: for who makes many at once, and as the intersector wants them.
struct RayColumns {
    static constexpr std::size_t capacity = 64;
    std::array<float, capacity> origin_x, origin_y, origin_z, direction_x, direction_y, direction_z;
    std::array<std::uint32_t, capacity> from_triangle;

    void set(std::size_t k, const TraceRay& ray) {
        origin_x[k] = ray.origin.x, origin_y[k] = ray.origin.y, origin_z[k] = ray.origin.z;
        direction_x[k] = ray.direction.x, direction_y[k] = ray.direction.y, direction_z[k] = ray.direction.z;
        from_triangle[k] = ray.from_triangle;
    }
    [[nodiscard]] TraceRay at(std::size_t k) const {
        return {{origin_x[k], origin_y[k], origin_z[k]}, {direction_x[k], direction_y[k], direction_z[k]}, from_triangle[k]};
    }
};

struct TraceHit {
    std::uint32_t triangle = none;  ///< none: the ray left the scene
    float b1 = 0, b2 = 0;           ///< barycentric weights of corners 1 and 2
    float distance_m = 0;
    bool front = false;  ///< the ray met the front
    /// What is left of light that comes back along the ray, 0..1 per channel: the colours of the panes that it passed. The chance
    /// to pass them is not in it, the ray has passed.
    Rgb tint{1, 1, 1};
};

/// What the order of rays promises. It changes the speed, never a hit.
enum class RayCoherence {
    apart,
    together  ///< eight in a row start and look nearly alike, so they may walk the tree as one
};

/// Which surfaces rays ask whether they pass.
enum class PassageTest {
    where_needed,
    everywhere  ///< also those that let nothing pass: the same hits, later
};

class Tracer {
  public:
    /// Builds the tree. Keeps a reference to the scene, which must outlive the tracer.
    /// Throws Error{internal} with Embree's own words when it cannot (out of memory).
    explicit Tracer(const Scene& scene, PassageTest test = PassageTest::where_needed);
    ~Tracer();
    Tracer(const Tracer&) = delete;
    Tracer& operator=(const Tracer&) = delete;

    /// hits[i] belongs to rays[i]; equal sizes. Threads: const and reentrant; the caller has flushed denormals.
    void first_hits(std::span<const TraceRay> rays, std::span<TraceHit> hits) const;
    /// The same for rays [begin, begin + hits.size()).
    void first_hits(const RayColumns& rays, std::size_t begin, std::span<TraceHit> hits,
                    RayCoherence coherence = RayCoherence::apart) const;
    [[nodiscard]] TraceHit first_hit(const TraceRay& ray) const;

    /// Is anything between the origin and the point origin + distance_m * direction (both ends open)? A pane is, a hole in
    /// a masked surface is not.
    [[nodiscard]] bool occluded(const TraceRay& ray, float distance_m) const;

    /// What arrives at the origin of the light that comes from that point, 0..1 per channel: the product over all that
    /// is between. Not by chance.
    [[nodiscard]] Rgb transmittance(const TraceRay& ray, float distance_m) const;

    /// Does anything in the scene let light through? If not, tints are 1 and transmittances 0 or 1.
    [[nodiscard]] bool is_see_through() const;

    /// Bytes that Embree has allocated for this scene, and its numbers of triangles where some are see-through.
    [[nodiscard]] std::uint64_t resident_bytes() const;

  private:
    struct State;
    /// `query`: null when nothing can be seen through.
    [[nodiscard]] TraceHit first_hit(const TraceRay& ray, SeeThroughQuery* query) const;
    void first_hits_through(const RayColumns& rays, std::size_t begin, std::span<TraceHit> hits, RayCoherence coherence) const;
    [[nodiscard]] TraceHit finish(const TraceRay& ray, std::uint32_t triangle, float b1, float b2, float distance, bool front,
                                  SeeThroughQuery* query, std::size_t lane) const;
    std::unique_ptr<State> state_;
};

/// A count is whole or nothing: of rays through tinted panes as many survive as the mean of the channels says, by a hash of the
/// ray's own bits; the others end as absorbed.
bool survives_tint(const TraceRay& ray, const Rgb& tint);

/// What the identity of results depends on beside the inputs: part of the evidence key.
const char* tracer_identity();

}  // namespace luxel
