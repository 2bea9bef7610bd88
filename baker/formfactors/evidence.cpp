#include "baker/formfactors/evidence.h"

#include <algorithm>
#include <array>
#include <bit>
#include <memory>

#include "baker/core/parallel.h"
#include "baker/formfactors/target_sums.h"

namespace luxel {
namespace {

/// Patches whose records share one block, hence one table of targets: neighbours see the same surfaces.
constexpr std::size_t block_patches = 64;
/// Patches of a block that one thread casts in a row. Blocks of a chunk are few: cut finer, none waits long for the
/// last.
constexpr std::size_t share_patches = 8;

/// What the rays of some patches met, row after row.
struct CastRows {
    std::vector<EvidenceBlock::Row> rows;  ///< without their counts
    std::vector<PatchNumber> landings;
    std::vector<std::uint32_t> weights;  ///< one per landing, or empty: one estimator either weighs all or none
    std::vector<std::size_t> row_end;    ///< in `landings`

    void add(PatchId patch, std::uint32_t replicate, LevelRange levels, const Landings& found) {
        rows.push_back(
            {patch, static_cast<std::uint8_t>(replicate), levels.first, levels.last, found.open, found.back, 0, 0});
        landings.insert(landings.end(), found.patches.begin(), found.patches.end());
        weights.insert(weights.end(), found.weights.begin(), found.weights.end());
        row_end.push_back(landings.size());
    }
    void add(const CastRows& more) {
        const std::size_t before = landings.size();
        rows.insert(rows.end(), more.rows.begin(), more.rows.end());
        landings.insert(landings.end(), more.landings.begin(), more.landings.end());
        weights.insert(weights.end(), more.weights.begin(), more.weights.end());
        for (const std::size_t end : more.row_end) row_end.push_back(before + end);
    }
};

CastRows cast_rows(const Estimator& estimator, std::span<const PatchId> ids, const LevelPlan& plan, PatchNumber begin,
                   PatchNumber end) {
    CastRows rows;
    std::vector<Landings> landings;
    for (PatchNumber patch = begin; patch < end; ++patch) {
        if (plan.levels[patch].empty()) continue;
        estimator.cast(patch, plan.levels[patch], landings);
        for (std::uint32_t replicate = 0; replicate < landings.size(); ++replicate)
            rows.add(ids[patch], replicate, plan.levels[patch], landings[replicate]);
    }
    return rows;
}

/// Turns lists of landings into one evidence block without sorting them: targets are ranked once per block, then
/// counted.
class BlockBuilder {
  public:
    BlockBuilder(std::span<const PatchId> ids, CastRows rows) : ids_(ids), cast_(std::move(rows)) {
        block_.rows = std::move(cast_.rows);
    }

    EvidenceBlock finish() {
        rank_targets();
        TargetSums sums(block_.targets.size());
        std::size_t at = 0;
        for (std::size_t row = 0; row < block_.rows.size(); ++row) {
            if (cast_.weights.empty())
                for (; at < cast_.row_end[row]; ++at) sums.add(rank_[cast_.landings[at]], 1);
            else
                for (; at < cast_.row_end[row]; ++at) sums.add(rank_[cast_.landings[at]], cast_.weights[at]);
            block_.rows[row].first = static_cast<std::uint32_t>(block_.counts.size());
            sums.drain([&](std::uint32_t rank, std::uint32_t count) {
                block_.target_index.push_back(rank);
                block_.counts.push_back(count);
            });
            block_.rows[row].count = static_cast<std::uint32_t>(block_.counts.size()) - block_.rows[row].first;
        }
        return std::move(block_);
    }

  private:
    void rank_targets() {
        std::vector<std::uint64_t> met((ids_.size() + 63) / 64);
        for (const PatchNumber target : cast_.landings) met[target / 64] |= std::uint64_t{1} << (target % 64);
        std::vector<std::pair<PatchId, PatchNumber>> targets;
        for (std::size_t at = 0; at < met.size(); ++at)
            for (std::uint64_t word = met[at]; word; word &= word - 1) {
                const auto target =
                    static_cast<PatchNumber>(at * 64 + static_cast<std::size_t>(std::countr_zero(word)));
                targets.emplace_back(ids_[target], target);
            }
        std::sort(targets.begin(), targets.end());
        rank_.reset(new std::uint32_t[ids_.size()]);  // only the entries of targets are ever read
        for (std::size_t rank = 0; rank < targets.size(); ++rank) {
            block_.targets.push_back(targets[rank].first);
            rank_[targets[rank].second] = static_cast<std::uint32_t>(rank);
        }
    }

    std::span<const PatchId> ids_;
    CastRows cast_;
    EvidenceBlock block_;
    std::unique_ptr<std::uint32_t[]> rank_;
};

}  // namespace

std::size_t evidence_block_count(const ChunkLayout& layout, ChunkNumber chunk) {
    return (layout.size(chunk) + block_patches - 1) / block_patches;
}

EvidenceBlock trace_evidence_block(const Estimator& estimator, const ChunkLayout& layout, std::span<const PatchId> ids,
                                   ChunkNumber chunk, std::size_t block, const LevelPlan& plan) {
    const auto begin = static_cast<PatchNumber>(layout.first_patch[chunk] + block * block_patches);
    const PatchNumber end = std::min<PatchNumber>(layout.first_patch[chunk + 1], begin + block_patches);
    std::array<CastRows, block_patches / share_patches> shares;
    // Isolated: who waits for the shares of a block must not begin another block meanwhile.
    parallel_isolated(shares.size(), [&](std::size_t k) {
        const auto first = static_cast<PatchNumber>(std::min<std::size_t>(end, begin + k * share_patches));
        const auto last = static_cast<PatchNumber>(std::min<std::size_t>(end, first + share_patches));
        shares[k] = cast_rows(estimator, ids, plan, first, last);
    });
    CastRows all;
    for (const CastRows& share : shares) all.add(share);
    return BlockBuilder(ids, std::move(all)).finish();
}

void write_chunk_evidence(const Estimator& estimator, const ChunkLayout& layout, std::span<const PatchId> ids,
                          ChunkNumber chunk, const LevelPlan& plan, const std::filesystem::path& path, const Key& key,
                          Publisher& publisher, ProgressCounter* progress) {
    const PatchNumber first = layout.first_patch[chunk], end = layout.first_patch[chunk + 1];
    const std::size_t block_count = evidence_block_count(layout, chunk);
    std::vector<BlockFileWriter::Packed> blocks(block_count);
    std::vector<std::uint64_t> first_record(block_count + 1);
    parallel_for(block_count, 1, [&](std::size_t block) {
        const EvidenceBlock evidence = trace_evidence_block(estimator, layout, ids, chunk, block, plan);
        first_record[block + 1] = evidence.rows.size();
        blocks[block] = BlockFileWriter::pack(encode_evidence(evidence), 1);
        const auto begin = static_cast<PatchNumber>(first + block * block_patches);
        if (progress)
            progress->add(planned_rays(plan, estimator, begin, std::min<PatchNumber>(end, begin + block_patches)));
    });
    BlockFileWriter file(path, FileKind::evidence, evidence_version, key);
    std::uint64_t record = 0;
    for (std::size_t block = 0; block < block_count; ++block) {
        record += first_record[block];
        file.append_packed(record, blocks[block]);
    }
    file.publish(publisher);
}

}  // namespace luxel
