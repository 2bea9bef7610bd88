/// What is known of a matrix whose blocks are not all on the disk: which blocks there are, how large their strips would be,
/// and the tallies of the patches. What is missing is traced again when it is needed. directory_file.md.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "formats/bake/ray_tallies.h"

namespace luxel {

constexpr std::uint32_t directory_version = 1;

struct DirectoryBlock {
    std::uint32_t a = 0, b = 0;      ///< chunks, a <= b
    std::uint64_t pair_count = 0;    ///< > 0
    std::uint64_t stored_bytes = 0;  ///< of the pair block in a strip file, without trailer; > 0
    bool operator==(const DirectoryBlock&) const = default;
};

struct StripDirectory {
    RayTallies tallies;                ///< per patch of all chunks
    std::vector<DirectoryBlock> blocks;  ///< ascending by (a, b)
    std::uint64_t hot_bytes = 0;         ///< budget that the kept blocks were chosen for; 0: none are kept
};

/// Publishes; `strips`: key of the strips that the directory stands for. Throws Error{cannot_write}.
void save_directory(const std::filesystem::path& path, const Key& strips, const StripDirectory& directory);

/// Empty if the file is absent. Throws Error{damaged_store} for damage, other strips, blocks out of order, columns of different
/// lengths, more rays ended than sent.
std::optional<StripDirectory> load_directory(const std::filesystem::path& path, const Key& strips);

}  // namespace luxel
