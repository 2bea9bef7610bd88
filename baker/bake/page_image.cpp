#include "baker/bake/page_image.h"

#include "baker/output/fill_hidden.h"

namespace luxel {

PageImage page_image(const BakeOptions& options, const BakedGeometry& g, const BakedLight& light, std::uint32_t page) {
    const std::uint32_t size = g.atlas.page_size;
    const std::vector<Rgb> irradiance = page_light(options, g, light, page);
    PageImage image{std::vector<Rgb>(std::size_t{size} * size, Rgb(0, 0, 0)),
                    std::vector<std::uint8_t>(std::size_t{size} * size, texel_empty)};
    std::vector<std::uint32_t> charts(image.mask.size(), none);
    const PageTexels& content = g.texels.pages[page];
    const std::vector<Texel>& texels = content.texels;
    for (std::size_t k = 0; k < texels.size(); ++k) {
        const std::size_t at = std::size_t{texels[k].y} * size + texels[k].x;
        image.values[at] = irradiance[k];
        image.mask[at] = content.can_send(texels[k]) ? texel_covered : texel_hidden;
        charts[at] = texels[k].chart;
    }
    fill_hidden(image.values, image.mask, charts, size, size);
    dilate(image.values, image.mask, size, size, std::max(1u, g.atlas.padding));
    return image;
}

}  // namespace luxel
