/// Evidence as a reader of all of it meets it, block by block, whether it is on disk or traced for the occasion.
#pragma once
#include <functional>
#include <span>
#include <string>

#include "baker/formfactors/block_source.h"
#include "baker/formfactors/level_plan.h"
#include "formats/bake/evidence_file.h"

namespace luxel {

class EvidenceSource {
  public:
    using Visitor = std::function<void(const EvidenceBlock& block, const std::string& where)>;
    virtual ~EvidenceSource() = default;
    /// Calls body(block, where) for every block, by round, chunk and place in the chunk, one at a time. `where` names the block in
    /// messages. The same blocks in the same order from every source. Throws Error{damaged_store}.
    virtual void visit(const Visitor& body) const = 0;
};

/// Files, in the given order. The files are named by reference.
class EvidenceFiles final : public EvidenceSource {
  public:
    explicit EvidenceFiles(std::span<const EvidenceFile> files) : files_(files) {}
    void visit(const Visitor& body) const override;

  private:
    std::span<const EvidenceFile> files_;
};

/// Every ray is traced again. References must outlive it. Memory: a few blocks of 64 patches. Threads: uses them all.
class TracedEvidence final : public EvidenceSource {
  public:
    /// `ids`: stable id per patch number. `rounds`: one plan per round.
    TracedEvidence(const Estimator& estimator, const ChunkLayout& layout, std::span<const PatchId> ids,
                   std::span<const LevelPlan> rounds)
        : estimator_(estimator), layout_(layout), ids_(ids), rounds_(rounds) {}
    void visit(const Visitor& body) const override;

  private:
    const Estimator& estimator_;
    const ChunkLayout& layout_;
    std::span<const PatchId> ids_;
    std::span<const LevelPlan> rounds_;
};

}  // namespace luxel
