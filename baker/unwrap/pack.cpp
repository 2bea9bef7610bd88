#include "baker/unwrap/pack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

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

/// Free space while it is being filled. Each rectangle brings its padding on the right and below.
class Space {
  public:
    Space(std::uint32_t width, std::uint32_t height, std::uint32_t padding)
        : padding_(static_cast<int>(padding)), nodes_(static_cast<std::size_t>(width)) {
        stbrp_init_target(&context_, static_cast<int>(width), static_cast<int>(height), nodes_.data(), static_cast<int>(width));
    }
    /// One at a time, so that the order is ours and not the library's unstable sort.
    bool place(PackedRectangle& rectangle) {
        stbrp_rect wanted{};
        wanted.w = static_cast<int>(rectangle.width) + padding_;
        wanted.h = static_cast<int>(rectangle.height) + padding_;
        stbrp_pack_rects(&context_, &wanted, 1);
        if (!wanted.was_packed) return false;
        rectangle.x = static_cast<std::uint32_t>(wanted.x);
        rectangle.y = static_cast<std::uint32_t>(wanted.y);
        return true;
    }

  private:
    int padding_;
    std::vector<stbrp_node> nodes_;
    stbrp_context context_{};
};

std::uint64_t footprint(const PackedRectangle& rectangle, std::uint32_t padding) {
    return std::uint64_t{rectangle.width + padding} * (rectangle.height + padding);
}

/// Highest first, then widest, which leaves the skyline even.
void sort_for_packing(const std::vector<PackedRectangle>& rectangles, std::vector<std::size_t>& order) {
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        if (rectangles[a].height != rectangles[b].height) return rectangles[a].height > rectangles[b].height;
        if (rectangles[a].width != rectangles[b].width) return rectangles[a].width > rectangles[b].width;
        return a < b;
    });
}

/// One try of pack_tightly with a given width; width 0 where it is not enough.
PackedRectangle pack_strip(std::vector<PackedRectangle>& rectangles, const std::vector<std::size_t>& order, std::uint32_t width,
                           std::uint32_t limit, std::uint32_t padding) {
    Space space(width + padding, limit + padding, padding);
    PackedRectangle all;
    for (const std::size_t index : order) {
        PackedRectangle& rectangle = rectangles[index];
        if (!space.place(rectangle)) return {};
        all.width = std::max(all.width, rectangle.x + rectangle.width);
        all.height = std::max(all.height, rectangle.y + rectangle.height);
    }
    return all;
}

}  // namespace

std::uint32_t pack_pages(std::vector<PackedRectangle>& rectangles, std::uint32_t page_size, std::uint32_t padding) {
    for (const PackedRectangle& rectangle : rectangles)
        if (page_size < 2 * padding || std::max(rectangle.width, rectangle.height) > page_size - 2 * padding)
            throw Error(ErrorCode::internal, "pack",
                        "rectangle of " + std::to_string(rectangle.width) + " x " + std::to_string(rectangle.height) +
                            " texels for a page of " + std::to_string(page_size) + " with padding " +
                            std::to_string(padding));
    const std::uint64_t page_area = std::uint64_t{page_size - padding} * (page_size - padding);
    std::vector<std::size_t> waiting;
    std::size_t next = 0;
    std::uint32_t pages = 0;
    std::uint64_t waiting_area = 0;
    while (next < rectangles.size() || !waiting.empty()) {
        // What the last page refused, then rectangles in order until a page could be full.
        for (; next < rectangles.size() && waiting_area < page_area; ++next) {
            waiting.push_back(next);
            waiting_area += footprint(rectangles[next], padding);
        }
        sort_for_packing(rectangles, waiting);
        Space page(page_size - padding, page_size - padding, padding);
        std::vector<std::size_t> refused;
        for (const std::size_t index : waiting) {
            PackedRectangle& rectangle = rectangles[index];
            if (!page.place(rectangle)) {
                refused.push_back(index);
                continue;
            }
            rectangle.page = pages;
            rectangle.x += padding;
            rectangle.y += padding;
            waiting_area -= footprint(rectangle, padding);
        }
        waiting = std::move(refused);
        ++pages;
    }
    return pages;
}

PackedRectangle pack_tightly(std::vector<PackedRectangle>& rectangles, std::uint32_t limit, std::uint32_t padding) {
    double area = 0;
    std::uint32_t widest = 1;
    for (const PackedRectangle& rectangle : rectangles) {
        area += static_cast<double>(footprint(rectangle, padding));
        widest = std::max(widest, rectangle.width);
    }
    if (widest > limit) return {};
    std::vector<std::size_t> order(rectangles.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    sort_for_packing(rectangles, order);
    // From a square without any waste to one of three times its area; the last try is the widest that there may be.
    constexpr std::array<double, 6> widenings{1.0, 1.08, 1.18, 1.3, 1.5, 1.75};
    PackedRectangle best;
    std::vector<PackedRectangle> best_places;
    const auto attempt = [&](std::uint32_t width) {
        const PackedRectangle all = pack_strip(rectangles, order, width, limit, padding);
        if (all.width == 0 || (best.width && footprint(all, padding) >= footprint(best, padding))) return;
        best = all;
        best_places = rectangles;
    };
    for (const double widening : widenings)
        attempt(std::clamp(static_cast<std::uint32_t>(std::ceil(std::min(std::sqrt(area) * widening, static_cast<double>(limit)))), widest, limit));
    if (best.width == 0) attempt(limit);
    if (best.width) rectangles = std::move(best_places);
    return best;
}

}  // namespace luxel
