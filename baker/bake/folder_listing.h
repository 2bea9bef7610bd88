/// What is in a bake folder, by name. Reads no file.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "baker/bake/bake_folder.h"

namespace luxel {

/// One stage result: a file, or a folder of files.
struct StageEntry {
    std::string stage;  ///< "atlas", "evidence", "strips", ...
    Key key;
    std::filesystem::path path;
    std::vector<std::filesystem::path> files;  ///< sorted by number; the path itself if it is a file
    std::vector<std::filesystem::path> foreign;  ///< in the folder, but not named as its files are
    std::vector<std::filesystem::path> temporary;  ///< in the folder, left by a run that was stopped: no part of it
    std::uint64_t bytes = 0;
};

struct FolderListing {
    std::filesystem::path root;
    std::vector<StageEntry> entries;             ///< by stage, then key
    std::vector<std::filesystem::path> foreign;  ///< not named as ours
    std::vector<std::filesystem::path> temporary;  ///< left in the root by runs that were stopped
    std::vector<Key> bakes;                      ///< strip keys of finished matrices, newest first

    /// Null if there is none.
    [[nodiscard]] const StageEntry* find(const std::string& stage, const Key& key) const;
};

/// Throws Error{bad_input}: not there, not a folder, or nothing of a bake in it.
FolderListing list_folder(const std::filesystem::path& root);

/// The bake whose strip key begins with `prefix` (hexadecimal; empty: the newest). Throws Error{bad_input} when there is none
/// or more than one.
Key choose_bake(const FolderListing& listing, const std::string& prefix);

}  // namespace luxel
