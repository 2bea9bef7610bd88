#include "baker/bake/unlit_stage.h"

#include "baker/bake/instance_layouts.h"
#include "baker/output/unlit_page.h"
#include "formats/gltf/gltf_out.h"

namespace luxel {
namespace {

/// Share of the channels that are not cut by the default exposure.
constexpr double shown_share = 0.99;

UnlitPage page_of(const BakeOptions& options, const BakedGeometry& g, const BakedLight& light, const JoinedSeams& seams, std::uint32_t page) {
    PageImage image = page_image(options, g, light, page);
    seams.put_into(page, g.atlas.page_size, image);
    return unlit_page(g.scene, g.atlas, g.texels.pages[page], image.values);
}

}  // namespace

std::filesystem::path unlit_path(const BakeOptions& options) {
    auto path = options.output;
    return path.replace_extension("unlit.glb");
}

UnlitReport write_unlit(const BakeOptions& options, const BakedGeometry& g, const BakedLight& light, const JoinedSeams& seams,
                        WrittenOutputs& written) {
    BrightnessCount count;
    for (std::uint32_t page = 0; page < g.shown_pages; ++page) count.add(page_of(options, g, light, seams, page));
    UnlitReport report;
    report.exposure = options.unlit_exposure > 0 ? options.unlit_exposure : 1 / count.value_of_share(shown_share);
    report.cut_share = count.share_above(1 / report.exposure);

    GltfLightmaps pages;
    pages.version = options.software;
    pages.is_unlit = true;
    const auto path = unlit_path(options);
    for (std::uint32_t page = 0; page < g.shown_pages; ++page) {
        const std::string name = "unlit" + std::to_string(page) + ".srgb8";
        pages.pages.push_back({name, unlit_png(page_of(options, g, light, seams, page), g.atlas.page_size, report.exposure, options.software), 1});
        written.outputs.push_back({path.string() + "#" + name, "unlit", "luminance", "nit", "srgb8", 1 / report.exposure});
    }
    pages.instances = instance_layouts(g, SharedNodes::split);
    const GltfWritten model = write_gltf(path, g.document, g.record, pages);
    written.warnings.insert(written.warnings.end(), model.warnings.begin(), model.warnings.end());
    written.outputs.push_back({path.string(), "unlit model", "", "", "", 1});
    return report;
}

}  // namespace luxel
