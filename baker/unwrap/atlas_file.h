/// The atlas in the bake folder: a BlockFile of kind `atlas`, version 2, whose blocks are the columns below in this
/// order (tag = position): 0 header {float texels per metre as bits, page size, page count, padding, chart count,
/// triangle count} as u32; 1 charts, 9 u32 each in the order of struct Chart; 2 chart_triangles u32; 3 corner_uv float
/// pairs, 3 per triangle; 4 blocks of copies, 8 u32 each in the order of struct CopyBlock. triangle_chart follows from 1 and 2.
#pragma once
#include <filesystem>

#include "baker/scene/scene.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// Throws Error{cannot_write}.
void save_atlas(const std::filesystem::path& path, const Key& key, const Atlas& atlas);

/// Throws Error{damaged_store} unless the file is whole, has this key, and is a valid atlas of this scene: every
/// triangle in exactly one chart of its own object, charts in order and inside their pages, coordinates finite and
/// inside their charts; blocks of whole instances, in order, around their charts,
/// and equal where they have one layout.
Atlas load_atlas(const std::filesystem::path& path, const Key& key, const Scene& scene);

}  // namespace luxel
