/// Where patches see the open sky: of the rays that leave a patch evenly over its surface and cosine-weighted, those that
/// meet nothing, counted by direction. Geometry only: what the sky looks like is multiplied in later, as often as it
/// changes (light/patch_sky.h).
#pragma once
#include <span>
#include <vector>

#include "baker/formfactors/sky_bins.h"
#include "baker/patches/patch.h"
#include "baker/trace/tracer.h"
#include "baker/unwrap/atlas.h"
#include "formats/bake/sky_view_file.h"

namespace luxel {

struct SkyViewOptions {
    std::uint32_t rays = 256;  ///< per patch, a power of two, at most most_sky_rays
    std::uint64_t seed = 0;
};

/// Held while a block of patches is traced and written: rays by bin, what is kept of them, and its bytes before and after they are packed.
constexpr std::uint64_t sky_view_block_bytes = std::uint64_t{sky_view_block} * (sky_bin_count * 2 + 3 * (2 + sky_bin_count * 4));

/// Of reading a block: as it lies on the disk, unpacked, and sorted out.
constexpr std::uint64_t sky_view_read_bytes = std::uint64_t{sky_view_block} * 3 * (2 + sky_bin_count * 4);

/// The counts of patches [begin, end). A pure function of geometry, stable ids and options; uses all threads.
SkyCounts count_sky_rays(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer,
                         PatchNumber begin, PatchNumber end, const SkyViewOptions& options);

}  // namespace luxel
