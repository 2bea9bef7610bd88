/// Runs an estimator over the patches of a chunk and publishes what it found as one evidence file.
#pragma once
#include <filesystem>

#include "baker/core/progress.h"
#include "baker/formfactors/block_source.h"
#include "baker/formfactors/estimator.h"
#include "baker/formfactors/level_plan.h"

namespace luxel {

/// Writes the evidence of chunk `chunk`'s own rays to `path`. `ids`: stable id per patch number.
/// Threads: uses them all; the bytes do not depend on their number. Errors: cannot_write.
void write_chunk_evidence(const Estimator& estimator, const ChunkLayout& layout, std::span<const PatchId> ids,
                          ChunkNumber chunk, const LevelPlan& plan, const std::filesystem::path& path, const Key& key,
                          ProgressCounter* progress);

}  // namespace luxel
