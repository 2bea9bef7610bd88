/// Evidence round by round: who has sent how many rays, and the files where they landed.
#pragma once
#include "baker/bake/bake_folder.h"
#include "baker/bake/geometry_stages.h"
#include "baker/formfactors/evidence_source.h"

namespace luxel {

class EvidenceRounds {
  public:
    /// References must outlive it.
    EvidenceRounds(const BakeOptions& options, const BakedGeometry& geometry, const BakeFolder& folder);
    ~EvidenceRounds();
    EvidenceRounds(const EvidenceRounds&) = delete;
    EvidenceRounds& operator=(const EvidenceRounds&) = delete;

    /// Traces what the bake folder does not have yet of one more round. Stage "evidence". Where not all is stored, it only takes
    /// note of the plan. False: it was asked to stop before the round was done, which then is no part of this; what was traced
    /// of it stays in the bake folder.
    bool add(const LevelPlan& plan, StageClock& clock, BakeReport& report);

    /// Of everything traced so far: names what is pooled from it.
    [[nodiscard]] const Key& key() const { return key_; }
    [[nodiscard]] std::span<const EvidenceFile> files() const { return files_; }  ///< none where not all is stored
    [[nodiscard]] std::span<const Key> round_keys() const { return round_keys_; }
    /// Everything traced so far, read or traced again. Refers to this object.
    [[nodiscard]] std::unique_ptr<EvidenceSource> source() const;
    /// Levels of all rounds together, and who traces them.
    [[nodiscard]] LevelPlan all_levels() const;
    [[nodiscard]] std::shared_ptr<const Estimator> estimator() const { return estimator_; }
    [[nodiscard]] std::span<const PatchId> ids() const { return ids_; }
    [[nodiscard]] std::span<const std::uint8_t> reached() const { return reached_; }  ///< last level per patch
    [[nodiscard]] std::uint32_t rounds() const { return rounds_; }
    [[nodiscard]] std::uint64_t total_rays() const { return total_rays_; }
    [[nodiscard]] std::uint32_t replicates() const;
    /// Rays of a patch that has reached this level.
    [[nodiscard]] std::uint64_t rays_at(std::uint8_t level) const;
    /// Whether the estimator can be asked for more of the same patch.
    [[nodiscard]] bool extensible() const;
    /// Names the plan of round `round`: geometry, estimator and the wish for rays, but no light, so that a bake under
    /// other light finds the rays that are there.
    [[nodiscard]] Key plan_key(std::uint32_t round) const;

  private:
    bool write(const LevelPlan& plan, const Key& key, StageClock& clock, BakeReport& report);

    const BakeOptions& options_;
    const BakedGeometry& geometry_;
    const BakeFolder& folder_;
    std::shared_ptr<const Estimator> estimator_;
    std::vector<PatchId> ids_;
    std::vector<std::uint8_t> reached_;
    std::vector<LevelPlan> plans_;  ///< per round, where not all is stored
    std::vector<EvidenceFile> files_;
    std::vector<Key> round_keys_;
    Key key_;
    std::uint32_t rounds_ = 0;
    std::uint64_t total_rays_ = 0;
};

}  // namespace luxel
