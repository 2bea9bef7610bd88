/// Strips against the evidence that they were pooled from, by another way than pooling: counts of as many strips as fit
/// into memory are loaded, everything that the evidence says of them is taken away again, and nothing may be left.
#pragma once
#include <span>
#include <vector>

#include "baker/store/evidence_reader.h"
#include "baker/store/strip_store.h"

namespace luxel {

/// One thing that is wrong. `where`: file, block, as far as known.
struct Finding {
    std::string where, what;
};

struct RecountOptions {
    std::uint64_t memory_bytes = std::uint64_t{256} << 20;  ///< counts held at once; one block at least
    std::size_t most_findings = 20;                         ///< then stop
};

/// Compares tallies (N_i, self, open, back) and every c_ij. Reads the
/// evidence once for every part of the strips that fits into memory. `strip_folder` only names files in findings.
/// Memory: options.memory_bytes, 30 bytes per patch. Threads: uses them all. Throws Error{damaged_store} when a file cannot be read
/// at all: check files one by one before.
std::vector<Finding> recount(const StripStore& strips, const std::filesystem::path& strip_folder, std::span<const PatchId> ids,
                             std::span<const EvidenceFile> files, const RecountOptions& options = {},
                             const ProgressFunction& progress = {});

}  // namespace luxel
