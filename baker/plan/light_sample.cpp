#include "baker/plan/light_sample.h"

#include <algorithm>

#include "baker/light/gather.h"
#include "baker/light/sky.h"
#include "baker/plan/idle_time.h"

namespace luxel {
namespace {

constexpr std::uint64_t most_texels = 1024, least_texels = 128;
constexpr std::uint64_t most_rays = 1 << 18;

/// Every so many-th texel of the pages that are lightmaps.
TexelSet some_texels(const BakedGeometry& g, std::uint64_t wanted) {
    std::uint64_t count = 0;
    for (std::uint32_t page = 0; page < g.shown_pages; ++page) count += g.texels.pages[page].texels.size();
    const std::uint64_t step = std::max<std::uint64_t>(1, count / wanted);
    TexelSet some{g.texels.page_size, std::vector<PageTexels>(g.texels.pages.size())};
    std::uint64_t number = 0;
    for (std::uint32_t page = 0; page < g.shown_pages; ++page)
        for (const Texel& texel : g.texels.pages[page].texels) {
            if (number++ % step != step / 2) continue;
            PageTexels& out = some.pages[page];
            const auto fragments = g.texels.pages[page].fragments.begin() + texel.first_fragment;
            out.texels.push_back(texel);
            out.texels.back().first_fragment = static_cast<std::uint32_t>(out.fragments.size());
            out.fragments.insert(out.fragments.end(), fragments, fragments + texel.fragment_count);
        }
    return some;
}

}  // namespace

double sample_light(const BakeOptions& options, const BakedGeometry& g) {
    if (options.gather_rays == 0 || g.patches.count() == 0) return 0;
    const TexelSet some = some_texels(g, std::clamp(most_rays / options.gather_rays, least_texels, most_texels));
    const EmitterSet emitters(g.scene, g.atlas, g.patches);
    const RadiosityDetail dark(std::vector<Rgb>(g.patches.count(), Rgb(0, 0, 0)));
    const LightGuides even;
    std::optional<Sky> sky;
    if (!g.scene.sky.empty()) sky.emplace(g.scene.sky);
    const GatherInput input{g.scene, g.atlas, some, g.patches, *g.tracer, emitters, dark, even, sky ? &*sky : nullptr};
    const auto gather = [&](std::uint32_t rays) {
        const GatherOptions gathering{rays, true, options.lamp_points, options.edge_lamp_points(), patch_side_m(options, g.atlas), options.seed, options.stop};
        std::size_t count = 0;
        const IdleTime time(options.threads);
        for (std::uint32_t page = 0; page < some.pages.size(); ++page) {
            count += some.pages[page].texels.size();
            if (!some.pages[page].texels.empty()) gather_page(input, page, gathering, nullptr);
        }
        return count ? time.seconds() / static_cast<double>(count) : 0;
    };
    gather(8);  // what it needs of memory is there afterwards
    return gather(options.gather_rays);
}

}  // namespace luxel
