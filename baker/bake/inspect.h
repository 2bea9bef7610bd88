/// What a bake folder holds, read through the readers of the bake itself; the scene is not needed.
#pragma once
#include "baker/bake/folder_listing.h"
#include "baker/core/progress.h"
#include "baker/formfactors/closure.h"
#include "baker/store/strip_store.h"
#include "formats/bake/directory_file.h"
#include "formats/bake/evidence_file.h"
#include "formats/bake/patches_file.h"

namespace luxel {

/// The files of one matrix, opened. Throws Error{damaged_store} for anything missing or damaged.
struct StoredMatrix {
    Key key;  ///< of the strips
    PatchesFile patches;
    ChunkLayout layout;
    std::filesystem::path strip_folder;
    std::unique_ptr<StripStore> strips;       ///< all blocks; with a directory: those that are kept, null if none are
    std::optional<StripDirectory> directory;  ///< of a matrix whose blocks are not all kept (--store hot and none)
    Closure closure;
    std::vector<EvidenceFile> evidence;  ///< all rounds; none with a directory

    StoredMatrix(const FolderListing& listing, const Key& key);
    [[nodiscard]] bool is_whole() const { return !directory; }
    [[nodiscard]] const RayTallies& tallies() const { return directory ? directory->tallies : strips->tallies(); }
};

/// The directory of a matrix whose blocks are not all kept; null for one that is there whole.
const StageEntry* directory_of(const FolderListing& listing, const Key& strips);

struct StoredRound {
    Key key;
    std::uint64_t files = 0, bytes = 0;
};

struct StoredRow {
    PatchNumber patch = 0;
    PatchId id = 0;
    ChunkNumber chunk = 0;
    std::uint64_t pairs = 0;  ///< patches that it exchanges light with
    double area_m2 = 0;
};

struct MatrixInspection {
    Key key;
    std::string estimator;
    std::uint64_t patches = 0, chunks = 0, smallest_chunk = 0, largest_chunk = 0;
    double area_m2 = 0;
    std::string store;  ///< all, hot or none
    std::uint64_t blocks = 0, pairs = 0, strip_bytes = 0;  ///< of the matrix; bytes on disk
    std::uint64_t kept_blocks = 0, kept_pairs = 0;         ///< of those, what need not be traced again
    std::uint64_t all_bytes = 0;                           ///< of the blocks if all were kept, without tallies
    std::uint64_t possible_pairs = 0;  ///< patches * (patches - 1) / 2
    std::vector<StoredRound> rounds;
    std::uint64_t rays = 0, least_rays = 0, most_rays = 0;  ///< all rounds; of one patch
    /// The rest needs all blocks.
    /// Form factors of a row added up: the share of the patch's hemisphere that ends on surfaces.
    double least_row = 0, mean_row = 0, most_row = 0;
    double row_error = 0;  ///< largest |sum of the stored row - area| / area, open share included
    ClosureReport closure;
    double pairs_per_patch = 0;
    std::vector<StoredRow> largest_rows;  ///< most pairs first

    [[nodiscard]] bool is_whole() const { return store == "all"; }
    [[nodiscard]] double bytes_per_pair() const { return pairs ? static_cast<double>(strip_bytes) / static_cast<double>(pairs) : 0; }
    [[nodiscard]] double density() const {
        return possible_pairs ? static_cast<double>(pairs) / static_cast<double>(possible_pairs) : 0;
    }
};

/// Reads every strip once; of a matrix that is not whole nothing but its directory. Memory: 12 doubles per patch, one block per thread.
MatrixInspection inspect_matrix(const FolderListing& listing, const StoredMatrix& matrix, std::size_t largest_rows,
                                const ProgressFunction& progress = {});

}  // namespace luxel
