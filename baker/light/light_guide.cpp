#include "baker/light/light_guide.h"

#include <algorithm>
#include <cmath>

#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/units.h"
#include "baker/formfactors/sky_bins.h"

namespace luxel {
namespace {

constexpr std::uint32_t side = LightGuides::side, cells = LightGuides::cells;

std::uint32_t cell_of(const Vec2f& square) {
    const auto step = [](float x) {
        return static_cast<std::uint32_t>(std::clamp(x * static_cast<float>(side), 0.0f, static_cast<float>(side) - 0.5f));
    };
    return step(square.y) * side + step(square.x);
}

/// What the patches of one chunk receive, by direction.
class ChunkGuides {
  public:
    /// `brightest`: the largest of what any patch reflects, and pi times the sky.
    ChunkGuides(const PatchSet& patches, PatchNumber first, std::uint32_t count, float brightest)
        : patches_(patches), first_(first), received_(std::size_t{count} * cells, 0), sums_(count) {
        // Whole numbers of a unit far below what counts: their sums do not depend on the order of blocks.
        for (std::uint32_t k = 0; k < count; ++k)
            per_unit_.push_back(brightest > 0 ? 0x1p40 / (static_cast<double>(patches.patches[first + k].area_m2) * static_cast<double>(brightest)) : 0);
    }

    /// Patch `to` of the chunk exchanges `area_m2` with patch `from`, which reflects and emits so much. Both have an extent: what
    /// is reflected is laid on four directions between different parts of them.
    void add(PatchNumber to, PatchNumber from, float area_m2, float reflected, float emitted) {
        const Patch &here = patches_.patches[to], &there = patches_.patches[from];
        if (here.is_back) return;
        const std::uint32_t local_number = to - first_;
        const auto area = static_cast<double>(area_m2);
        sums_[local_number].reflected += area * static_cast<double>(reflected);
        sums_[local_number].emitted += area * static_cast<double>(emitted);
        const auto amount = static_cast<std::int64_t>(area * static_cast<double>(reflected) * per_unit_[local_number]);
        if (amount <= 0) return;
        const Frame own(here.normal), other(there.normal);
        const float own_step = 0.29f * std::sqrt(here.area_m2), other_step = 0.29f * std::sqrt(there.area_m2);
        constexpr std::array<std::array<float, 4>, 4> corners{{{1, 1, 1, -1}, {-1, -1, -1, 1}, {1, -1, -1, -1}, {-1, 1, 1, 1}}};
        for (const auto& corner : corners) {
            const Vec3f start = here.center + (own.tangent * corner[0] + own.bitangent * corner[1]) * own_step;
            const Vec3f end = there.center + (other.tangent * corner[2] + other.bitangent * corner[3]) * other_step;
            const Vec3f way = end - start;
            const float length = way.length();
            if (!(length > 0)) continue;
            const Vec3f local = own.to_local(way) / length;
            if (local.z > 0) received_[std::size_t{local_number} * cells + cell_of(cosine_square(local))] += amount;
        }
    }

    /// Of its rays that went into the open, these shares did so in bins of so many nits.
    void add_sky(PatchNumber to, const SkyInView& sky, std::span<const SkyBin> bins, std::span<const std::uint16_t> counts) {
        const Patch& here = patches_.patches[to];
        if (here.is_back) return;
        const std::uint32_t local_number = to - first_;
        const Frame own(here.normal);
        for (std::size_t k = 0; k < bins.size(); ++k) {
            const double area = static_cast<double>(here.area_m2) * counts[k] / sky.rays();
            const double received = area * pi * static_cast<double>(luminance(sky.bin_nits()[bins[k]]));
            sums_[local_number].reflected += received;
            const auto amount = static_cast<std::int64_t>(received * per_unit_[local_number]);
            if (amount <= 0) continue;
            for (const Vec3f& direction : directions_in_sky_bin(bins[k])) {
                const Vec3f local = own.to_local(direction);
                if (local.z > 0) received_[std::size_t{local_number} * cells + cell_of(cosine_square(local))] += amount;
            }
        }
    }

