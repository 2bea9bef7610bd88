#include "baker/unwrap/atlas.h"

namespace luxel {

std::uint64_t Atlas::resident_bytes() const {
    return charts.capacity() * sizeof(Chart) + copy_blocks.capacity() * sizeof(CopyBlock) + chart_triangles.capacity() * sizeof(std::uint32_t) +
           triangle_chart.capacity() * sizeof(std::uint32_t) + corner_uv.capacity() * sizeof(Vec2f);
}

}  // namespace luxel
