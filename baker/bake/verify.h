/// Everything that can be checked in a bake folder. Findings are collected, not thrown: one line each.
#pragma once
#include <functional>

#include "baker/bake/inspect.h"
#include "baker/store/flux_check.h"
#include "baker/store/recount.h"

namespace luxel {

struct VerifyOptions {
    std::uint64_t memory_bytes = std::uint64_t{256} << 20;  ///< of the recount
    std::size_t most_findings = 100;
    FluxOptions flux;
    /// (what, done, total, unit); one call at a time.
    std::function<void(const char* what, std::uint64_t done, std::uint64_t total, const char* unit)> progress;
};

struct Verification {
    std::uint64_t files = 0, blocks = 0, bytes = 0;  ///< read
    std::vector<Finding> findings;
    bool recounted = false;         ///< strips were compared with the evidence
    double row_error = 0;           ///< of the closed rows, relative
    bool flux_checked = false;
    FluxCheck flux;
    std::string not_checked;        ///< what was left out and why; empty: nothing
    [[nodiscard]] bool passed() const { return findings.empty(); }
};

/// 1. Every block of every file in the folder: checksum, and all that its format demands.
/// 2. Of the bake with strip key `strips`: no file is missing or too many; tallies and every count equal the evidence;
///    rows with closure, diagonal and open share are exact; the flux self-check. Of a bake with --store hot or none: what is kept
///    agrees with the directory.
/// What cannot be read any more is not compared: the second part needs a first one without findings about its files.
Verification verify_bake(const FolderListing& listing, const Key& strips, const VerifyOptions& options = {});

/// The first part alone, for a folder without a finished matrix.
Verification verify_files(const FolderListing& listing, const VerifyOptions& options = {});

}  // namespace luxel
