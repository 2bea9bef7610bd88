/// Which levels of which patch and replicate have been counted: the same rays must never be counted twice.
/// Memory: 4 bytes per patch and replicate that occurs. Threads: one at a time.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "baker/patches/patch.h"
#include "formats/bake/evidence_file.h"
#include "formats/base/error.h"

namespace luxel {

class LevelLedger {
  public:
    explicit LevelLedger(std::size_t patches) : patches_(patches) {}

    /// Enters a record. Throws Error{damaged_store} naming `where` when one of its levels has been entered before.
    void enter(PatchNumber patch, const EvidenceBlock::Row& row, const std::string& where) {
        if (row.replicate >= levels_.size()) levels_.resize(row.replicate + std::size_t{1});
        auto& seen = levels_[row.replicate];
        if (seen.empty()) seen.resize(patches_);
        const std::uint32_t up_to_last = row.last_level >= 31 ? ~0u : (2u << row.last_level) - 1;
        const std::uint32_t levels = up_to_last & ~((1u << row.first_level) - 1);
        if (seen[patch] & levels)
            throw Error(ErrorCode::damaged_store, where,
                        "evidence of patch id " + std::to_string(row.patch_id) + ", replicate " + std::to_string(row.replicate) +
                            ", levels " + std::to_string(row.first_level) + " to " + std::to_string(row.last_level) +
                            " is there a second time",
                        "remove the file and run the same bake again");
        seen[patch] |= levels;
    }

  private:
    std::size_t patches_;
    std::vector<std::vector<std::uint32_t>> levels_;  ///< per replicate and patch: one bit per level
};

}  // namespace luxel