    /// Weights of every patch, the largest cell 255; all 0 where nothing arrives.
    void write(std::uint8_t* weights, float* emitted_shares) const {
        for (std::size_t k = 0; k < sums_.size(); ++k) {
            const double all = sums_[k].reflected + sums_[k].emitted;
            emitted_shares[k] = all > 0 ? static_cast<float>(sums_[k].emitted / all) : 0.0f;
            const std::array<double, cells> smooth = blurred(received_.data() + k * cells);
            const double largest = *std::max_element(smooth.begin(), smooth.end());
            if (!(largest > 0)) continue;
            for (std::uint32_t c = 0; c < cells; ++c)
                weights[k * cells + c] = static_cast<std::uint8_t>(smooth[c] / largest * 255 + 0.5);
        }
    }

  private:
    /// Over neighbouring cells, 1 : 2 : 1 along both sides: a row of few rays is noisy, and the guide serves points around the
    /// one that it was made for.
    static std::array<double, cells> blurred(const std::int64_t* from) {
        std::array<double, cells> across, both;
        const auto at = [](std::uint32_t x, int step) {
            return static_cast<std::uint32_t>(std::clamp(static_cast<int>(x) + step, 0, static_cast<int>(side) - 1));
        };
        for (std::uint32_t y = 0; y < side; ++y)
            for (std::uint32_t x = 0; x < side; ++x)
                across[y * side + x] = static_cast<double>(from[y * side + at(x, -1)] + 2 * from[y * side + x] + from[y * side + at(x, 1)]);
        for (std::uint32_t y = 0; y < side; ++y)
            for (std::uint32_t x = 0; x < side; ++x)
                both[y * side + x] = across[at(y, -1) * side + x] + 2 * across[y * side + x] + across[at(y, 1) * side + x];
        return both;
    }

