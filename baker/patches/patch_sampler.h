/// Uniform points on the visible part of a piece of surface, in a way that keeps the strata of a two-dimensional sample pattern: v picks the
/// row of texels and the place in it, u the fragment of the row and the place in that. Where something cuts a fragment, its cells
/// in the open stand for all of its visible area: no point lies inside a solid.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "baker/patches/fragment_polygon.h"
#include "baker/patches/patch.h"

namespace luxel {

/// A triangle is flat when the normals of its corners have at least this cosine to its own.
constexpr float flat_cosine = 0.99999f;

struct SurfacePoint {
    Vec3f position;  ///< m, relative to Scene::origin
    Vec3f normal;    ///< unit geometric normal of the sampled side
    /// The triangle; where several continue one plane (the halves of a quad), the first of them stands for all.
    std::uint32_t triangle = none;
    Vec2f barycentric;  ///< weights of its corners 1 and 2; beyond 0..1 where another triangle continues it
};

/// A flat piece of surface whose points are origin + side_u * u + side_v * v: most patches of large surfaces.
struct Parallelogram {
    Vec3f origin, side_u, side_v;
    Vec3f normal;  ///< unit geometric normal of the sampled side
    std::uint32_t triangle = none;
    Vec2f barycentric, barycentric_u, barycentric_v;  ///< the same map in weights of corners 1 and 2
};

class SurfaceSampler {
  public:
    /// `fragments` in raster order (y, x, triangle), with a visible cell among them; `back`: sample the other side.
    /// The references must outlive the sampler. Threads: const and reentrant.
    SurfaceSampler(const Scene& scene, const Atlas& atlas, std::span<const Fragment> fragments, bool back);

    /// Uniform over the visible area for uniform u, v in [0, 1).
    [[nodiscard]] SurfacePoint point(float u, float v) const;
    /// Set when the whole surface is one parallelogram; point() then follows exactly this map.
    [[nodiscard]] const Parallelogram* flat() const { return is_flat_ ? &flat_ : nullptr; }
    /// Interpolated shading normal on the sampled side.
    [[nodiscard]] Vec3f shading_normal(const SurfacePoint& at) const;
    /// The shading normal of all points, if it is the same everywhere.
    [[nodiscard]] std::optional<Vec3f> one_shading_normal() const;
    /// No point is farther away from `place`, m.
    [[nodiscard]] float reach_m(const Vec3f& place) const;

    /// What point() chooses from unless the surface is flat: rows of texels, and the fragments in each.
    struct Piece {
        FragmentPolygon polygon;
        std::uint32_t triangle;
        Vec3f normal;
        Vec3f corner, edge_1, edge_2;  ///< of the triangle: where its barycentrics are
        VisibleCells visible;
        float share;  ///< of the row's area
    };
    struct Row {
        std::uint32_t first, end;  ///< pieces
        float share;               ///< of the whole area
    };
    [[nodiscard]] std::span<const Piece> pieces() const { return pieces_; }
    [[nodiscard]] std::span<const Row> rows() const { return rows_; }
    /// Shares of the pieces before each in its row, and of the rows before each.
    [[nodiscard]] std::span<const float> piece_before() const { return piece_before_; }
    [[nodiscard]] std::span<const float> row_before() const { return row_before_; }

  private:
    void cut_pieces(const Atlas& atlas, std::span<const Fragment> fragments);
    bool make_flat(const Atlas& atlas, std::span<const Fragment> fragments);

    const Scene& scene_;
    bool back_, is_flat_ = false;
    Parallelogram flat_;
    std::vector<Piece> pieces_;
    std::vector<Row> rows_;
    std::vector<float> piece_before_, row_before_;  ///< shares of those before it in its row, or of the rows before it
};

/// The sampler of a patch, on the side that the patch is.
class PatchSampler : public SurfaceSampler {
  public:
    PatchSampler(const Scene& scene, const Atlas& atlas, const PatchSet& patches, PatchNumber patch)
        : SurfaceSampler(scene, atlas, patches.fragments_of(patch), patches.patches[patch].is_back) {}
};

}  // namespace luxel
