#include "baker/formfactors/ray_estimator.h"

#include <algorithm>
#include <utility>

#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/formfactors/direction_order.h"
#include "baker/patches/patch_sampler.h"
#include "baker/trace/ray_offset.h"
#include "baker/trace/surface_map.h"

namespace luxel {
namespace {

constexpr std::uint32_t batch = SobolSequence::batch;

/// Rays that look the same way are worth a packet only where they are many: with 64 rays, eight of them see an eighth
/// of all.
constexpr std::size_t packet_rays = 256;

/// Rays of one patch, whichever replicate they belong to, on their way to where they end.
struct Bundle {
    static constexpr std::size_t capacity = 1024;
    std::array<float, capacity> u, v;  ///< of the direction, on the unit square
    std::array<float, capacity> origin_x, origin_y, origin_z, direction_x, direction_y, direction_z;
    std::array<std::uint32_t, capacity> from_triangle;
    std::array<std::uint8_t, capacity> replicate;
    std::array<std::uint16_t, capacity> order;
    std::size_t count = 0;

    void columns(std::size_t first, std::size_t size, RayColumns& out) const {
        for (std::size_t k = 0; k < size; ++k) {
            const std::size_t ray = order[first + k];
            out.origin_x[k] = origin_x[ray], out.origin_y[k] = origin_y[ray], out.origin_z[k] = origin_z[ray];
            out.direction_x[k] = direction_x[ray], out.direction_y[k] = direction_y[ray],
            out.direction_z[k] = direction_z[ray];
            out.from_triangle[k] = from_triangle[ray];
        }
    }
};

/// A batch of the sequence: points and local directions.
struct Batch {
    std::array<std::array<float, batch>, 4> points;
    std::array<float, batch> x, y, z;
};

/// Points [begin, end) of the batch become rays from a parallelogram: one frame and one triangle for all of them.
void aim_flat(const Scene& scene, const Parallelogram& flat, const Batch& b, std::size_t begin, std::size_t end,
              Bundle& out) {
    const Frame frame(flat.normal);
    const Vec3f offset = flat.normal * offset_distance(flat.normal, scene.corner_extent(flat.triangle));
    const std::size_t shift = out.count - begin;
    // Component by component, in the order of the vectors' own operations.
    const auto place = [&](float Vec3f::*c, std::array<float, Bundle::capacity>& to) {
        for (std::size_t k = begin; k < end; ++k)
            to[shift + k] =
                flat.origin.*c + flat.side_u.*c * b.points[0][k] + flat.side_v.*c * b.points[1][k] + offset.*c;
    };
    const auto turn = [&](float Vec3f::*c, std::array<float, Bundle::capacity>& to) {
        for (std::size_t k = begin; k < end; ++k)
            to[shift + k] = frame.tangent.*c * b.x[k] + frame.bitangent.*c * b.y[k] + frame.normal.*c * b.z[k];
    };
    place(&Vec3f::x, out.origin_x), place(&Vec3f::y, out.origin_y), place(&Vec3f::z, out.origin_z);
    turn(&Vec3f::x, out.direction_x), turn(&Vec3f::y, out.direction_y), turn(&Vec3f::z, out.direction_z);
    std::fill_n(out.from_triangle.begin() + out.count, end - begin, flat.triangle);
}

void aim(const Scene& scene, const SurfaceSampler& sampler, const Batch& b, std::size_t begin, std::size_t end,
         Bundle& out) {
    for (std::size_t k = begin, to = out.count; k < end; ++k, ++to) {
        const SurfacePoint at = sampler.point(b.points[0][k], b.points[1][k]);
        const Vec3f origin = offset_origin(at.position, at.normal, scene.corner_extent(at.triangle));
        const Vec3f direction = Frame(at.normal).to_world({b.x[k], b.y[k], b.z[k]});
        out.origin_x[to] = origin.x, out.origin_y[to] = origin.y, out.origin_z[to] = origin.z;
        out.direction_x[to] = direction.x, out.direction_y[to] = direction.y, out.direction_z[to] = direction.z;
        out.from_triangle[to] = at.triangle;
    }
}

class RayEstimator final : public Estimator {
  public:
    RayEstimator(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer,
                 const RayEstimatorOptions& options)
        : scene_(scene), atlas_(atlas), patches_(patches), tracer_(tracer), options_(options) {}

