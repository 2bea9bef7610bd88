#include "baker/patches/texel_raster.h"

#include <algorithm>
#include <cmath>

#include "baker/core/parallel.h"
#include "baker/patches/fragment_polygon.h"
#include "baker/patches/texel_means.h"

namespace luxel {
namespace {

/// Cuts one triangle into texels: rows first, then columns; squares that lie inside whole are not cut at all.
class TriangleCutter {
  public:
    TriangleCutter(const Scene& scene, const Atlas& atlas, std::vector<Fragment>& out)
        : scene_(scene), atlas_(atlas), out_(out) {}

    void cut(std::uint32_t triangle) {
        triangle_ = triangle;
        chart_ = &atlas_.charts[atlas_.triangle_chart[triangle]];
        area_m2_ = scene_.area_m2(triangle);
        ClipPolygon rest = whole_triangle(atlas_, triangle), row, above;
        const auto& p = rest.points;
        const double uv2 = std::abs((p[1].u - p[0].u) * (p[2].v - p[0].v) - (p[2].u - p[0].u) * (p[1].v - p[0].v));
        square_share_ = uv2 > 0 ? 2 / uv2 : 0;
        const auto [first, last] = cells(rest, &ClipPoint::v, chart_->height);
        for (std::uint32_t y = first; y < last && rest.count; ++y) {
            cut_polygon(rest, &ClipPoint::v, y + 1.0, row, above);
            cut_row(row, y);
            rest = above;
        }
        cut_row(rest, last);
    }

  private:
    /// First and last cell that the polygon reaches along an axis, clamped to the chart.
    static std::pair<std::uint32_t, std::uint32_t> cells(const ClipPolygon& polygon, double ClipPoint::*axis,
                                                         std::uint32_t count) {
        double low = polygon.points[0].*axis, high = low;
        for (std::size_t i = 1; i < polygon.count; ++i) {
            low = std::min(low, polygon.points[i].*axis);
            high = std::max(high, polygon.points[i].*axis);
        }
        const double most = count - 1.0;
        const double first = std::clamp(std::floor(low), 0.0, most);
        // What ends on a line does not reach the next cell.
        const double last = std::clamp(std::ceil(high) - 1, first, most);
        return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last)};
    }

    void cut_row(ClipPolygon rest, std::uint32_t y) {
        if (!rest.count) return;
        const auto [first, last] = cells(rest, &ClipPoint::u, chart_->width);
        const auto [inside_begin, inside_end] = whole_squares(rest, y);
        ClipPolygon square, above;
        for (std::uint32_t x = first; x < last && rest.count; ++x) {
            if (x >= inside_begin && x < inside_end) {
                for (; x < inside_end; ++x) add(x, y, square_share_);
                cut_polygon(rest, &ClipPoint::u, x, square, above);
                rest = above;
                if (x >= last) break;
            }
            cut_polygon(rest, &ClipPoint::u, x + 1.0, square, above);
            add(x, y, square.share());
            rest = above;
        }
        if (rest.count) add(last, y, rest.share());
    }

