/// What a bake folder must know of its patches so that its files can be read without the scene: ids, areas, chunks, and
/// which evidence and closure belong to the strips. patches_file.md.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/base/block_file.h"

namespace luxel {

constexpr std::uint32_t patches_version = 1;

/// One matrix. The file's own key is that of the strips.
struct PatchesFile {
    std::vector<std::uint64_t> ids;          ///< stable id per patch number, distinct
    std::vector<double> area_m2;             ///< per patch number, > 0
    std::vector<std::uint32_t> first_patch;  ///< chunk c holds patches [first_patch[c], first_patch[c + 1]); starts with 0
    std::vector<Key> evidence;               ///< one per round, in order
    Key closure;
    std::string estimator;  ///< "ray", "hemicube", ...
    bool operator==(const PatchesFile&) const = default;
};

/// Publishes; throws Error{cannot_write}.
void save_patches(const std::filesystem::path& path, const Key& strips, const PatchesFile& patches);

/// Validates everything. Throws Error{damaged_store}: missing, damaged, made for other strips, sizes that do not agree, areas
/// that are not positive and finite, chunks out of order or larger than 65536, an id that occurs twice.
PatchesFile load_patches(const std::filesystem::path& path, const Key& strips);

}  // namespace luxel
