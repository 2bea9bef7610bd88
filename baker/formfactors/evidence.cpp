#include "baker/formfactors/evidence.h"

#include <algorithm>

#include "baker/core/parallel.h"

namespace luxel {
namespace {

/// Patches whose records share one block, hence one table of targets: neighbours see the same surfaces.
constexpr std::size_t block_patches = 64;

}  // namespace

LevelPlan uniform_plan(std::size_t patch_count, std::uint32_t replicates, std::uint64_t rays) {
    std::uint8_t last = 0;
    while (last < 31 && (std::uint64_t{replicates} << last) < rays) ++last;
    return {std::vector<LevelRange>(patch_count, LevelRange{0, last})};
}

std::uint64_t write_chunk_evidence(const Estimator& estimator, const ChunkLayout& layout, ChunkNumber chunk,
                                   const LevelPlan& plan, const std::filesystem::path& path, const Key& key,
                                   ProgressCounter* progress) {
    const PatchNumber first = layout.first_patch[chunk], end = layout.first_patch[chunk + 1];
    const std::size_t block_count = (end - first + block_patches - 1) / block_patches;
    std::vector<BlockFileWriter::Packed> blocks(block_count);
    std::vector<std::uint64_t> rays(block_count), records_before(block_count + 1);
    parallel_for(block_count, 1, [&](std::size_t block) {
        std::vector<EvidenceRecord> records;
        const auto begin = static_cast<PatchNumber>(first + block * block_patches);
        for (PatchNumber patch = begin; patch < std::min<PatchNumber>(end, begin + block_patches); ++patch) {
            estimator.collect(patch, plan.levels[patch], records);
            rays[block] += estimator.ray_count(plan.levels[patch]);
        }
        records_before[block + 1] = records.size();
        blocks[block] = BlockFileWriter::pack(encode_evidence(records), 1);
        if (progress) progress->add(rays[block]);
    });
    BlockFileWriter file(path, FileKind::evidence, evidence_version, key);
    std::uint64_t total = 0, record = 0;
    for (std::size_t block = 0; block < block_count; ++block) {
        record += records_before[block];
        file.append_packed(record, blocks[block]);
        total += rays[block];
    }
    file.publish();
    return total;
}

}  // namespace luxel
