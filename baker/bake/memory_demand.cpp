#include "baker/bake/memory_demand.h"

#include <malloc.h>

#include "baker/bake/write_stage.h"
#include "baker/core/memory.h"
#include "baker/light/pane_colour.h"
#include "baker/output/seam_join.h"

namespace luxel {

MemoryDemand memory_demand(const BakeOptions& options, const BakedGeometry& geometry, const BakeReport& report, unsigned threads) {
    ::malloc_trim(0);  // what the stages have freed is not needed, and would make the floor a matter of luck
    const std::uint64_t resident = resident_bytes_now();
    const auto beside_geometry = [&](std::uint64_t bytes) { return bytes > report.geometry_bytes ? bytes - report.geometry_bytes : 0; };
    return {.fixed_bytes = beside_geometry(resident),
            .past_peak_bytes = beside_geometry(report.peak_bytes),
            .patch_count = geometry.patches.count(),
            .chunk_patches = options.chunk_patches,
            .page_size = geometry.atlas.page_size,
            .page_count = geometry.atlas.page_count,
            .threads = threads,
            .solver = options.solver,
            .gathers = options.gather_rays > 0,
            .refines = options.gather_rays > 0 && options.error > 0,
            .previews = options.preview_s > 0,
            .seam_bytes = seam_join_bytes(geometry.seams),
            .layer_bytes_per_texel = layer_bytes_per_texel(options.layers),
            .picture_bytes_per_texel = picture_bytes_per_texel(options),
            .sky_width = geometry.scene.sky.width,
            .sky_height = geometry.scene.sky.height,
            .has_tinting_panes = has_tinting_panes(geometry.scene)};
}

}  // namespace luxel
