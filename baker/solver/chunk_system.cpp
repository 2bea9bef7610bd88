#include "baker/solver/chunk_system.h"

#include <algorithm>
#include <cmath>

#include "baker/core/parallel.h"

namespace luxel {

namespace {

/// A part below this many pairs is not worth a task; more than 8 parts cost more in adding up than they gain.
constexpr std::size_t part_pairs = 65536;
constexpr std::size_t max_parts = 8;
constexpr std::size_t range_patches = 1024;

std::vector<std::size_t> split_rows(const Block& block) {
    const std::size_t rows = block.row_begin.size() - 1;
    const std::size_t pairs = block.columns.size();
    const std::size_t parts = std::clamp<std::size_t>(pairs / part_pairs, 1, max_parts);
    std::vector<std::size_t> boundaries{0};
    for (std::size_t part = 1; part < parts; ++part) {
        const std::size_t pair = pairs * part / parts;
        const auto row = std::lower_bound(block.row_begin.begin(), block.row_begin.end(), pair);
        boundaries.push_back(std::min(rows, static_cast<std::size_t>(row - block.row_begin.begin())));
    }
    boundaries.push_back(rows);
    return boundaries;
}

Lanes dot(std::span<const Lanes> x, std::span<const Lanes> y) {
    Lanes sum;
    for (std::size_t i = 0; i < x.size(); ++i)
        for (std::size_t c = 0; c < 4; ++c) sum.v[c] += x[i].v[c] * y[i].v[c];
    return sum;
}

}  // namespace

ChunkSystem::ChunkSystem(const Transport& transport, ChunkNumber chunk, const Block* diagonal)
    : chunk_(chunk), diagonal_(diagonal), scale_(transport.size(chunk)) {
    for (std::size_t i = 0; i < scale_.size(); ++i) {
        const PatchNumber patch = transport.first(chunk) + static_cast<PatchNumber>(i);
        for (std::size_t c = 0; c < 3; ++c)
            scale_[i].v[c] = std::sqrt(transport.scaled_reflectance(patch)[c] / transport.area_m2(patch));
    }
    if (diagonal_ == nullptr) return;
    part_rows_ = split_rows(*diagonal_);
    part_sums_.resize(part_rows_.size() - 2);  // the first part adds to the result itself
}

void ChunkSystem::multiply(std::span<const Lanes> x, std::vector<Lanes>& y) const {
    y.assign(size(), Lanes{});
    if (diagonal_ == nullptr) return;
    const std::size_t parts = part_rows_.size() - 1;
    parallel_for(parts, 1, [&](std::size_t part) {
        std::vector<Lanes>& target = part == 0 ? y : part_sums_[part - 1];
        if (part > 0) target.assign(size(), Lanes{});
        apply_diagonal(*diagonal_, part_rows_[part], part_rows_[part + 1], x, target);
    });
    if (parts == 1) return;
    parallel_ranges(size(), range_patches, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (const std::vector<Lanes>& part : part_sums_)
            for (std::size_t i = begin; i < end; ++i)
                for (std::size_t c = 0; c < 4; ++c) y[i].v[c] += part[i].v[c];
    });
}

/// out = (I - s G s) x
void ChunkSystem::apply(std::span<const Lanes> x, std::vector<Lanes>& scaled, std::vector<Lanes>& out) const {
    scaled.resize(size());
    for (std::size_t i = 0; i < size(); ++i)
        for (std::size_t c = 0; c < 4; ++c) scaled[i].v[c] = scale_[i].v[c] * x[i].v[c];
    multiply(scaled, out);
    for (std::size_t i = 0; i < size(); ++i)
        for (std::size_t c = 0; c < 4; ++c) out[i].v[c] = x[i].v[c] - scale_[i].v[c] * out[i].v[c];
}

std::uint32_t ChunkSystem::solve(std::span<const Lanes> right_hand_side, std::vector<Lanes>& y, const Stop& stop,
                                 std::uint32_t max_iterations) const {
    std::vector<Lanes> scaled, product, residual(size());
    apply(y, scaled, product);
    for (std::size_t i = 0; i < size(); ++i)
        for (std::size_t c = 0; c < 4; ++c) residual[i].v[c] = right_hand_side[i].v[c] - product[i].v[c];
    std::vector<Lanes> direction = residual;
    Lanes rr = dot(residual, residual);
    std::uint32_t iteration = 0;
    for (; iteration < max_iterations && !stop(residual); ++iteration) {
        apply(direction, scaled, product);
        const Lanes curvature = dot(direction, product), length = dot(direction, direction);
        Lanes step, blend;
        bool moves = false;
        for (std::size_t c = 0; c < 4; ++c) {
            // The share 1e-13 is rounding: below it the matrix is not positive as far as can be told.
            const bool good = rr.v[c] > 0 && curvature.v[c] > 1e-13 * length.v[c];
            step.v[c] = good ? rr.v[c] / curvature.v[c] : 0.0;
            moves = moves || good;
        }
        if (!moves) break;
        for (std::size_t i = 0; i < size(); ++i)
            for (std::size_t c = 0; c < 4; ++c) {
                y[i].v[c] += step.v[c] * direction[i].v[c];
                residual[i].v[c] -= step.v[c] * product[i].v[c];
            }
        const Lanes next = dot(residual, residual);
        for (std::size_t c = 0; c < 4; ++c) blend.v[c] = step.v[c] > 0 ? next.v[c] / rr.v[c] : 0.0;
        for (std::size_t i = 0; i < size(); ++i)
            for (std::size_t c = 0; c < 4; ++c)
                direction[i].v[c] = step.v[c] > 0 ? residual[i].v[c] + blend.v[c] * direction[i].v[c] : 0.0;
        rr = next;
    }
    return iteration;
}

}  // namespace luxel
