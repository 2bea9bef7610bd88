#include "baker/solver/coarse_vectors.h"

#include <algorithm>
#include <cmath>

#include "baker/core/disjoint_sets.h"
#include "baker/core/parallel.h"

namespace luxel {
namespace {

/// Vectors need not be exact: what they lack is sent by shots.
constexpr double vector_accuracy = 0.01;
constexpr std::uint32_t most_iterations = 200;

/// X = pattern + K_kk X, up to vector_accuracy in the norm of the symmetric form (chunk_system.h).
std::vector<Lanes> inside_the_chunk(const ChunkSystem& system, std::vector<Lanes> pattern) {
    std::vector<Lanes> right, y(pattern.size());
    system.multiply(pattern, right);
    Lanes first;
    for (std::size_t i = 0; i < right.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            right[i].v[c] *= system.scale()[i].v[c];
            first.v[c] += right[i].v[c] * right[i].v[c];
        }
    const auto stop = [&](std::span<const Lanes> residual) {
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0;
            for (const Lanes& r : residual) sum += r.v[c] * r.v[c];
            if (sum > vector_accuracy * vector_accuracy * first.v[c]) return false;
        }
        return true;
    };
    system.solve(right, y, stop, most_iterations);
    for (std::size_t i = 0; i < pattern.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) pattern[i].v[c] += system.scale()[i].v[c] * y[i].v[c];
    return pattern;
}

/// rho' / A times what the chunk receives through one block if every patch of the other chunk has the radiosity rho'.
std::vector<Lanes> arriving(Transport& transport, ChunkNumber chunk, const RowBlock& from) {
    const std::shared_ptr<const Block> block = transport.load(from.index);
    std::vector<Lanes> bright(transport.size(from.other)), pattern(transport.size(chunk));
    for (std::size_t i = 0; i < bright.size(); ++i) {
        const Channels& reflect =
            transport.scaled_reflectance(transport.first(from.other) + static_cast<PatchNumber>(i));
        for (std::size_t c = 0; c < 3; ++c) bright[i].v[c] = reflect[c];
    }
    if (from.is_a)
        gather_rows(*block, bright, pattern);
    else
        scatter_columns(*block, bright, pattern);
    for (std::size_t i = 0; i < pattern.size(); ++i) {
        const PatchNumber patch = transport.first(chunk) + static_cast<PatchNumber>(i);
        for (std::size_t c = 0; c < 3; ++c)
            pattern[i].v[c] *= transport.scaled_reflectance(patch)[c] / transport.area_m2(patch);
    }
    return pattern;
}

}  // namespace

std::vector<Lanes> even_light(const Transport& transport, const ChunkSystem& system) {
    std::vector<Lanes> light(system.size());
    for (std::size_t i = 0; i < light.size(); ++i) {
        const PatchNumber patch = transport.first(system.chunk()) + static_cast<PatchNumber>(i);
        for (std::size_t c = 0; c < 3; ++c) light[i].v[c] = transport.scaled_reflectance(patch)[c];
    }
    return inside_the_chunk(system, std::move(light));
}

std::vector<std::vector<Lanes>> even_light_of_parts(const Transport& transport, const ChunkSystem& system,
                                                    const Block* diagonal) {
    if (!diagonal) return {};
    constexpr std::size_t most_parts = 4;
    DisjointSets sets(static_cast<std::uint32_t>(system.size()));
    for (std::uint32_t row = 0; row + 1 < diagonal->row_begin.size(); ++row)
        for (std::uint32_t k = diagonal->row_begin[row]; k < diagonal->row_begin[row + 1]; ++k)
            sets.unite(row, diagonal->columns[k]);
    std::vector<std::uint32_t> patches_of(system.size(), 0), roots;
    for (std::uint32_t i = 0; i < system.size(); ++i) ++patches_of[sets.find(i)];
    for (std::uint32_t i = 0; i < system.size(); ++i)
        if (patches_of[i] > 1) roots.push_back(i);
    std::stable_sort(roots.begin(), roots.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return patches_of[a] > patches_of[b]; });
    if (roots.size() > most_parts) roots.resize(most_parts);
    const std::vector<Lanes> all = even_light(transport, system);
    std::vector<std::vector<Lanes>> parts;
    for (const std::uint32_t part : roots) {
        std::vector<Lanes>& light = parts.emplace_back(all);
        for (std::uint32_t i = 0; i < light.size(); ++i)
            if (sets.find(i) != part) light[i] = Lanes{};
    }
    return parts;
}

std::vector<std::vector<Lanes>> neighbour_light(Transport& transport, const ChunkSystem& system, std::size_t most) {
    const std::span<const RowBlock> row = transport.row(system.chunk());
    std::vector<std::vector<Lanes>> patterns(row.size());
    parallel_for(row.size(), 1, [&](std::size_t k) { patterns[k] = arriving(transport, system.chunk(), row[k]); });
    std::vector<double> power(row.size(), 0.0);
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < row.size(); ++k) {
        for (std::size_t i = 0; i < system.size(); ++i) {
            const PatchNumber patch = transport.first(system.chunk()) + static_cast<PatchNumber>(i);
            for (std::size_t c = 0; c < 3; ++c) power[k] += transport.area_m2(patch) * patterns[k][i].v[c];
        }
        if (power[k] > 0) order.push_back(k);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return power[a] > power[b]; });
    std::vector<std::vector<Lanes>> vectors;
    for (std::size_t k = 0; k < order.size(); ++k) {
        if (k < most) {
            vectors.push_back(std::move(patterns[order[k]]));
            continue;
        }
        for (std::size_t i = 0; i < system.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) vectors.back()[i].v[c] += patterns[order[k]][i].v[c];
    }
    for (std::vector<Lanes>& vector : vectors) vector = inside_the_chunk(system, std::move(vector));
    return vectors;
}

}  // namespace luxel
