/// Patches: the unknowns of the coarse solution, and the map from surface to patch.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "baker/core/vec.h"
#include "baker/patches/contact_texels.h"
#include "baker/patches/parted_texels.h"
#include "baker/patches/texels.h"

namespace luxel {

/// Final contract: a patch's name for ever. Hash of node path, mesh content, chart ordinal, cell of the chart's own grid,
/// connected set within the cell, side and refinement level. Never depends on numbers, pages, chunks or other objects.
using PatchId = std::uint64_t;
/// Position of a patch in this run's numbering: consecutive per chunk; changes whenever the scene does.
using PatchNumber = std::uint32_t;

/// Evidence of a ray that reached no patch, and special values of the patch image.
constexpr PatchNumber no_patch = 0xffffffffu;

struct Patch {
    PatchId id = 0;
    Vec3f center;            ///< area-weighted mean position of what is visible, m
    Vec3f normal;            ///< unit, area-weighted mean; points away from the side that the patch is
    float area_m2 = 0;       ///< > 0: the visible area
    Rgb reflectance;         ///< area-weighted mean, 0..1
    Rgb emission;            ///< exitance M, lm/m2; area times M is the exact power of its texels
    std::uint32_t chart = 0;
    PatchNumber other_side = no_patch;  ///< of a two-sided surface whose back is open: the patch on the other side
    bool is_back = false;               ///< lies on the back: shares the front's fragments, has no texels of its own
};

/// Patches in number order with the surface they stand for.
struct PatchSet {
    std::vector<Patch> patches;
    /// Fragments of patch p with a visible cell: fragments[fragment_begin[p] .. fragment_begin[p + 1]), in raster order (y, x, triangle).
    std::vector<std::uint32_t> fragment_begin;
    std::vector<Fragment> fragments;
    /// Per page, page_size * page_size: number of the front patch of each texel, no_patch where nothing is covered or all
    /// of the patch lies inside solids. A patch's hidden texels bear its number.
    std::vector<std::vector<PatchNumber>> page_patch;
    std::uint32_t page_size = 0;
    PartedTexels parted;     ///< not stored: none in a set that was read from a file
    ContactTexels contacts;  ///< the same

    [[nodiscard]] std::size_t count() const { return patches.size(); }
    [[nodiscard]] std::span<const Fragment> fragments_of(PatchNumber patch) const {
        return {fragments.data() + fragment_begin[patch], fragments.data() + fragment_begin[patch + 1]};
    }
    [[nodiscard]] std::uint64_t resident_bytes() const;
};

}  // namespace luxel
