/// How evidence is found. An estimator turns a patch and a range of levels into evidence records; nothing else in the
/// project knows how rays are chosen. One implementation per file.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "baker/patches/patch.h"
#include "formats/bake/evidence_file.h"

namespace luxel {

/// Levels to collect for one patch: rays of every replicate from the first ray of first_level to the last of last_level.
struct LevelRange {
    std::uint8_t first = 0, last = 0;
};

class Estimator {
  public:
    virtual ~Estimator() = default;
    /// Appends one record per replicate, in replicate order. A pure function of geometry, the patch's stable id, the
    /// options and the levels: never of patch numbers, chunks or threads.
    /// Threads: const and reentrant; the caller has flushed denormals.
    virtual void collect(PatchNumber patch, LevelRange levels, std::vector<EvidenceRecord>& out) const = 0;
    /// Rays that collect() casts for these levels, all replicates together.
    [[nodiscard]] virtual std::uint64_t ray_count(LevelRange levels) const = 0;
    /// What the records depend on beside geometry and levels: goes into the evidence key.
    [[nodiscard]] virtual Key identity() const = 0;
};

}  // namespace luxel
