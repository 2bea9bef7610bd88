/// How evidence is found. An estimator turns a patch and a range of levels into evidence records; nothing else in the
/// project knows how rays are chosen. One implementation per file.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "baker/patches/patch.h"
#include "formats/bake/evidence_file.h"

namespace luxel {

/// Levels to collect for one patch: rays of every replicate from the first ray of first_level to the last of last_level.
/// first > last: none.
struct LevelRange {
    std::uint8_t first = 0, last = 0;
    [[nodiscard]] bool empty() const { return first > last; }
    bool operator==(const LevelRange&) const = default;
};
constexpr LevelRange no_levels{1, 0};

/// Where the rays of one patch and replicate ended: a list, a patch as often as it was met, in no particular order.
struct Landings {
    std::vector<PatchNumber> patches;
    /// Of fixed-point estimators: what each landing counts for, > 0, one per entry of `patches`. Empty: 1 each.
    std::vector<std::uint32_t> weights;
    std::uint32_t open = 0, back = 0;
    void clear() {
        patches.clear();
        weights.clear();
        open = back = 0;
    }
};

class Estimator {
  public:
    virtual ~Estimator() = default;
    /// Replaces `out` by what the rays of these levels met, one entry per replicate. A pure function of geometry, the patch's
    /// stable id, the options and the levels: never of patch numbers, chunks or threads.
    /// Threads: const and reentrant; the caller has flushed denormals.
    virtual void cast(PatchNumber patch, LevelRange levels, std::vector<Landings>& out) const = 0;
    [[nodiscard]] virtual std::uint32_t replicate_count() const = 0;
    /// Rays that cast() traces for a patch, for progress and reports.
    [[nodiscard]] virtual std::uint64_t rays_of(LevelRange levels) const;
    /// What the records depend on beside geometry and levels: goes into the evidence key.
    [[nodiscard]] virtual Key identity() const = 0;
};

/// Rays that the levels stand for, one replicate.
std::uint64_t ray_count(LevelRange levels);

/// The evidence of one patch as records, one per replicate, in replicate order. `ids`: stable id per patch number.
void collect_records(const Estimator& estimator, std::span<const PatchId> ids, PatchNumber patch, LevelRange levels,
                     std::vector<EvidenceRecord>& out);

}  // namespace luxel
