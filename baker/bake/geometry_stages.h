/// The first half of the way: file -> scene -> atlas -> texels -> patches in chunks. Everything here stays in memory for
/// the whole bake: it is the scene's geometry, which --memory does not count.
#pragma once
#include <memory>

#include "baker/bake/bake.h"
#include "baker/bake/bake_folder.h"
#include "baker/bake/stage_clock.h"
#include "baker/formfactors/block_source.h"
#include "baker/output/seam_edges.h"
#include "baker/patches/patch.h"
#include "baker/trace/tracer.h"
#include "formats/gltf/gltf_document.h"

namespace luxel {

struct BakedGeometry {
    GltfDocument document;
    SceneRecord record;
    Scene scene;
    Atlas atlas;
    TexelSet texels;
    std::uint32_t shown_pages = 0;  ///< pages of the atlas that are lightmaps; those behind them serve the computation alone
    std::vector<Seam> seams;  ///< of those; empty if none are to be joined
    PatchSet patches;  ///< numbered by chunk, open backs included
    ChunkLayout layout;
    std::unique_ptr<Tracer> tracer;  ///< refers to `scene`
    Key layout_key;                  ///< of geometry, atlas, patches and their numbers

    [[nodiscard]] std::uint64_t resident_bytes() const;
};

/// Side of a patch that is not cut, m: cells are so large, whatever the surface is.
inline float patch_side_m(const BakeOptions& options, const Atlas& atlas) {
    return static_cast<float>(options.patch_texels) / atlas.texels_per_metre;
}

/// Returned behind a pointer because the tracer refers to the scene. Warnings and counts go into the report.
std::unique_ptr<BakedGeometry> prepare_geometry(const BakeOptions& options, const BakeFolder& folder, StageClock& clock,
                                                BakeReport& report);

}  // namespace luxel
