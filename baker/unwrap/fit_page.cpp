#include "baker/unwrap/fit_page.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace luxel {
namespace {

/// Whole texels for an extent. What sticks out by less than 1/64 texel is pressed in: texels that thin carry no light
/// worth having, and exact multiples that rounding has made a hair too long stay exact.
std::uint32_t whole_texels(double extent) {
    return static_cast<std::uint32_t>(std::max(1.0, std::ceil(extent - 1.0 / 64)));
}

bool fits(const FlatChart& chart, double texels_per_metre, std::uint32_t limit) {
    const Vec2d extent = extent_of(chart) * texels_per_metre;
    // Compare as numbers: an absurd extent must not overflow the integer.
    return extent.x < limit + 1.0 / 64 && extent.y < limit + 1.0 / 64;
}

void append_texel_chart(const FlatChart& chart, double texels_per_metre, std::vector<TexelChart>& out) {
    const Vec2d extent = extent_of(chart) * texels_per_metre;
    TexelChart& result = out.emplace_back();
    result.triangles = chart.triangles;
    result.width = whole_texels(extent.x);
    result.height = whole_texels(extent.y);
    const double w = result.width, h = result.height;
    const Vec2d press(extent.x > w ? w / extent.x : 1, extent.y > h ? h / extent.y : 1);
    result.corner_uv.resize(chart.corner_uv.size());
    for (std::size_t i = 0; i < chart.corner_uv.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2d p = chart.corner_uv[i][k] * texels_per_metre;
            result.corner_uv[i][k] = {static_cast<float>(std::clamp(p.x * press.x, 0.0, w)),
                                      static_cast<float>(std::clamp(p.y * press.y, 0.0, h))};
        }
}

FlatChart part_of(const FlatChart& chart, const std::vector<std::uint32_t>& triangles) {
    FlatChart part;
    part.triangles = triangles;
    for (const std::uint32_t t : triangles) {
        const auto at = std::lower_bound(chart.triangles.begin(), chart.triangles.end(), t) - chart.triangles.begin();
        part.corner_uv.push_back(chart.corner_uv[static_cast<std::size_t>(at)]);
    }
    orient(part);
    return part;
}

double largest_triangle(const FlatChart& chart) {
    double largest = 0;
    for (std::size_t i = 0; i < chart.triangles.size(); ++i) {
        const FlatChart single = part_of(chart, {chart.triangles[i]});
        const Vec2d extent = extent_of(single);
        largest = std::max({largest, extent.x, extent.y});
    }
    return largest;
}

/// Two lists of triangles, left and right of the middle of the longer side; by median where the middle does not divide.
std::array<std::vector<std::uint32_t>, 2> halves(const FlatChart& chart) {
    const Vec2d extent = extent_of(chart);
    const int axis = extent.x >= extent.y ? 0 : 1;
    std::vector<std::pair<double, std::uint32_t>> order;
    for (std::size_t i = 0; i < chart.triangles.size(); ++i) {
        const auto& uv = chart.corner_uv[i];
        order.emplace_back((uv[0][axis] + uv[1][axis] + uv[2][axis]) / 3, chart.triangles[i]);
    }
    std::sort(order.begin(), order.end());
    std::size_t cut = 0;
    while (cut < order.size() && order[cut].first < 0.5 * extent[axis]) ++cut;
    if (cut == 0 || cut == order.size()) cut = order.size() / 2;
    std::array<std::vector<std::uint32_t>, 2> result;
    for (std::size_t i = 0; i < order.size(); ++i) result[i < cut ? 0 : 1].push_back(order[i].second);
    for (auto& half : result) std::sort(half.begin(), half.end());
    return result;
}

/// Texels of a page that the chart's rectangle takes, with a gap.
double footprint(const FlatChart& chart, double texels_per_metre) {
    const Vec2d extent = extent_of(chart) * texels_per_metre;
    constexpr double gap = 2;
    return (std::ceil(extent.x) + gap) * (std::ceil(extent.y) + gap);
}

struct Parts {
    std::vector<FlatChart> charts;
    double footprint = 0;
};

/// Hollow charts (frames, skirting boards, angles) are cut into parts where that saves much of a large rectangle.
Parts compact_parts(const ObjectMesh& mesh, FlatChart chart, double texels_per_metre) {
    constexpr double worth_a_cut = 1024;  // texels; below that a seam costs more than it saves
    constexpr double full_enough = 0.5, saving_wanted = 0.6;
    const double whole = footprint(chart, texels_per_metre);
    double area = 0;
    for (const auto& uv : chart.corner_uv) area += 0.5 * std::abs(signed_area2(uv));
    Parts uncut;
    uncut.footprint = whole;
    if (chart.triangles.size() == 1 || whole < worth_a_cut ||
        area * texels_per_metre * texels_per_metre > full_enough * whole) {
        uncut.charts.push_back(std::move(chart));
        return uncut;
    }
    Parts cut;
    for (const auto& half : halves(chart))
        for (const auto& set : edge_connected_sets(mesh, half)) {
            Parts part = compact_parts(mesh, part_of(chart, set), texels_per_metre);
            cut.footprint += part.footprint;
            std::move(part.charts.begin(), part.charts.end(), std::back_inserter(cut.charts));
        }
    if (cut.footprint < saving_wanted * whole) return cut;
    uncut.charts.push_back(std::move(chart));
    return uncut;
}

void split_until_fit(const ObjectMesh& mesh, const FlatChart& chart, double texels_per_metre, std::uint32_t limit,
                     std::vector<TexelChart>& out) {
    if (chart.triangles.size() == 1 || fits(chart, texels_per_metre, limit)) {
        append_texel_chart(chart, texels_per_metre, out);
        return;
    }
    for (const auto& half : halves(chart))
        for (const auto& set : edge_connected_sets(mesh, half))
            split_until_fit(mesh, part_of(chart, set), texels_per_metre, limit, out);
}

}  // namespace

bool fit_chart(const ObjectMesh& mesh, FlatChart chart, double texels_per_metre, std::uint32_t limit,
               std::vector<TexelChart>& out) {
    bool any_smaller = false;
    for (const FlatChart& part : compact_parts(mesh, std::move(chart), texels_per_metre).charts) {
        double density = texels_per_metre;
        if (!fits(part, density, limit)) {
            const double largest = largest_triangle(part) * density;
            if (largest > limit) density *= limit / largest, any_smaller = true;
        }
        split_until_fit(mesh, part, density, limit, out);
    }
    return any_smaller;
}

bool fit_chart_whole(FlatChart chart, double texels_per_metre, std::uint32_t limit, std::vector<TexelChart>& out) {
    const Vec2d extent = extent_of(chart);
    const double largest = std::max(extent.x, extent.y) * texels_per_metre;
    const bool smaller = !fits(chart, texels_per_metre, limit);
    if (smaller) texels_per_metre *= limit / largest;
    append_texel_chart(chart, texels_per_metre, out);
    return smaller;
}

}  // namespace luxel
