#include "formats/bake/directory_file.h"

#include <utility>

namespace luxel {
namespace {

constexpr std::size_t block_count = 9;

[[noreturn]] void damaged(const BlockFileReader& file, const std::string& what) {
    throw Error(ErrorCode::damaged_store, file.name(), what, "remove the file and run the same bake again");
}

}  // namespace

void save_directory(const std::filesystem::path& path, const Key& strips, const StripDirectory& directory) {
    std::vector<std::uint32_t> a, b;
    std::vector<std::uint64_t> pairs, bytes;
    for (const DirectoryBlock& block : directory.blocks) {
        a.push_back(block.a), b.push_back(block.b);
        pairs.push_back(block.pair_count), bytes.push_back(block.stored_bytes);
    }
    BlockFileWriter file(path, FileKind::directory, directory_version, strips);
    append_tallies(file, directory.tallies);
    append_column<std::uint32_t>(file, 4, a);
    append_column<std::uint32_t>(file, 5, b);
    append_column<std::uint64_t>(file, 6, pairs);
    append_column<std::uint64_t>(file, 7, bytes);
    append_column<std::uint64_t>(file, 8, std::vector<std::uint64_t>{directory.hot_bytes});
    file.publish();
}

std::optional<StripDirectory> load_directory(const std::filesystem::path& path, const Key& strips) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return {};
    const BlockFileReader file(path, FileKind::directory, directory_version, &strips);
    if (file.blocks().size() != block_count)
        damaged(file, std::to_string(file.blocks().size()) + " blocks, expected " + std::to_string(block_count));
    for (std::size_t k = 0; k < block_count; ++k)
        if (file.blocks()[k].tag != k) damaged(file, "block " + std::to_string(k) + " has another tag");
    StripDirectory directory;
    directory.tallies = load_tallies(file);
    const auto a = read_column<std::uint32_t>(file, 4), b = read_column<std::uint32_t>(file, 5);
    const auto pairs = read_column<std::uint64_t>(file, 6), bytes = read_column<std::uint64_t>(file, 7);
    const auto hot = read_column<std::uint64_t>(file, 8);
    if (b.size() != a.size() || pairs.size() != a.size() || bytes.size() != a.size()) damaged(file, "block columns differ in length");
    for (std::size_t k = 0; k < a.size(); ++k) {
        if (b[k] < a[k] || (k && std::pair(a[k], b[k]) <= std::pair(a[k - 1], b[k - 1])))
            damaged(file, "block " + std::to_string(k) + " of the matrix is out of order");
        if (pairs[k] == 0 || bytes[k] == 0) damaged(file, "block " + std::to_string(k) + " of the matrix is empty");
        directory.blocks.push_back({a[k], b[k], pairs[k], bytes[k]});
    }
    if (hot.size() != 1) damaged(file, "the budget of the kept blocks is not one number");
    directory.hot_bytes = hot[0];
    return directory;
}

}  // namespace luxel
