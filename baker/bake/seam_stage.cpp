#include "baker/bake/seam_stage.h"

#include "baker/output/dilate.h"

namespace luxel {
namespace {

SeamTexelKind kind_of(std::uint8_t mask) {
    return mask == texel_covered  ? SeamTexelKind::covered
           : mask == texel_filled ? SeamTexelKind::filled
                                  : SeamTexelKind::empty;
}

std::size_t place(const SeamTexel& texel, std::uint32_t page_size) {
    return std::size_t{texel.y} * page_size + texel.x;
}

}  // namespace

JoinedSeams::JoinedSeams(const BakeOptions& options, const BakedGeometry& g, const BakedLight& light) {
    SeamSamples samples = sample_seams(g.scene, g.atlas, g.texels, *g.tracer, g.seams);
    values_.resize(samples.texels.size());
    std::vector<SeamTexelKind> kinds(samples.texels.size());
    for (std::size_t t = 0; t < samples.texels.size();) {
        const std::uint32_t page = samples.texels[t].page;
        const PageImage image = page_image(options, g, light, page);
        for (; t < samples.texels.size() && samples.texels[t].page == page; ++t) {
            const std::size_t at = place(samples.texels[t], g.atlas.page_size);
            values_[t] = image.values[at];
            kinds[t] = kind_of(image.mask[at]);
        }
    }
    const SeamJump jump = join_seams(samples, kinds, values_);
    texels_ = std::move(samples.texels);
    report_ = {true,
               g.seams.size(),
               samples.samples.size(),
               samples.blocked,
               samples.hidden,
               samples.crowded,
               jump.texels,
               jump.length_texels / static_cast<double>(g.atlas.texels_per_metre),
               jump.before,
               jump.after};
}

void JoinedSeams::put_into(std::uint32_t page, std::uint32_t page_size, PageImage& image) const {
    const auto first = std::lower_bound(texels_.begin(), texels_.end(), SeamTexel{page, 0, 0});
    for (auto t = first; t != texels_.end() && t->page == page; ++t)
        image.values[place(*t, page_size)] = values_[static_cast<std::size_t>(t - texels_.begin())];
}

}  // namespace luxel
