/// Evidence files read from end to end, by patch number instead of stable id.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "baker/core/progress.h"
#include "baker/patches/patch.h"
#include "formats/bake/evidence_file.h"

namespace luxel {

/// Stable ids to this bake's numbers: a sorted table, searched by halving among the ids with the same leading bits; ids are hashes, so
/// those are few. Memory: 20 bytes per patch. Threads: reentrant.
class IdIndex {
  public:
    explicit IdIndex(std::span<const PatchId> ids);
    /// Throws Error{damaged_store} naming `where` for an id that is not in the table.
    [[nodiscard]] PatchNumber find(PatchId id, const std::string& where) const;

  private:
    struct Entry {
        PatchId id;
        PatchNumber number;
        bool operator<(const Entry& o) const { return id < o.id; }
    };
    [[nodiscard]] std::size_t leading(PatchId id) const { return static_cast<std::size_t>(id >> shift_); }
    std::vector<Entry> entries_;
    int shift_ = 63;                    ///< of the leading bits
    std::vector<std::uint32_t> begin_;  ///< first entry for each value of the leading bits, and the end
};

struct NumberedEvidence {
    EvidenceBlock block;
    std::vector<PatchNumber> targets;  ///< number of each of the block's targets
    std::vector<PatchNumber> patches;  ///< number of each row's patch
    std::string where;                 ///< file and block, for messages
};

/// Calls body(block) for every block of every file, in order, one at a time; blocks are decoded in parallel ahead of it.
/// `prepare`, if given, is called in parallel with the block's place in its batch (0 to evidence_batch - 1) before.
/// Memory: evidence_batch decoded blocks. Throws Error{damaged_store}: missing or damaged file, other key, unknown id.
constexpr std::size_t evidence_batch = 16;
void read_evidence(std::span<const EvidenceFile> files, const IdIndex& ids,
                   const std::function<void(const NumberedEvidence& block, std::size_t place)>& body,
                   const ProgressFunction& progress = {},
                   const std::function<void(const NumberedEvidence& block, std::size_t place)>& prepare = {});

}  // namespace luxel
