/// A second model, `<stem>.unlit.glb`, that any viewer shows as it is: its pages are what surfaces look like (output/unlit_page.h), its materials
/// KHR_materials_unlit. docs/lightmap-formats.md has what it can and cannot show.
///
/// Two passes over the pages, each makes them again from their light: the first finds the exposure, the second writes. One page is in memory at a time, and
/// the pictures until they are written.
#pragma once
#include "baker/bake/seam_stage.h"
#include "baker/bake/write_stage.h"

namespace luxel {

/// Where it goes.
std::filesystem::path unlit_path(const BakeOptions& options);

/// Writes it and adds it to the outputs. Returns the exposure that was used: BakeOptions::unlit_exposure, or where that is 0 the one that makes the 99th
/// percentile of all channels white.
UnlitReport write_unlit(const BakeOptions& options, const BakedGeometry& geometry, const BakedLight& light, const JoinedSeams& seams,
                        WrittenOutputs& written);

}  // namespace luxel
