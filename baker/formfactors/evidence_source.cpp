#include "baker/formfactors/evidence_source.h"

#include <algorithm>

#include "baker/core/parallel.h"
#include "baker/formfactors/evidence.h"

namespace luxel {

void EvidenceFiles::visit(const Visitor& body) const {
    for (const EvidenceFile& entry : files_) {
        const BlockFileReader file(entry.path, FileKind::evidence, evidence_version, &entry.key);
        for (std::size_t k = 0; k < file.blocks().size(); ++k) {
            const std::string where = file.name() + ": block " + std::to_string(k);
            body(read_evidence_block(file, k), where);
        }
    }
}

void TracedEvidence::visit(const Visitor& body) const {
    constexpr std::size_t batch = 16;
    std::vector<EvidenceBlock> found(batch);
    for (std::size_t round = 0; round < rounds_.size(); ++round)
        for (ChunkNumber chunk = 0; chunk < layout_.chunk_count(); ++chunk) {
            const std::size_t count = evidence_block_count(layout_, chunk);
            for (std::size_t first = 0; first < count; first += batch) {
                const std::size_t end = std::min(count, first + batch);
                parallel_for(end - first, 1, [&](std::size_t k) {
                    found[k] = trace_evidence_block(estimator_, layout_, ids_, chunk, first + k, rounds_[round]);
                });
                for (std::size_t k = first; k < end; ++k)
                    body(found[k - first], "rays of chunk " + std::to_string(chunk) + ", round " + std::to_string(round + 1));
            }
        }
}

}  // namespace luxel
