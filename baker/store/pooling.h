/// Evidence to strips: adds up what i saw of j and j of i. An external transpose: evidence is read once in order, pairs
/// are dealt into a bucket per strip (in memory, else in one scratch file), then each bucket is sorted and summed.
/// Only additions of integers: the result does not depend on order, threads, memory or the way evidence was cut.
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "baker/core/progress.h"
#include "baker/formfactors/block_source.h"
#include "formats/bake/evidence_file.h"
#include "formats/base/hash.h"

namespace luxel {

struct PoolOptions {
    std::uint64_t memory_bytes = std::uint64_t{256} << 20;  ///< buckets and sorting together; at least 8 MiB are used
    std::filesystem::path scratch_folder;                   ///< for the scratch file, removed at the end whatever happens
};

/// File of strip `a` in a folder of strips.
std::filesystem::path strip_path(const std::filesystem::path& folder, ChunkNumber a);

/// Reads all evidence files (any cut, any order; all rounds) and publishes one strip file per chunk; returns false at once
/// when all of them are there already. `ids`: stable id per patch number. Throws Error{damaged_store} for damaged evidence, ids that are
/// not in this scene and levels of a patch and replicate that are there twice, Error{cannot_write}.
bool pool_evidence(const ChunkLayout& layout, std::span<const PatchId> ids,
                   std::span<const EvidenceFile> evidence_files, const std::filesystem::path& strip_folder, const Key& strip_key,
                   const PoolOptions& options, const ProgressFunction& progress);

}  // namespace luxel
