/// Is a point of the surface inside a solid, or behind a wall, where no light comes?
///
/// One side of it is hidden when
/// - the rays of its half space meet nothing but backs of one-sided surfaces, or leave the scene while such a back is near (what
///   sticks out behind the wall of a room); or
/// - more than half of them meet backs, none leaves, and what the others meet is hidden too (other things inside the solid: a
///   post through a box, boxes that cut each other): no way from front to front leads out. Out is where the scene ends,
///   what shines, what a lamp reaches, or wherever such a way does not end on a back for most_steps steps;
/// and no lamp reaches it. Of a two-sided surface both sides must be hidden. A surface that is two-sided or lets light through is never the inside
/// of a solid: it counts as a front.
///
/// So one front in the light is enough to stay visible, and a point that sees more fronts than backs always is: under a roof seen from
/// behind, in rooms with a few faces the wrong way round.
/// Threads: const and reentrant. A pure function of geometry, of what shines and of where lamps are; errors: none.
#pragma once
#include <array>

#include "baker/trace/tracer.h"

namespace luxel {

class HiddenPoints {
  public:
    /// `near_m`: how far things may reach behind a wall, m. References must outlive it.
    HiddenPoints(const Scene& scene, const Tracer& tracer, float near_m);
    /// At barycentrics (b1, b2); `normal`: unit geometric normal of the triangle.
    [[nodiscard]] bool is_hidden(const Vec2f& at, std::uint32_t triangle, const Vec3f& normal) const;

  private:
    static constexpr std::size_t probe_rays = 256, most_steps = 10;
    [[nodiscard]] bool side_is_hidden(const Vec2f& at, std::uint32_t triangle, const Vec3f& normal) const;
    [[nodiscard]] bool is_front(const TraceHit& hit) const;
    [[nodiscard]] bool gets_out(TraceHit hit, Vec3f direction, std::size_t number, float reach) const;
    [[nodiscard]] bool sees_lamp(const Vec3f& origin, std::uint32_t triangle, const Vec3f& normal, float reach) const;

    const Scene& scene_;
    const Tracer& tracer_;
    float near_m_;
    std::array<Vec3f, probe_rays> directions_;
};

}  // namespace luxel
