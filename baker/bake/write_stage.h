/// The end of the way: texels -> pictures, joined along their seams -> glTF and its sidecar.
#pragma once
#include "baker/bake/geometry_stages.h"
#include "baker/bake/light_stages.h"
#include "baker/bake/seam_stage.h"

namespace luxel {

struct WrittenOutputs {
    std::vector<OutputReport> outputs;
    std::vector<Warning> warnings;
};

/// Writes `<stem>.lightmap<page>.exr`, the glTF with its pages in BakeOptions::format, and `<output>.lightmaps.json`; with BakeOptions::layers
/// `<stem>.aov<page>.exr` too, but not for previews. Layers of light that is not known are left out, with a warning. On an error the files
/// that this call has written are removed again.
WrittenOutputs write_lightmaps(const BakeOptions& options, const BakedGeometry& geometry, const BakedLight& light,
                               const JoinedSeams& seams, const ProgressFunction& progress);

/// At most, of the pictures that are kept until a model is written: they are of one model at a time.
std::uint64_t picture_bytes_per_texel(const BakeOptions& options);

/// The same as stage "write", after joining the seams if that is wanted; then the unlit model, if that is.
void write_outputs(const BakeOptions& options, const BakedGeometry& geometry, const BakedLight& light, StageClock& clock,
                   BakeReport& report);

}  // namespace luxel
