#include "baker/formfactors/evidence.h"

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <optional>

#include "baker/core/parallel.h"
#include "baker/formfactors/target_sums.h"

namespace luxel {
namespace {

/// Patches whose records share one block, hence one table of targets: neighbours see the same surfaces.
constexpr std::size_t block_patches = 64;
/// Patches of a block that one thread casts in a row. Blocks of a chunk are few: cut finer, none waits long for the
/// last.
constexpr std::size_t share_patches = 8;

/// Rows of more rays are counted at once: a lamp's million landings would fill the memory of a whole chunk.
constexpr std::uint64_t counted_from_rays = 8192;

/// What the rays of some patches met, row after row.
struct CastRows {
    std::vector<EvidenceBlock::Row> rows;  ///< without their counts
    std::vector<PatchNumber> landings;
    std::vector<std::uint32_t> weights;  ///< one per landing, or empty: 1 each
    std::vector<std::size_t> row_end;    ///< in `landings`

    /// `sums`: of all patches, empty; null where landings are kept as they are.
    void add(PatchId patch, std::uint32_t replicate, LevelRange levels, const Landings& found, TargetSums* sums) {
        rows.push_back({patch, static_cast<std::uint8_t>(replicate), levels.first, levels.last, found.open, found.back, 0, 0});
        if (sums) {
            for (std::size_t k = 0; k < found.patches.size(); ++k)
                sums->add(found.patches[k], found.weights.empty() ? 1 : found.weights[k]);
            sums->drain([&](std::uint32_t target, std::uint32_t count) {
                landings.push_back(target);
                weights.push_back(count);
            });
        } else {
            landings.insert(landings.end(), found.patches.begin(), found.patches.end());
            weights.insert(weights.end(), found.weights.begin(), found.weights.end());
        }
        row_end.push_back(landings.size());
    }
};

CastRows cast_rows(const Estimator& estimator, std::span<const PatchId> ids, const LevelPlan& plan, PatchNumber begin, PatchNumber end) {
    CastRows rows;
    std::optional<TargetSums> sums;
    for (PatchNumber patch = begin; patch < end; ++patch)
        if (!plan.levels[patch].empty() && estimator.rays_of(plan.levels[patch]) >= counted_from_rays && !sums) sums.emplace(ids.size());
    std::vector<Landings> landings;
    for (PatchNumber patch = begin; patch < end; ++patch) {
        if (plan.levels[patch].empty()) continue;
        estimator.cast(patch, plan.levels[patch], landings);
        for (std::uint32_t replicate = 0; replicate < landings.size(); ++replicate)
            rows.add(ids[patch], replicate, plan.levels[patch], landings[replicate], sums ? &*sums : nullptr);
    }
    return rows;
}

/// Turns what was met into one evidence block without sorting it: targets are ranked once per block, then counted.
class BlockBuilder {
  public:
    BlockBuilder(std::span<const PatchId> ids, std::span<const CastRows> shares) : ids_(ids), shares_(shares) {}

    EvidenceBlock finish() {
        rank_targets();
        TargetSums sums(block_.targets.size());
        for (const CastRows& share : shares_) {
            std::size_t at = 0;
            for (std::size_t row = 0; row < share.rows.size(); ++row) {
                for (; at < share.row_end[row]; ++at) sums.add(rank_[share.landings[at]], share.weights.empty() ? 1 : share.weights[at]);
                block_.rows.push_back(share.rows[row]);
                block_.rows.back().first = static_cast<std::uint32_t>(block_.counts.size());
                sums.drain([&](std::uint32_t rank, std::uint32_t count) {
                    block_.target_index.push_back(rank);
                    block_.counts.push_back(count);
                });
                block_.rows.back().count = static_cast<std::uint32_t>(block_.counts.size()) - block_.rows.back().first;
            }
        }
        return std::move(block_);
    }

  private:
    void rank_targets() {
        std::vector<std::uint64_t> met((ids_.size() + 63) / 64);
        for (const CastRows& share : shares_)
            for (const PatchNumber target : share.landings) met[target / 64] |= std::uint64_t{1} << (target % 64);
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
    std::span<const CastRows> shares_;
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
    return BlockBuilder(ids, shares).finish();
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
