#include "formats/bake/patches_file.h"

#include <algorithm>
#include <cmath>

namespace luxel {
namespace {

constexpr std::size_t block_count = 6;
constexpr std::uint32_t max_chunk_patches = 65536;

[[noreturn]] void damaged(const BlockFileReader& file, const std::string& what) {
    throw Error(ErrorCode::damaged_store, file.name(), what, "remove the file and run the same bake again");
}

void check_chunks(const BlockFileReader& file, const std::vector<std::uint32_t>& first, std::size_t patches) {
    if (first.empty() || first.front() != 0 || first.back() != patches)
        damaged(file, "chunks do not begin at patch 0 and end at patch " + std::to_string(patches));
    for (std::size_t c = 1; c < first.size(); ++c)
        if (first[c] < first[c - 1] || first[c] - first[c - 1] > max_chunk_patches)
            damaged(file, "chunk " + std::to_string(c - 1) + " is out of order or holds more than 65536 patches");
}

}  // namespace

void save_patches(const std::filesystem::path& path, const Key& strips, const PatchesFile& patches) {
    std::vector<std::uint64_t> rounds;
    for (const Key& key : patches.evidence) rounds.push_back(key.low), rounds.push_back(key.high);
    const std::vector<std::uint64_t> closure{patches.closure.low, patches.closure.high};
    BlockFileWriter file(path, FileKind::patches, patches_version, strips);
    append_column<std::uint64_t>(file, 0, patches.ids);
    append_column<double>(file, 1, patches.area_m2);
    append_column<std::uint32_t>(file, 2, patches.first_patch);
    append_column<std::uint64_t>(file, 3, rounds);
    append_column<std::uint64_t>(file, 4, closure);
    file.append(5, {reinterpret_cast<const std::uint8_t*>(patches.estimator.data()), patches.estimator.size()}, 0);
    file.publish();
}

PatchesFile load_patches(const std::filesystem::path& path, const Key& strips) {
    const BlockFileReader file(path, FileKind::patches, patches_version, &strips);
    require_numbered_blocks(file, block_count);
    PatchesFile patches;
    patches.ids = read_column<std::uint64_t>(file, 0);
    patches.area_m2 = read_column<double>(file, 1);
    patches.first_patch = read_column<std::uint32_t>(file, 2);
    const auto rounds = read_column<std::uint64_t>(file, 3), closure = read_column<std::uint64_t>(file, 4);
    if (patches.area_m2.size() != patches.ids.size()) damaged(file, "not as many areas as patches");
    for (std::size_t p = 0; p < patches.area_m2.size(); ++p)
        if (!(patches.area_m2[p] > 0) || !std::isfinite(patches.area_m2[p]))
            damaged(file, "area of patch " + std::to_string(p) + " is not a positive number");
    check_chunks(file, patches.first_patch, patches.ids.size());
    std::vector<std::uint64_t> sorted = patches.ids;
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) damaged(file, "two patches have the same id");
    if (rounds.size() % 2 || closure.size() != 2) damaged(file, "a key is not 16 bytes long");
    for (std::size_t k = 0; k < rounds.size(); k += 2) patches.evidence.push_back({rounds[k], rounds[k + 1]});
    patches.closure = {closure[0], closure[1]};
    patches.estimator = read_name(file, 5);
    return patches;
}

}  // namespace luxel
