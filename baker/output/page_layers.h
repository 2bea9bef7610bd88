/// From a page to its layers (layers.h), and to the file that holds them.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "baker/light/texel_light.h"
#include "baker/output/layers.h"
#include "baker/patches/patch.h"
#include "baker/scene/scene.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// All of it stays the caller's.
struct PageLayerInput {
    const Scene& scene;
    const Atlas& atlas;
    const TexelSet& texels;
    const PatchSet& patches;
    std::uint32_t page = 0;
    /// Per texel of the page's square, as the lightmap's has become by filling: texel_covered, texel_filled or
    /// texel_empty (dilate.h).
    std::span<const std::uint8_t> mask;
    std::span<const TexelLight> light;  ///< per texel of PageTexels; may be empty if no layer is_of_light
};

/// Values in the `valid` layer. What is filled holds light of texels near it.
constexpr std::uint32_t valid_none = 0, valid_covered = 1, valid_filled = 2, valid_hidden = 3;

/// One layer, row 0 at the top:
///   direct, indirect         filled as the lightmap is, so that they sum to it everywhere but along seams, which only the
///                            lightmap has joined (seam_join.h)
///   error, sharing, samples  0 except where a texel has light of its own
///   albedo, normal           of every texel that covers surface, hidden ones too; else 0
///   patch, chart             the same, 0xffffffff where there is none
///   area                     of the visible surface in the texel, m2; 0 where there is none
///   valid                    valid_none ... valid_hidden; surface inside solids is hidden, also where its light is
///   filled
/// Threads: uses them all; the values do not depend on them. Errors: Error{internal} on sizes that do not fit.
ExrPartValues page_layer(const PageLayerInput& input, Layer layer);

/// OpenEXR with a part for each layer, in the order given; holds one layer at a time. `software`: name and version of
/// the writer. Errors: Error{cannot_write}.
Bytes layers_exr(const PageLayerInput& input, std::span<const Layer> layers, const std::string& software);

}  // namespace luxel
