#include "baker/light/lamp_cells.h"

#include <algorithm>
#include <cmath>

namespace luxel {
namespace {

constexpr std::size_t most_cells = 256;
/// A piece is cut if the lamp is nearer than this times its extent, and then each cell if it is nearer than that times its own.
constexpr float near_piece = 1, near_cell = 2;
/// Beside the cosine: shading normals and spheres see a lamp that their triangle hardly does.
constexpr double least_cosine = 0.1;

}  // namespace

LampCells::Cell LampCells::cell(const SurfaceSampler& sampler, const Vec3f& lamp, float u, float v, float side) {
    const SurfacePoint middle = sampler.point(u + side / 2, v + side / 2);
    const Vec3f to_lamp = lamp - middle.position;
    Cell cell{u, v, side, to_lamp.length(), 0, 0};
    for (const float du : {0.0f, 0x1.fffffep-1f})
        for (const float dv : {0.0f, 0x1.fffffep-1f})
            cell.extent_m = std::max(cell.extent_m, (sampler.point(u + side * du, v + side * dv).position - middle.position).length());
    const double distance = std::max({static_cast<double>(cell.distance_m), static_cast<double>(cell.extent_m) / 2, 1e-30});
    const double cosine = std::max(0.0, static_cast<double>(to_lamp.dot(middle.normal)) / distance) + least_cosine;
    cell.light = static_cast<double>(side) * static_cast<double>(side) * cosine / (distance * distance);
    return cell;
}

LampCells::LampCells(const SurfaceSampler& sampler, const Vec3f& lamp) : cells_{cell(sampler, lamp, 0, 0, 1)} {
    if (cells_.front().distance_m >= near_piece * cells_.front().extent_m) return;
    // Those with most light first: where the piece is of several triangles cells along their edges never become small.
    const auto is_final = [](const Cell& c) { return c.distance_m >= near_cell * c.extent_m; };
    const auto before = [&](const Cell& a, const Cell& b) { return is_final(a) != is_final(b) ? is_final(a) : a.light < b.light; };
    while (cells_.size() < most_cells && !is_final(cells_.front())) {
        std::pop_heap(cells_.begin(), cells_.end(), before);
        const Cell whole = cells_.back();
        cells_.pop_back();
        const float half = whole.side / 2;
        for (const float dv : {0.0f, half})
            for (const float du : {0.0f, half}) {
                cells_.push_back(cell(sampler, lamp, whole.u + du, whole.v + dv, half));
                std::push_heap(cells_.begin(), cells_.end(), before);
            }
    }
    double total = 0, up_to = 0;
    for (const Cell& c : cells_) total += c.light;
    for (Cell& c : cells_) {
        up_to += even_share * static_cast<double>(c.side) * static_cast<double>(c.side) + (1 - even_share) * c.light / total;
        c.up_to = up_to;
    }
    for (Cell& c : cells_) c.up_to /= up_to;
}

LampCells::Place LampCells::place(float a, float b) const {
    const auto at = std::upper_bound(cells_.begin(), cells_.end() - 1, static_cast<double>(a), [](double value, const Cell& c) { return value < c.up_to; });
    if (is_even()) return {a, b, 1};
    const double before = at == cells_.begin() ? 0 : (at - 1)->up_to, share = at->up_to - before;
    const auto rest = static_cast<float>(std::clamp((static_cast<double>(a) - before) / share, 0.0, 0x1.fffffep-1));
    const double area = static_cast<double>(at->side) * static_cast<double>(at->side);
    return {at->u + at->side * rest, at->v + at->side * b, static_cast<float>(area / share)};
}

}  // namespace luxel