    const PatchSet& patches_;
    PatchNumber first_;
    std::vector<double> per_unit_;  ///< per patch
    std::vector<std::int64_t> received_;
    struct Sums {
        double reflected = 0, emitted = 0;  ///< the sky is part of the former
    };
    std::vector<Sums> sums_;
};

}  // namespace

LightGuides::LightGuides(BlockSource& source, const PatchSet& patches, std::span<const float> reflected,
                         std::span<const float> emitted, const SkyInView* sky)
    : weights_(patches.count() * cells, 0), emitted_share_(patches.count(), 0) {
    const ChunkLayout& layout = source.layout();
    std::vector<std::vector<std::size_t>> blocks(layout.chunk_count());
    for (std::size_t k = 0; k < source.blocks().size(); ++k) {
        const BlockInfo& info = source.blocks()[k];
        blocks[info.a].push_back(k);
        if (info.b != info.a) blocks[info.b].push_back(k);
    }
    float brightest = reflected.empty() ? 0.0f : *std::max_element(reflected.begin(), reflected.end());
    if (sky)
        for (const Rgb& nits : sky->bin_nits()) brightest = std::max(brightest, static_cast<float>(pi) * luminance(nits));
    parallel_isolated(layout.chunk_count(), [&](std::size_t c) {
        const auto chunk = static_cast<ChunkNumber>(c);
        const PatchNumber first = layout.first_patch[chunk];
        ChunkGuides guides(patches, first, layout.size(chunk), brightest);
        Block block;
        for (const std::size_t k : blocks[c]) {
            source.load(k, block);
            for (std::uint32_t row = 0; row + 1 < block.row_begin.size(); ++row) {
                const PatchNumber i = layout.first_patch[block.a] + row;
                for (std::uint32_t e = block.row_begin[row]; e < block.row_begin[row + 1]; ++e) {
                    const PatchNumber j = layout.first_patch[block.b] + block.columns[e];
                    if (block.a == chunk) guides.add(i, j, block.areas_m2[e], reflected[j], emitted[j]);
                    if (block.b == chunk) guides.add(j, i, block.areas_m2[e], reflected[i], emitted[i]);
                }
            }
        }
        if (sky)
            sky->visit(first, first + layout.size(chunk), [&](PatchNumber patch, std::span<const SkyBin> bins, std::span<const std::uint16_t> counts) {
                guides.add_sky(patch, *sky, bins, counts);
            });
        guides.write(weights_.data() + std::size_t{first} * cells, emitted_share_.data() + first);
    });
}

GuideWarp::GuideWarp(std::span<const std::uint8_t, cells> weights) {
    std::uint32_t total = 0, squares = 0;
    for (const std::uint32_t weight : weights) total += weight, squares += weight * weight;
    if (total == 0) return;
    is_plain_ = false;
    // Even light is best asked for evenly: a stratified pattern is far better at it than its mixture with a table.
    const float mean = static_cast<float>(total) / static_cast<float>(cells);
    const float contrast = static_cast<float>(squares) / static_cast<float>(cells) / (mean * mean) - 1;
    const float guided_share = most_guided * contrast / (1 + contrast);
    const float plain = (1 - guided_share) / static_cast<float>(cells), guided = guided_share / static_cast<float>(total);
    double all = 0;
    for (std::uint32_t row = 0; row < side; ++row) {
        float* up_to = up_to_.data() + row * (side + 1);
        double sum = 0;
        std::array<double, side> sums;
        for (std::uint32_t x = 0; x < side; ++x)
            sums[x] = sum += static_cast<double>(plain + guided * static_cast<float>(weights[row * side + x]));
        for (std::uint32_t x = 0; x < side; ++x) up_to[x + 1] = static_cast<float>(sums[x] / sum);
        row_up_to_[row + 1] = static_cast<float>(all += sum);
    }
    row_up_to_[side] = 1;
}

namespace {

/// The step of a cumulative table that holds `value`, and how far into it.
struct Step {
    std::uint32_t index;
    float inside, probability;
};
Step step_at(const float* up_to, float value) {
    // Counting is faster than a search whose branches nobody can foretell.
    std::uint32_t k = 0;
    for (std::uint32_t step = 1; step < side; ++step) k += value >= up_to[step];
    const float probability = up_to[k + 1] - up_to[k];
    return {k, std::clamp((value - up_to[k]) / probability, 0.0f, 0x1.fffffep-1f), probability};
}

}  // namespace

GuideWarp::Point GuideWarp::bend(float u, float v) const {
    if (is_plain_) return {u, v, 1};
    const Step row = step_at(row_up_to_.data(), v);
    const Step column = step_at(up_to_.data() + row.index * (side + 1), u);
    return {(static_cast<float>(column.index) + column.inside) / side, (static_cast<float>(row.index) + row.inside) / side,
            row.probability * column.probability * static_cast<float>(cells)};
}

float GuideWarp::density(const Vec3f& local) const {
    if (is_plain_) return 1;
    const std::uint32_t cell = cell_of(cosine_square(local)), row = cell / side, x = cell % side;
    const float* up_to = up_to_.data() + row * (side + 1);
    return (row_up_to_[row + 1] - row_up_to_[row]) * (up_to[x + 1] - up_to[x]) * static_cast<float>(cells);
}

Frame guide_frame(const Frame& patch, const Vec3f& normal) {
    if (normal == patch.normal) return patch;
    Frame leant(normal);
    const Vec3f across = patch.tangent - normal * patch.tangent.dot(normal);
    const float length = across.length();
    if (!(length > 0.1f)) return leant;  // nearly along the normal: any frame will do
    leant.tangent = across / length;
    leant.bitangent = normal.cross(leant.tangent);
    return leant;
}

}  // namespace luxel