    void cast(PatchNumber patch, LevelRange levels, std::vector<Landings>& out) const override {
        out.resize(options_.replicates);
        for (Landings& landings : out) landings.clear();
        const PatchSampler sampler(scene_, atlas_, patches_, patch);
        std::vector<SobolSequence> sequences;
        for (std::uint32_t replicate = 0; replicate < options_.replicates; ++replicate)
            sequences.emplace_back(mix(mix(patches_.patches[patch].id, options_.seed), replicate));
        const std::uint64_t end = std::uint64_t{1} << levels.last;
        const auto bundle = std::make_unique_for_overwrite<Bundle>();
        for (std::uint64_t begin = end - ray_count(levels); begin < end;) {
            // Level boundaries below the batch size cut batches short.
            const std::uint64_t first = begin / batch * batch;
            const std::uint64_t last = std::min(end, first + batch);
            for (std::uint32_t replicate = 0; replicate < options_.replicates; ++replicate) {
                if (bundle->count + (last - begin) > Bundle::capacity) trace(*bundle, out);
                add_batch(sampler, sequences[replicate], first, begin - first, last - first, replicate, *bundle);
            }
            begin = last;
        }
        trace(*bundle, out);
    }

    [[nodiscard]] std::uint32_t replicate_count() const override { return options_.replicates; }

    [[nodiscard]] Key identity() const override {
        return KeyBuilder("ray estimator 3")
            .text(tracer_identity())
            .integer(static_cast<std::int64_t>(options_.seed))
            .integer(options_.replicates)
            .finish();
    }

  private:
    /// Adds rays [begin, end) of the batch that starts at point `first` of the sequence.
    void add_batch(const SurfaceSampler& sampler, const SobolSequence& sequence, std::uint64_t first, std::size_t begin,
                   std::size_t end, std::uint32_t replicate, Bundle& bundle) const {
        Batch b;
        sequence.points(static_cast<std::uint32_t>(first), b.points);
        cosine_directions(b.points[2], b.points[3], b.x.data(), b.y.data(), b.z.data());
        if (const Parallelogram* flat = sampler.flat())
            aim_flat(scene_, *flat, b, begin, end, bundle);
        else
            aim(scene_, sampler, b, begin, end, bundle);
        std::copy(b.points[2].begin() + begin, b.points[2].begin() + end, bundle.u.begin() + bundle.count);
        std::copy(b.points[3].begin() + begin, b.points[3].begin() + end, bundle.v.begin() + bundle.count);
        std::fill_n(bundle.replicate.begin() + bundle.count, end - begin, static_cast<std::uint8_t>(replicate));
        bundle.count += end - begin;
    }

    /// Casts the rays of the bundle and empties it.
    void trace(Bundle& bundle, std::vector<Landings>& out) const {
        const std::size_t count = std::exchange(bundle.count, 0);
        order_by_direction(std::span(bundle.u).first(count), std::span(bundle.v).first(count),
                           std::span(bundle.order).first(count));
        const RayCoherence coherence = count >= packet_rays ? RayCoherence::together : RayCoherence::apart;
        RayColumns rays;
        std::array<TraceHit, RayColumns::capacity> hits;
        std::array<SurfaceTexel, RayColumns::capacity> texels;
        for (std::size_t first = 0; first < count; first += RayColumns::capacity) {
            const std::size_t size = std::min(RayColumns::capacity, count - first);
            bundle.columns(first, size, rays);
            tracer_.first_hits(rays, 0, std::span(hits).first(size), coherence);
            // Texels are fetched for all before the first is looked at.
            for (std::size_t k = 0; k < size; ++k) {
                if (hits[k].triangle == none) continue;
                texels[k] = surface_texel(atlas_, patches_, hits[k].triangle, hits[k].b1, hits[k].b2);
                __builtin_prefetch(texels[k].patch);
            }
            for (std::size_t k = 0; k < size; ++k) {
                const Landing at = landing(patches_, hits[k], texels[k]);
                Landings& landings = out[bundle.replicate[bundle.order[first + k]]];
                if (at.end == RayEnd::patch)
                    landings.patches.push_back(at.patch);
                else
                    ++(at.end == RayEnd::open ? landings.open : landings.back);
            }
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
