#include "formats/gltf/gltf_out_split.h"

#include <algorithm>
#include <bit>

namespace luxel {
namespace {

constexpr std::uint32_t end_of_list = 0xffffffffu;

void check_layout(std::span<const std::uint32_t> triangles, const PrimitiveLayout& layout, std::size_t page_count,
                  const std::string& where) {
    if (layout.corner_uv.size() != triangles.size() || layout.triangle_page.size() * 3 != triangles.size())
        throw Error(ErrorCode::internal, where,
                    "the layout has " + std::to_string(layout.triangle_page.size()) + " triangles, the primitive " +
                        std::to_string(triangles.size() / 3));
    for (const std::uint32_t page : layout.triangle_page)
        if (page != no_page && page >= page_count)
            throw Error(ErrorCode::internal, where,
                        "lightmap page " + std::to_string(page) + " of " + std::to_string(page_count));
}

/// Finds or makes the vertex of a part that copies (old vertex, coordinate). The few copies of one old vertex form a
/// list: no hash table, so nothing depends on one's order.
class VertexCopies {
  public:
    VertexCopies(std::uint64_t vertex_count, PagePart& part) : first_(vertex_count, end_of_list), part_(part) {}

    std::uint32_t find_or_add(std::uint32_t vertex, const Imath::V2f& uv) {
        for (std::uint32_t copy = first_[vertex]; copy != end_of_list; copy = next_[copy])
            if (same_bits(part_.uv[copy], uv)) return copy;
        const auto copy = static_cast<std::uint32_t>(part_.uv.size());
        part_.source_vertex.push_back(vertex);
        part_.uv.push_back(uv);
        next_.push_back(first_[vertex]);
        first_[vertex] = copy;
        return copy;
    }

  private:
    static bool same_bits(const Imath::V2f& a, const Imath::V2f& b) {
        return std::bit_cast<std::uint32_t>(a.x) == std::bit_cast<std::uint32_t>(b.x) &&
               std::bit_cast<std::uint32_t>(a.y) == std::bit_cast<std::uint32_t>(b.y);
    }
    std::vector<std::uint32_t> first_, next_;
    PagePart& part_;
};

}  // namespace

std::vector<PagePart> split_by_layout(std::span<const std::uint32_t> triangles, std::uint64_t vertex_count,
                                      const PrimitiveLayout& layout, std::size_t page_count, const std::string& where) {
    check_layout(triangles, layout, page_count, where);
    std::vector<std::uint32_t> pages = layout.triangle_page;
    std::sort(pages.begin(), pages.end());
    pages.erase(std::unique(pages.begin(), pages.end()), pages.end());
    if (!pages.empty() && pages.back() == no_page) pages.pop_back();

    std::vector<PagePart> parts;
    for (const std::uint32_t page : pages) {
        PagePart& part = parts.emplace_back();
        part.page = page;
        VertexCopies copies(vertex_count, part);
        for (std::size_t triangle = 0; triangle < layout.triangle_page.size(); ++triangle) {
            const std::uint32_t own_page = layout.triangle_page[triangle];
            const bool is_placed = own_page != no_page;
            if (is_placed ? own_page != page : page != pages.front()) continue;
            for (std::size_t corner = 3 * triangle; corner < 3 * triangle + 3; ++corner)
                part.indices.push_back(copies.find_or_add(
                    triangles[corner], is_placed ? layout.corner_uv[corner] : Imath::V2f(0.0f, 0.0f)));
        }
    }
    return parts;
}

}  // namespace luxel
