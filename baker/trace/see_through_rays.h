/// What the tracer's rays do where a surface lets light through: the filter that Embree calls for such triangles, and what a
/// ray remembers of the panes that it passed. Inside of the tracer; others see tracer.h.
///
/// Whether a ray meets a surface of opacity o (scene/see_through.h) is decided by a number that is a hash of the ray's own bits and
/// of the triangle's name (object path and place in the object): below o it meets. So the mean over rays is right, and a
/// ray does the same in every packet, on every thread, whatever other objects there are.
///
/// Embree may ask more than once for one triangle (its tree cuts triangles), in any order, and for some that lie behind
/// the final hit. So panes are kept in a list with their distances, each once, and their colours are multiplied in the order of
/// triangles. An edge that two triangles of a surface share is met in both: it counts as one pane.
/// Threads: a query belongs to one thread.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "baker/scene/see_through.h"
#include "baker/trace/embree_api.h"
#include "baker/trace/tracer.h"

namespace luxel {

/// Does the ray meet a surface of this opacity, or does it pass?
bool ray_meets(const Scene& scene, const Vec3f& origin, const Vec3f& direction, std::uint32_t triangle, float opacity);

/// One call of Embree, for up to eight rays; `id` of each RTCRay is its place among them. Base of what the filter receives.
class SeeThroughQuery : public EmbreeContext {
  public:
    enum class Wants {
        first_hit,      ///< rays stop where ray_meets() says so
        anything,       ///< rays stop at all but holes
        transmittance,  ///< rays stop where nothing passes
    };
    SeeThroughQuery(const Scene& scene, Wants wants) : scene_(scene), wants_(wants) { from_.fill(none); }

    void set_from(std::size_t lane, std::uint32_t triangle) { from_[lane] = triangle; }
    /// Does the ray stop here? Remembers the pane if it passes one.
    bool stops(std::size_t lane, const Vec3f& origin, const Vec3f& direction, std::uint32_t triangle, const Vec2f& b,
               float distance);
    /// Product of what the panes up to `distance` let through: their tints for first hits, else tint and share.
    [[nodiscard]] Rgb passed(std::size_t lane, float distance) const;

  private:
    struct Pane {
        std::size_t lane;
        std::uint32_t triangle;
        Vec2f b;
        float distance;
        Rgb passes;
    };
    void add(const Pane& pane);
    [[nodiscard]] bool is_same(const Pane& a, const Pane& b) const;

    const Scene& scene_;
    Wants wants_;
    std::array<std::uint32_t, 8> from_;
    std::vector<Pane> panes_;  ///< by lane, then triangle
};

/// What the user pointer of a geometry with the filter points to; must outlive it.
struct SeeThroughGeometry {
    const std::uint32_t* triangle_of = nullptr;  ///< per primitive of the geometry
};
void see_through_filter(const RTCFilterFunctionNArguments* call);

}  // namespace luxel
