#include "baker/formfactors/ray_estimator.h"

#include <algorithm>
#include <utility>

#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/formfactors/direction_order.h"
#include "baker/formfactors/ray_starts.h"
#include "baker/patches/patch_sampler.h"
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

    [[nodiscard]] RayArrays rays() {
        return {origin_x, origin_y, origin_z, direction_x, direction_y, direction_z, from_triangle};
    }

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

class RayEstimator final : public Estimator {
  public:
    RayEstimator(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer,
                 const RayEstimatorOptions& options)
        : scene_(scene), atlas_(atlas), patches_(patches), tracer_(tracer), options_(options) {}

    void cast(PatchNumber patch, LevelRange levels, std::vector<Landings>& out) const override {
        out.resize(options_.replicates);
        for (Landings& landings : out) landings.clear();
        const PatchSampler sampler(scene_, atlas_, patches_, patch);
        const RayStarts starts(scene_, sampler);
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
                add_batch(starts, sequences[replicate], first, begin - first, last - first, replicate, *bundle);
            }
            begin = last;
        }
        trace(*bundle, out);
    }

    [[nodiscard]] std::uint32_t replicate_count() const override { return options_.replicates; }

    [[nodiscard]] Key identity() const override {
        return KeyBuilder("ray estimator 6")
            .text(tracer_identity())
            .integer(static_cast<std::int64_t>(options_.seed))
            .integer(options_.replicates)
            .finish();
    }

  private:
    /// Adds rays [begin, end) of the batch that starts at point `first` of the sequence.
    void add_batch(const RayStarts& starts, const SobolSequence& sequence, std::uint64_t first, std::size_t begin,
                   std::size_t end, std::uint32_t replicate, Bundle& bundle) const {
        StartBatch b;
        sequence.points(static_cast<std::uint32_t>(first), b.points);
        cosine_directions(b.points[2], b.points[3], b.x.data(), b.y.data(), b.z.data());
        starts.aim(b, begin, end, bundle.rays(), bundle.count);
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
        const bool is_tinted = tracer_.is_see_through();
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
                Landing at = landing(patches_, hits[k], texels[k]);
                if (is_tinted && !survives_tint(rays.at(k), hits[k].tint)) at.end = RayEnd::back;
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
