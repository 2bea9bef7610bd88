/// The end of the way: texels -> pictures -> glTF and its sidecar.
#pragma once
#include "baker/bake/geometry_stages.h"
#include "baker/bake/light_stages.h"

namespace luxel {

/// Writes `<stem>.lightmap<page>.exr`, the glTF with its 8-bit pages, and `<output>.lightmaps.json`. On an error the files
/// that this call has written are removed again.
void write_outputs(const BakeOptions& options, const BakedGeometry& geometry, const BakedLight& light, StageClock& clock,
                   BakeReport& report);

}  // namespace luxel
