#include "formats/bake/sky_view_file.h"

#include <algorithm>

namespace luxel {
namespace {

constexpr std::uint32_t bin_count = 1024;
constexpr std::uint64_t head_bytes = 16;
/// Of a block whose patches see all of the sky.
constexpr std::uint64_t most_block_bytes = std::uint64_t{sky_view_block} * (2 + 4 * bin_count);

[[noreturn]] void damaged(const BlockFileReader& file, const std::string& what) {
    throw Error(ErrorCode::damaged_store, file.name(), what, "remove the file and run the same command again");
}

/// What a block says that it holds, before that is given memory.
void check_sizes(const BlockFileReader& file) {
    for (std::size_t k = 0; k < file.blocks().size(); ++k) {
        const std::uint64_t bytes = file.blocks()[k].raw_bytes;
        if (k == 0 && bytes != head_bytes) damaged(file, "head: expected 16 bytes, found " + std::to_string(bytes));
        if (bytes > most_block_bytes)
            damaged(file, "block " + std::to_string(k) + ": expected at most " + std::to_string(most_block_bytes) + " bytes, found " +
                              std::to_string(bytes));
    }
}

}  // namespace

SkyViewWriter::SkyViewWriter(const std::filesystem::path& path, const Key& key, std::uint64_t patch_count, std::uint32_t rays)
    : file_(path, FileKind::sky_view, sky_view_version, key) {
    ByteWriter head;
    head.put(patch_count);
    head.put(rays);
    head.put(bin_count);
    file_.append(0, head.bytes(), 0);
}

void SkyViewWriter::append(const SkyCounts& counts) {
    ByteWriter bytes;
    bytes.put_array(std::span<const std::uint16_t>(counts.bins_of_patch));
    bytes.put_array(std::span<const SkyBin>(counts.bins));
    bytes.put_array(std::span<const std::uint16_t>(counts.counts));
    file_.append(file_.block_count(), bytes.bytes(), 3);
}

SkyViewReader::SkyViewReader(const std::filesystem::path& path, const Key& key)
    : file_(path, FileKind::sky_view, sky_view_version, &key) {
    if (file_.blocks().empty()) damaged(file_, "there is no head");
    require_numbered_blocks(file_, file_.blocks().size());
    check_sizes(file_);
    const Bytes bytes = file_.read(0);
    ByteCursor head(bytes, file_.name() + ": block 0");
    patch_count_ = head.get<std::uint64_t>("patches");
    rays_ = head.get<std::uint32_t>("rays");
    const auto bins = head.get<std::uint32_t>("bins");
    if (bins != bin_count) damaged(file_, "head: expected 1024 bins, found " + std::to_string(bins));
    if (rays_ == 0 || rays_ > most_sky_rays) damaged(file_, "rays of a patch: expected 1 to 32768, found " + std::to_string(rays_));
    if (block_count() != patch_count_ / sky_view_block + (patch_count_ % sky_view_block != 0))
        damaged(file_, std::to_string(block_count()) + " blocks do not hold " + std::to_string(patch_count_) + " patches");
}

SkyCounts SkyViewReader::read(std::size_t block) const {
    const Bytes bytes = file_.read(block + 1);
    ByteCursor cursor(bytes, file_.name() + ": block " + std::to_string(block + 1));
    const std::uint64_t patches = std::min<std::uint64_t>(sky_view_block, patch_count_ - block * sky_view_block);
    SkyCounts result;
    result.bins_of_patch = cursor.get_array<std::uint16_t>(patches, "bins of each patch");
    std::uint64_t total = 0;
    for (const std::uint16_t bins : result.bins_of_patch) total += bins;
    result.bins = cursor.get_array<SkyBin>(total, "bins");
    result.counts = cursor.get_array<std::uint16_t>(total, "counts");
    if (cursor.remaining())
        damaged(file_, "block " + std::to_string(block + 1) + ": " + std::to_string(cursor.remaining()) + " bytes after its " +
                           std::to_string(patches) + " patches");
    std::size_t at = 0;
    for (std::size_t k = 0; k < patches; ++k) {
        const auto patch = [&] { return "patch " + std::to_string(block * sky_view_block + k) + ": "; };
        const std::size_t first = at, end = at + result.bins_of_patch[k];
        std::uint64_t rays = 0;
        for (; at < end; ++at) {
            if (at > first && result.bins[at] <= result.bins[at - 1])
                damaged(file_, patch() + "bin " + std::to_string(result.bins[at]) + " after bin " + std::to_string(result.bins[at - 1]) +
                                   ", expected ascending ones");
            if (result.bins[at] >= bin_count)
                damaged(file_, patch() + "expected bins below 1024, found " + std::to_string(result.bins[at]));
            if (result.counts[at] == 0)
                damaged(file_, patch() + "no ray in bin " + std::to_string(result.bins[at]) + ", expected one at least");
            rays += result.counts[at];
        }
        if (rays > rays_)
            damaged(file_, patch() + "expected at most " + std::to_string(rays_) + " open rays, found " + std::to_string(rays));
    }
    return result;
}

}  // namespace luxel