    /// Columns [begin, end) whose squares lie in the row's polygon whole: between its two slanted sides.
    static std::pair<std::uint32_t, std::uint32_t> whole_squares(const ClipPolygon& row, std::uint32_t y) {
        double left = -1e30, right = 1e30;
        for (const std::uint32_t line : {y, y + 1}) {
            double low = 1e30, high = -1e30;
            for (std::size_t i = 0; i < row.count; ++i)
                if (row.points[i].v == static_cast<double>(line)) {
                    low = std::min(low, row.points[i].u);
                    high = std::max(high, row.points[i].u);
                }
            if (low > high) return {0, 0};
            left = std::max(left, low);
            right = std::min(right, high);
        }
        const double begin = std::ceil(left), end = std::floor(right);
        if (end <= begin) return {0, 0};
        return {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
    }

    void add(std::uint32_t x, std::uint32_t y, double share) {
        const auto area = static_cast<float>(area_m2_ * share);
        // Below this, cutting the fragment out again on its own (FragmentPolygon) may find nothing left of it.
        constexpr double smallest_share = 1e-12;
        if (share < smallest_share || !(area > 0)) return;
        out_.push_back(
            {triangle_, static_cast<std::uint16_t>(chart_->x + x), static_cast<std::uint16_t>(chart_->y + y), area});
    }

    const Scene& scene_;
    const Atlas& atlas_;
    std::vector<Fragment>& out_;
    std::uint32_t triangle_ = 0;
    const Chart* chart_ = nullptr;
    double area_m2_ = 0, square_share_ = 0;
};

/// Fragments of one page sorted by texel; inside a texel they keep the order of triangles.
PageTexels sort_into_texels(const std::vector<std::vector<Fragment>>& parts, const std::vector<std::size_t>& of_page,
                            std::uint32_t page_size, const Atlas& atlas) {
    PageTexels page;
    const std::size_t squares = std::size_t{page_size} * page_size;
    std::vector<std::uint32_t> begin(squares + 1, 0);
    const auto square = [&](const Fragment& f) { return std::size_t{f.y} * page_size + f.x; };
    for (const std::size_t part : of_page)
        for (const Fragment& f : parts[part]) ++begin[square(f) + 1];
    for (std::size_t s = 0; s < squares; ++s) begin[s + 1] += begin[s];
    page.fragments.resize(begin[squares]);
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (const std::size_t part : of_page)
        for (const Fragment& f : parts[part]) page.fragments[next[square(f)]++] = f;
    for (std::size_t s = 0; s < squares; ++s) {
        if (begin[s] == begin[s + 1]) continue;
        Texel& texel = page.texels.emplace_back();
        texel.x = static_cast<std::uint16_t>(s % page_size);
        texel.y = static_cast<std::uint16_t>(s / page_size);
        texel.first_fragment = begin[s];
        texel.fragment_count = begin[s + 1] - begin[s];
        texel.chart = atlas.triangle_chart[page.fragments[begin[s]].triangle];
    }
    return page;
}

}  // namespace

TexelSet raster_texels(const Scene& scene, const Atlas& atlas) {
    // Parts of charts, so that one chart over a whole page does not keep a single thread busy.
    struct Part {
        std::uint32_t chart, begin, end;
    };
    constexpr std::uint32_t part_triangles = 1024;
    std::vector<Part> parts;
    std::vector<std::vector<std::size_t>> parts_of_page(atlas.page_count);
    for (std::uint32_t c = 0; c < atlas.charts.size(); ++c) {
        const Chart& chart = atlas.charts[c];
        for (std::uint32_t begin = chart.first; begin < chart.first + chart.count; begin += part_triangles) {
            parts_of_page[chart.page].push_back(parts.size());
            parts.push_back({c, begin, std::min(begin + part_triangles, chart.first + chart.count)});
        }
    }
    std::vector<std::vector<Fragment>> fragments(parts.size());
    parallel_for(parts.size(), 4, [&](std::size_t p) {
        TriangleCutter cutter(scene, atlas, fragments[p]);
        for (std::uint32_t i = parts[p].begin; i < parts[p].end; ++i) cutter.cut(atlas.chart_triangles[i]);
    });
    TexelSet set;
    set.page_size = atlas.page_size;
    set.pages.resize(atlas.page_count);
    parallel_for(atlas.page_count, 1, [&](std::size_t page) {
        set.pages[page] = sort_into_texels(fragments, parts_of_page[page], atlas.page_size, atlas);
        for (const std::size_t p : parts_of_page[page]) std::vector<Fragment>().swap(fragments[p]);
    });
    for (PageTexels& page : set.pages)
        parallel_for(page.texels.size(), 1024, [&](std::size_t t) { average_texel(scene, atlas, page, page.texels[t]); });
    return set;
}

}  // namespace luxel
