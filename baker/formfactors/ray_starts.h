/// Rays from the surface of a patch: points and local directions become origins off the surface and directions in the
/// scene.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/patches/patch_sampler.h"

namespace luxel {

/// Four-dimensional points of a sequence: place (0, 1) and direction (2, 3), and the directions in the frame of the
/// surface.
struct StartBatch {
    static constexpr std::size_t capacity = SobolSequence::batch;
    std::array<std::array<float, capacity>, 4> points;
    std::array<float, capacity> x, y, z;
};

/// Where rays go, one array per component, entries [first, first + count) are written.
struct RayArrays {
    std::span<float> origin_x, origin_y, origin_z, direction_x, direction_y, direction_z;
    std::span<std::uint32_t> from_triangle;
};

/// Does for many points what SurfaceSampler::point() does for one. The surface is cut once into parts on most of which
/// the way from a point of the unit square to the ray is one affine map, so that a ray costs two short searches and
/// that map. Positions are those of point() up to rounding, within what ray_offset.h allows for.
class RayStarts {
  public:
    /// `scene` and `sampler` must outlive it. Threads: const and reentrant.
    RayStarts(const Scene& scene, const SurfaceSampler& sampler);

    /// Rays of points [begin, end) of the batch, to the places from `to` on.
    void aim(const StartBatch& batch, std::size_t begin, std::size_t end, const RayArrays& out, std::size_t to) const;

  private:
    /// A square or a triangle of a row, or a piece that something cuts.
    struct Part {
        float inverse_width;  ///< of its interval of u
        bool is_square;
        std::uint32_t side;
        const SurfaceSampler::Piece* cut;  ///< null for the first two
        Vec3f origin, side_1, side_2;      ///< off the surface already
    };
    struct Row {
        std::uint32_t first, end;  ///< parts
        float inverse_share;
    };
    /// The plane of a triangle, on the side that rays leave from.
    struct Side {
        Frame frame;
        Vec3f offset;
        std::uint32_t triangle;
    };
    void add_piece(const SurfaceSampler::Piece& piece, float before);
    std::uint32_t side_of(const SurfaceSampler::Piece& piece);
    void aim_flat(const StartBatch& batch, std::size_t begin, std::size_t end, const RayArrays& out,
                  std::size_t to) const;
    void aim_parts(const StartBatch& batch, std::size_t begin, std::size_t end, const RayArrays& out,
                   std::size_t to) const;

    const Scene& scene_;
    const SurfaceSampler& sampler_;
    std::vector<Part> parts_;
    std::vector<float> part_begin_;  ///< in u, ascending in a row
    std::vector<Row> rows_;
    std::vector<Side> sides_;
};

}  // namespace luxel
