/// A page with everything that lies on it, as a picture takes it.
#pragma once
#include "baker/bake/light_stages.h"

namespace luxel {

struct PageImage {
    std::vector<Rgb> values;         ///< page_size * page_size, row 0 at the top, lux
    std::vector<std::uint8_t> mask;  ///< output/dilate.h: empty, covered or filled
};

/// Light of the texels, hidden ones filled, borders grown by the padding (by one texel at least: what a bilinear filter
/// reads).
PageImage page_image(const BakeOptions& options, const BakedGeometry& geometry, const BakedLight& light,
                     std::uint32_t page);

/// Resident bytes of making one, for each texel of the page: light of its texels, float RGB, mask, chart and distance.
constexpr std::uint64_t page_image_bytes_per_texel = 12 + 12 + 1 + 4 + 4;

}  // namespace luxel
