/// Runs an estimator over the patches of a chunk and publishes what it found as one evidence file.
#pragma once
#include <filesystem>

#include "baker/core/progress.h"
#include "baker/formfactors/block_source.h"
#include "baker/formfactors/estimator.h"

namespace luxel {

/// Which levels every patch gets: a stage result of its own, so that rounds can be added.
struct LevelPlan {
    std::vector<LevelRange> levels;  ///< per patch number
};

/// The plan with the same levels for all patches: at least `rays` rays each, replicates * 2^k.
LevelPlan uniform_plan(std::size_t patch_count, std::uint32_t replicates, std::uint64_t rays);

/// Rays of a whole plan, or of one chunk's part of it.
std::uint64_t planned_rays(const LevelPlan& plan, std::uint32_t replicates, PatchNumber begin, PatchNumber end);

/// Writes the evidence of chunk `chunk`'s own rays to `path`. `ids`: stable id per patch number.
/// Threads: uses them all; the bytes do not depend on their number. Errors: cannot_write.
void write_chunk_evidence(const Estimator& estimator, const ChunkLayout& layout, std::span<const PatchId> ids,
                          ChunkNumber chunk, const LevelPlan& plan, const std::filesystem::path& path, const Key& key,
                          ProgressCounter* progress);

}  // namespace luxel
