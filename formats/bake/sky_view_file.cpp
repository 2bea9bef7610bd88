#include "formats/bake/sky_view_file.h"

#include <algorithm>

namespace luxel {
namespace {

constexpr std::uint32_t bin_count = 256;

[[noreturn]] void damaged(const BlockFileReader& file, const std::string& what) {
    throw Error(ErrorCode::damaged_store, file.name(), what, "remove the file and run the same command again");
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
    bytes.put_array(std::span<const std::uint8_t>(counts.bins));
    bytes.put_array(std::span<const std::uint16_t>(counts.counts));
    file_.append(file_.block_count(), bytes.bytes(), 3);
}

SkyViewReader::SkyViewReader(const std::filesystem::path& path, const Key& key)
    : file_(path, FileKind::sky_view, sky_view_version, &key) {
    if (file_.blocks().empty()) damaged(file_, "there is no head");
    require_numbered_blocks(file_, file_.blocks().size());
    const Bytes bytes = file_.read(0);
    ByteCursor head(bytes, file_.name() + ": block 0");
    patch_count_ = head.get<std::uint64_t>("patches");
    rays_ = head.get<std::uint32_t>("rays");
    if (head.get<std::uint32_t>("bins") != bin_count || head.remaining()) damaged(file_, "expected 256 bins and no more in the head");
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
    result.bins = cursor.get_array<std::uint8_t>(total, "bins");
    result.counts = cursor.get_array<std::uint16_t>(total, "counts");
    if (cursor.remaining()) damaged(file_, "block " + std::to_string(block + 1) + " is longer than its patches");
    std::size_t at = 0;
    for (const std::uint16_t bins : result.bins_of_patch) {
        std::uint64_t rays = 0;
        for (std::size_t end = at + bins, first = at; at < end; ++at) {
            if (at > first && result.bins[at] <= result.bins[at - 1]) damaged(file_, "bins of a patch are out of order");
            if (result.counts[at] == 0) damaged(file_, "a bin without a ray");
            rays += result.counts[at];
        }
        if (rays > rays_) damaged(file_, "a patch has more open rays than rays");
    }
    return result;
}

}  // namespace luxel
