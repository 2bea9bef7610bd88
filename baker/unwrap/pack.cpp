#include "baker/unwrap/pack.h"

#include <algorithm>

#include "formats/base/error.h"

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
#define STB_RECT_PACK_IMPLEMENTATION
#define STBRP_STATIC
#include <stb_rect_pack.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace luxel {
namespace {

/// Free space of one page while it is being filled.
class Page {
  public:
    Page(std::uint32_t page_size, std::uint32_t padding)
        : padding_(static_cast<int>(padding)),
          side_(static_cast<int>(page_size) - padding_),
          nodes_(static_cast<std::size_t>(side_)) {
        stbrp_init_target(&context_, side_, side_, nodes_.data(), side_);
    }
    /// One at a time, so that the order is ours and not the library's unstable sort.
    bool place(Chart& chart) {
        stbrp_rect rectangle{};
        rectangle.w = static_cast<int>(chart.width) + padding_;
        rectangle.h = static_cast<int>(chart.height) + padding_;
        stbrp_pack_rects(&context_, &rectangle, 1);
        if (!rectangle.was_packed) return false;
        chart.x = static_cast<std::uint32_t>(rectangle.x + padding_);
        chart.y = static_cast<std::uint32_t>(rectangle.y + padding_);
        return true;
    }

  private:
    int padding_, side_;
    std::vector<stbrp_node> nodes_;
    stbrp_context context_{};
};

std::uint64_t footprint(const Chart& chart, std::uint32_t padding) {
    return std::uint64_t{chart.width + padding} * (chart.height + padding);
}

}  // namespace

std::uint32_t pack_charts(std::vector<Chart>& charts, std::uint32_t page_size, std::uint32_t padding) {
    for (const Chart& chart : charts)
        if (page_size < 2 * padding || std::max(chart.width, chart.height) > page_size - 2 * padding)
            throw Error(ErrorCode::internal, "pack",
                        "chart of " + std::to_string(chart.width) + " x " + std::to_string(chart.height) +
                            " texels for a page of " + std::to_string(page_size) + " with padding " +
                            std::to_string(padding));
    const std::uint64_t page_area = std::uint64_t{page_size - padding} * (page_size - padding);
    std::vector<std::size_t> waiting;
    std::size_t next = 0;
    std::uint32_t pages = 0;
    std::uint64_t waiting_area = 0;
    while (next < charts.size() || !waiting.empty()) {
        // What the last page refused, then charts in order until a page could be full.
        for (; next < charts.size() && waiting_area < page_area; ++next) {
            waiting.push_back(next);
            waiting_area += footprint(charts[next], padding);
        }
        std::sort(waiting.begin(), waiting.end(), [&](std::size_t a, std::size_t b) {
            if (charts[a].height != charts[b].height) return charts[a].height > charts[b].height;
            if (charts[a].width != charts[b].width) return charts[a].width > charts[b].width;
            return a < b;
        });
        Page page(page_size, padding);
        std::vector<std::size_t> refused;
        for (const std::size_t index : waiting) {
            if (!page.place(charts[index])) {
                refused.push_back(index);
                continue;
            }
            charts[index].page = pages;
            waiting_area -= footprint(charts[index], padding);
        }
        waiting = std::move(refused);
        ++pages;
    }
    return pages;
}

}  // namespace luxel
