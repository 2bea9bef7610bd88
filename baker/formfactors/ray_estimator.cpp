#include "baker/formfactors/ray_estimator.h"

#include <algorithm>

#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/formfactors/surface_map.h"
#include "baker/patches/patch_sampler.h"
#include "baker/trace/ray_offset.h"

namespace luxel {
namespace {

constexpr std::size_t batch_rays = 64;

class RayEstimator final : public Estimator {
  public:
    RayEstimator(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer,
                 const RayEstimatorOptions& options)
        : scene_(scene), atlas_(atlas), patches_(patches), tracer_(tracer), options_(options) {}

    void collect(PatchNumber patch, LevelRange levels, std::vector<EvidenceRecord>& out) const override {
        const PatchSampler sampler(scene_, atlas_, patches_, patch);
        std::vector<PatchId> targets;
        for (std::uint32_t replicate = 0; replicate < options_.replicates; ++replicate) {
            EvidenceRecord record;
            record.patch_id = patches_.patches[patch].id;
            record.replicate = static_cast<std::uint8_t>(replicate);
            record.first_level = levels.first;
            record.last_level = levels.last;
            targets.clear();
            trace(sampler, record, targets);
            count(targets, record);
            out.push_back(std::move(record));
        }
    }

    [[nodiscard]] std::uint64_t ray_count(LevelRange levels) const override {
        EvidenceRecord shape;
        shape.first_level = levels.first, shape.last_level = levels.last;
        return shape.ray_count() * options_.replicates;
    }

    [[nodiscard]] Key identity() const override {
        return KeyBuilder("ray estimator 1")
            .text(tracer_identity())
            .integer(static_cast<std::int64_t>(options_.seed))
            .integer(options_.replicates)
            .finish();
    }

  private:
    /// Casts the record's rays; appends the id of each patch met, tallies the rest.
    void trace(const PatchSampler& sampler, EvidenceRecord& record, std::vector<PatchId>& targets) const {
        const SobolSequence sequence(mix(mix(record.patch_id, options_.seed), record.replicate));
        const std::uint64_t end = std::uint64_t{1} << record.last_level;
        std::array<TraceRay, batch_rays> rays;
        std::array<TraceHit, batch_rays> hits;
        for (std::uint64_t begin = end - record.ray_count(); begin < end; begin += batch_rays) {
            const std::size_t count = std::min<std::uint64_t>(batch_rays, end - begin);
            for (std::size_t k = 0; k < count; ++k) {
                const auto u = sequence.point(static_cast<std::uint32_t>(begin + k));
                const SurfacePoint start = sampler.point(u[0], u[1]);
                rays[k] = {offset_origin(start.position, start.normal),
                           Frame(start.normal).to_world(cosine_direction(u[2], u[3])), start.triangle};
            }
            tracer_.first_hits({rays.data(), count}, {hits.data(), count});
            for (std::size_t k = 0; k < count; ++k) {
                const Landing at = landing(scene_, atlas_, patches_, hits[k]);
                if (at.end == RayEnd::patch)
                    targets.push_back(patches_.patches[at.patch].id);
                else
                    ++(at.end == RayEnd::open ? record.open : record.back);
            }
        }
    }

    static void count(std::vector<PatchId>& targets, EvidenceRecord& record) {
        std::sort(targets.begin(), targets.end());
        for (const PatchId id : targets) {
            if (record.target_id.empty() || record.target_id.back() != id) {
                record.target_id.push_back(id);
                record.count.push_back(0);
            }
            ++record.count.back();
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
