/// Which nodes of a baked scene go into a file together, for engines that load it piece by piece, and the index of those files.
///
/// Rule     a node belongs to the chunk of patches where most of its surface lies; the nodes of a chunk are a part. A part with
///          fewer triangles than BakeOptions::split_triangles joins the one that it sees most of, by a thin round of rays,
///          or, seeing none, the nearest.
/// Memory   144 bytes per patch while the rays are cast, when the matrix is gone.
/// Threads  uses them all; the result does not depend on their number.
#pragma once
#include <map>

#include "baker/bake/geometry_stages.h"
#include "baker/output/chunk_index.h"
#include "formats/gltf/gltf_out.h"

namespace luxel {

struct SplitPlan {
    GltfSplit split;
    std::vector<std::map<std::uint32_t, std::uint64_t>> rays;  ///< per part: to every other that it sees
};

SplitPlan plan_split(const BakeOptions& options, const BakedGeometry& geometry);

/// The index of what was written. Parts without a file are left out, and the others numbered anew.
ChunkIndex index_of_parts(const BakeOptions& options, const BakedGeometry& geometry, const SplitPlan& plan, const GltfParts& parts);

}  // namespace luxel
