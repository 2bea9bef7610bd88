/// Cuts a triangle list along its lightmap layout: per page, with one vertex for every distinct (old vertex,
/// coordinate). Private to the gltf_out files.
///
/// Order    parts by page; triangles of a part in their old order; vertices in the order of their first use.
/// Threads  pure.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "formats/gltf/gltf_out.h"

namespace luxel {

struct PagePart {
    std::uint32_t page = 0;
    std::vector<std::uint32_t> indices;        ///< 3 per triangle, into the vertices below
    std::vector<std::uint32_t> source_vertex;  ///< per vertex: the old vertex that it copies
    std::vector<Imath::V2f> uv;                ///< per vertex
};

/// `triangles`: 3 old vertices each, below vertex_count. No parts if no triangle has a page; else triangles without a
/// page join the first part at coordinate 0. Throws Error{internal} naming `where` when layout and triangles differ in
/// size or a page is not below page_count.
std::vector<PagePart> split_by_layout(std::span<const std::uint32_t> triangles, std::uint64_t vertex_count,
                                      const PrimitiveLayout& layout, std::size_t page_count, const std::string& where);

}  // namespace luxel
