/// What a surface looks like from anywhere, texel by texel of a page: reflectance / pi * E + M / pi, in nits. Baked into one picture it is shown by
/// viewers that know neither lightmaps nor light.
///
/// Colours of a page are made from its irradiance (filled and joined as the lightmap is), from the mean reflectance and exitance of
/// each texel's surface, and grown over the padding. Cover is the mean alpha of the surface in the texel: 1 for opaque ones.
///
/// Threads  uses them all; the values do not depend on them.
/// Errors   Error{internal} on sizes that do not fit.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "baker/core/vec.h"
#include "baker/patches/texels.h"
#include "baker/scene/scene.h"
#include "baker/unwrap/atlas.h"
#include "formats/base/bytes.h"

namespace luxel {

struct UnlitPage {
    std::vector<Rgb> nits;            ///< page_size * page_size, row 0 at the top
    std::vector<float> cover;         ///< the same, 0..1; empty where all of the page is opaque
    std::vector<std::uint8_t> mask;   ///< dilate.h: 0 where there is nothing
};

/// irradiance: lux, of all texels that cover surface.
UnlitPage unlit_page(const Scene& scene, const Atlas& atlas, const PageTexels& texels, std::span<const Rgb> irradiance);

/// Counts values by size, as exactly as half a percent, in a fixed memory: many pages give one exposure in any order.
class BrightnessCount {
  public:
    BrightnessCount();
    /// Channels of the texels that hold surface.
    void add(const UnlitPage& page);
    /// A value that at least this share of the channels does not exceed; 1 where there is no light at all.
    [[nodiscard]] double value_of_share(double share) const;
    /// Share of the channels above a value, to within the width of its bin.
    [[nodiscard]] double share_above(double value) const;

  private:
    std::vector<std::uint64_t> bins_;
};

/// Of a page's file, at most.
constexpr std::uint64_t unlit_bytes_per_texel = 4;

/// The page as PNG in sRGB, dithered: sample = nits * exposure, cut at 1; with alpha where `cover` has values. `software`: name and
/// version of the writer.
Bytes unlit_png(const UnlitPage& page, std::uint32_t size, double exposure, const std::string& software);

}  // namespace luxel
