/// Runs an estimator over the patches of a chunk and publishes what it found as one evidence file.
#pragma once
#include <filesystem>

#include "baker/core/progress.h"
#include "baker/formfactors/block_source.h"
#include "baker/formfactors/estimator.h"
#include "baker/formfactors/level_plan.h"

namespace luxel {

/// Evidence blocks of a chunk, and one of them: what the rays of some neighbouring patches met, one row per patch and replicate,
/// in order. Pure. Threads: reentrant.
std::size_t evidence_block_count(const ChunkLayout& layout, ChunkNumber chunk);
EvidenceBlock trace_evidence_block(const Estimator& estimator, const ChunkLayout& layout, std::span<const PatchId> ids,
                                   ChunkNumber chunk, std::size_t block, const LevelPlan& plan);

/// Writes the evidence of chunk `chunk`'s own rays to `path`. `ids`: stable id per patch number.
/// Threads: uses them all; the bytes do not depend on their number. Errors: cannot_write.
/// The file is there when `publisher` has finished. `progress` may be null.
void write_chunk_evidence(const Estimator& estimator, const ChunkLayout& layout, std::span<const PatchId> ids,
                          ChunkNumber chunk, const LevelPlan& plan, const std::filesystem::path& path, const Key& key,
                          Publisher& publisher, ProgressCounter* progress);

}  // namespace luxel
