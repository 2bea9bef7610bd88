#include "baker/bake/light_stages.h"

#include <algorithm>

#include "baker/bake/stage_files.h"
#include "baker/light/gather.h"
#include "baker/light/patch_irradiance.h"

namespace luxel {
namespace {

Rgb to_rgb(const Channels& c) {
    return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
}

}  // namespace

BakedLight light_texels(const BakeOptions& options, const BakedGeometry& g, const BakedSources& sources,
                        const BakedMatrix& matrix, const BakedSolution& solution, const BakeFolder& folder,
                        StageClock& clock, BakeReport& report) {
    BakedLight light;
    light.key = KeyBuilder("light 4")
                    .key(solution.key)
                    .integer(options.gather_rays)
                    .integer(options.lamp_points)
                    .integer(static_cast<std::int64_t>(options.seed))
                    .integer(static_cast<int>(options.interpolation))
                    .finish();
    light.folder = folder.lightmaps(light.key);
    std::vector<Rgb> reflected;
    for (PatchNumber p = 0; p < g.patches.count(); ++p) {
        Channels rest = solution.result.radiosity[p];
        for (std::size_t c = 0; c < 3; ++c)
            rest[c] = std::max(0.0, rest[c] - static_cast<double>(g.patches.patches[p].emission[static_cast<int>(c)]));
        reflected.push_back(to_rgb(rest));
    }
    if (options.gather_rays == 0) report.skipped.push_back({"gather", "draft quality interpolates the patches"});
    clock.stage("light", [&] {
        ProgressCounter progress(g.texels.texel_count(), clock.progress("texels"));
        // What is nearer than a patch is wide sees it as more than one brightness.
        const float near_m = patch_side_m(options, g.atlas);
        const EmitterSet emitters(g.scene, g.atlas, g.patches);
        std::vector<Rgb> irradiance;  // per patch, only for drafts
        bool reused = true;
        for (std::uint32_t page = 0; page < g.atlas.page_count; ++page) {
            const auto path = BakeFolder::lightmap_file(light.folder, page);
            if (load_lightmap(path, light.key, g.texels.pages[page].texels.size())) continue;
            reused = false;
            if (options.gather_rays) {
                const GatherInput input{g.scene, g.atlas, g.texels, g.patches, *g.tracer, emitters, reflected};
                save_lightmap(path, light.key,
                              gather_page(input, page, {options.gather_rays, true, options.lamp_points, near_m, options.seed}, &progress));
            } else {
                if (irradiance.empty()) {
                    ClosedMatrix strips(*matrix.strips, matrix.area_m2, matrix.closure);
                    irradiance = patch_irradiance(strips, solution.result.radiosity, sources.lamp_irradiance);
                }
                save_lightmap(path, light.key,
                              interpolate_page(g.atlas, g.texels, g.patches, irradiance, page, options.patch_texels,
                                               options.interpolation));
                progress.add(g.texels.pages[page].texels.size());
            }
        }
        return reused;
    });
    return light;
}

}  // namespace luxel
