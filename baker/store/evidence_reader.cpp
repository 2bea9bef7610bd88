#include "baker/store/evidence_reader.h"

#include <algorithm>
#include <bit>

#include "baker/core/parallel.h"

namespace luxel {
namespace {

NumberedEvidence read_block(const BlockFileReader& file, std::size_t index, const IdIndex& ids) {
    NumberedEvidence found;
    found.where = file.name() + ": block " + std::to_string(index);
    found.block = read_evidence_block(file, index);
    found.targets.reserve(found.block.targets.size());
    for (const PatchId id : found.block.targets) found.targets.push_back(ids.find(id, found.where));
    found.patches.reserve(found.block.rows.size());
    for (const EvidenceBlock::Row& row : found.block.rows) found.patches.push_back(ids.find(row.patch_id, found.where));
    return found;
}

}  // namespace

IdIndex::IdIndex(std::span<const PatchId> ids) : entries_(ids.size()) {
    for (std::size_t k = 0; k < ids.size(); ++k) entries_[k] = {ids[k], static_cast<PatchNumber>(k)};
    std::sort(entries_.begin(), entries_.end());
    shift_ = 64 - std::max(1, static_cast<int>(std::bit_width(entries_.size())) - 1);
    begin_.resize(leading(~PatchId{0}) + 2);
    for (const Entry& entry : entries_) ++begin_[leading(entry.id) + 1];
    for (std::size_t k = 1; k < begin_.size(); ++k) begin_[k] += begin_[k - 1];
}

PatchNumber IdIndex::find(PatchId id, const std::string& where) const {
    const auto first = entries_.begin() + begin_[leading(id)], end = entries_.begin() + begin_[leading(id) + 1];
    const auto at = std::lower_bound(first, end, Entry{id, 0});
    if (at == end || at->id != id)
        throw Error(ErrorCode::damaged_store, where, "patch id " + std::to_string(id) + " is not in this scene",
                    "the evidence belongs to another scene; use a fresh bake folder");
    return at->number;
}

void read_evidence(std::span<const EvidenceFile> files, const IdIndex& ids,
                   const std::function<void(const NumberedEvidence& block, std::size_t place)>& body,
                   const ProgressFunction& progress,
                   const std::function<void(const NumberedEvidence& block, std::size_t place)>& prepare) {
    std::vector<NumberedEvidence> found(evidence_batch);
    for (std::size_t f = 0; f < files.size(); ++f) {
        const BlockFileReader file(files[f].path, FileKind::evidence, evidence_version, &files[f].key);
        for (std::size_t begin = 0; begin < file.blocks().size(); begin += evidence_batch) {
            const std::size_t count = std::min(evidence_batch, file.blocks().size() - begin);
            parallel_for(count, 1, [&](std::size_t k) {
                found[k] = read_block(file, begin + k, ids);
                if (prepare) prepare(found[k], k);
            });
            for (std::size_t k = 0; k < count; ++k) body(found[k], k);
        }
        if (progress) progress(f + 1, files.size());
    }
}

}  // namespace luxel
