/// Where patches see the open sky, as counts of rays by bin of direction. sky_view_file.md.
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "formats/base/block_file.h"

namespace luxel {

constexpr std::uint32_t sky_view_version = 2;
/// Rays per patch at most, so that a count fits 16 bits.
constexpr std::uint32_t most_sky_rays = 32768;
/// Patches per block.
constexpr std::uint32_t sky_view_block = 256;

/// Number of a bin of directions, below 1024.
using SkyBin = std::uint16_t;

/// Of consecutive patches: those bins that a ray went into, ascending per patch, and how many did.
struct SkyCounts {
    std::vector<std::uint16_t> bins_of_patch;  ///< 0 .. 1024
    std::vector<SkyBin> bins;
    std::vector<std::uint16_t> counts;  ///< > 0; at most the rays of a patch together
    bool operator==(const SkyCounts&) const = default;
};

/// Block by block, in the order of patches. Throws Error{cannot_write}.
class SkyViewWriter {
  public:
    SkyViewWriter(const std::filesystem::path& path, const Key& key, std::uint64_t patch_count, std::uint32_t rays);
    /// sky_view_block patches, or what is left of them.
    void append(const SkyCounts& counts);
    void publish() { file_.publish(); }

  private:
    BlockFileWriter file_;
};

/// Threads: read() is const and reentrant. Throws Error{damaged_store}: missing, damaged, of another key, sizes that do not
/// agree, bins out of order or range, counts of 0, more counts than rays.
class SkyViewReader {
  public:
    SkyViewReader(const std::filesystem::path& path, const Key& key);
    [[nodiscard]] std::uint64_t patch_count() const { return patch_count_; }
    [[nodiscard]] std::uint32_t rays() const { return rays_; }
    [[nodiscard]] std::size_t block_count() const { return file_.blocks().size() - 1; }
    [[nodiscard]] SkyCounts read(std::size_t block) const;

  private:
    BlockFileReader file_;
    std::uint64_t patch_count_ = 0;
    std::uint32_t rays_ = 0;
};

}  // namespace luxel
