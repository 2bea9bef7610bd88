#include "baker/formfactors/ray_estimator.h"

#include <algorithm>

#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/trace/surface_map.h"
#include "baker/patches/patch_sampler.h"
#include "baker/trace/ray_offset.h"

namespace luxel {
namespace {

constexpr std::uint32_t batch = SobolSequence::batch;
static_assert(batch == RayColumns::capacity);

/// A batch of rays on its way: points of the sequence, local directions, rays, hits, texels.
struct RayBatch {
    std::array<std::array<float, batch>, 4> points;
    std::array<float, batch> x, y, z;
    RayColumns rays;
    std::array<TraceHit, batch> hits;
    std::array<SurfaceTexel, batch> texels;
};

/// Rays from a parallelogram: one frame and one triangle for all of them.
void aim_flat(const Scene& scene, const Parallelogram& flat, std::size_t count, RayBatch& b) {
    const Frame frame(flat.normal);
    const Vec3f offset = flat.normal * offset_distance(flat.normal, scene.corner_extent(flat.triangle));
    // Component by component, in the order of the vectors' own operations.
    const auto place = [&](float Vec3f::*c, std::array<float, batch>& out) {
        for (std::size_t k = 0; k < count; ++k)
            out[k] = flat.origin.*c + flat.side_u.*c * b.points[0][k] + flat.side_v.*c * b.points[1][k] + offset.*c;
    };
    const auto turn = [&](float Vec3f::*c, std::array<float, batch>& out) {
        for (std::size_t k = 0; k < count; ++k)
            out[k] = frame.tangent.*c * b.x[k] + frame.bitangent.*c * b.y[k] + frame.normal.*c * b.z[k];
    };
    place(&Vec3f::x, b.rays.origin_x), place(&Vec3f::y, b.rays.origin_y), place(&Vec3f::z, b.rays.origin_z);
    turn(&Vec3f::x, b.rays.direction_x), turn(&Vec3f::y, b.rays.direction_y), turn(&Vec3f::z, b.rays.direction_z);
    b.rays.from_triangle.fill(flat.triangle);
}

void aim(const Scene& scene, const SurfaceSampler& sampler, std::size_t count, RayBatch& b) {
    for (std::size_t k = 0; k < count; ++k) {
        const SurfacePoint at = sampler.point(b.points[0][k], b.points[1][k]);
        b.rays.set(k, {offset_origin(at.position, at.normal, scene.corner_extent(at.triangle)),
                       Frame(at.normal).to_world({b.x[k], b.y[k], b.z[k]}), at.triangle});
    }
}

class RayEstimator final : public Estimator {
  public:
    RayEstimator(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer,
                 const RayEstimatorOptions& options)
        : scene_(scene), atlas_(atlas), patches_(patches), tracer_(tracer), options_(options) {}

    void cast(PatchNumber patch, LevelRange levels, std::vector<Landings>& out) const override {
        out.resize(options_.replicates);
        const PatchSampler sampler(scene_, atlas_, patches_, patch);
        const std::uint64_t end = std::uint64_t{1} << levels.last;
        RayBatch b;
        for (std::uint32_t replicate = 0; replicate < options_.replicates; ++replicate) {
            out[replicate].clear();
            const SobolSequence sequence(mix(mix(patches_.patches[patch].id, options_.seed), replicate));
            for (std::uint64_t begin = end - ray_count(levels); begin < end;) {
                // Level boundaries below the batch size cut batches short.
                const std::uint64_t first = begin / batch * batch;
                const std::uint64_t last = std::min(end, first + batch);
                cast_batch(sampler, sequence, first, begin, last, b, out[replicate]);
                begin = last;
            }
        }
    }

    [[nodiscard]] std::uint32_t replicate_count() const override { return options_.replicates; }

    [[nodiscard]] Key identity() const override {
        return KeyBuilder("ray estimator 2")
            .text(tracer_identity())
            .integer(static_cast<std::int64_t>(options_.seed))
            .integer(options_.replicates)
            .finish();
    }

  private:
    /// Rays [begin, last) of the batch that starts at `first`.
    void cast_batch(const SurfaceSampler& sampler, const SobolSequence& sequence, std::uint64_t first, std::uint64_t begin,
                    std::uint64_t last, RayBatch& b, Landings& out) const {
        sequence.points(static_cast<std::uint32_t>(first), b.points);
        const std::size_t skip = begin - first, count = last - first;
        cosine_directions(b.points[2], b.points[3], b.x.data(), b.y.data(), b.z.data());
        if (const Parallelogram* flat = sampler.flat())
            aim_flat(scene_, *flat, count, b);
        else
            aim(scene_, sampler, count, b);
        const std::span<TraceHit> hits(b.hits.data() + skip, count - skip);
        tracer_.first_hits(b.rays, skip, hits);
        // Texels are fetched for the whole batch before the first is looked at.
        for (std::size_t k = 0; k < hits.size(); ++k) {
            if (hits[k].triangle == none) continue;
            b.texels[k] = surface_texel(atlas_, patches_, hits[k].triangle, hits[k].b1, hits[k].b2);
            __builtin_prefetch(b.texels[k].patch);
        }
        for (std::size_t k = 0; k < hits.size(); ++k) {
            const Landing at = landing(patches_, hits[k], b.texels[k]);
            if (at.end == RayEnd::patch)
                out.patches.push_back(at.patch);
            else
                ++(at.end == RayEnd::open ? out.open : out.back);
        }
    }

    const Scene& scene_;
    const Atlas& atlas_;
    const PatchSet& patches_;
    const Tracer& tracer_;
    RayEstimatorOptions options_;
};

}  // namespace

std::unique_ptr<Estimator> make_ray_estimator(const Scene& scene, const Atlas& atlas, const PatchSet& patches,
                                              const Tracer& tracer, const RayEstimatorOptions& options) {
    return std::make_unique<RayEstimator>(scene, atlas, patches, tracer, options);
}

}  // namespace luxel
