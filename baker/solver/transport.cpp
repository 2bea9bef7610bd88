#include "baker/solver/transport.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "formats/base/error.h"

namespace luxel {

namespace {

/// Below it a patch sends what it gets back to itself for ever, as far as double precision can tell.
constexpr double smallest_self_factor = 1e-12;

void check(const BlockSource& source, std::span<const Rgb> reflectance) {
    const std::size_t count = source.layout().patch_count();
    if (reflectance.size() != count || source.area_m2().size() != count || source.diagonal_m2().size() != count)
        throw Error(ErrorCode::internal, "solve", "areas, diagonal and reflectance need one entry per patch");
    for (std::size_t i = 0; i < count; ++i) {
        for (int c = 0; c < 3; ++c)
            if (!(reflectance[i][c] >= 0 && reflectance[i][c] <= 1))
                throw Error(ErrorCode::bad_input, "solve, patch " + std::to_string(i),
                            "reflectance " + std::to_string(reflectance[i][c]) + " is not between 0 and 1");
        if (!(source.area_m2()[i] > 0 && std::isfinite(source.area_m2()[i]) && std::isfinite(source.diagonal_m2()[i])))
            throw Error(ErrorCode::damaged_store, "solve, patch " + std::to_string(i),
                        "area must be positive and the diagonal finite");
    }
}

}  // namespace

Transport::Transport(BlockSource& source, std::span<const Rgb> reflectance, const std::array<bool, 3>& channel_is_lit)
    : source_(source), reflectance_(reflectance) {
    check(source, reflectance);
    scaled_.resize(reflectance.size());
    for (std::size_t i = 0; i < scaled_.size(); ++i) {
        const auto patch = static_cast<PatchNumber>(i);
        for (std::size_t c = 0; c < 3; ++c)
            scaled_[i][c] = channel_is_lit[c] ? this->reflectance(patch, c) / self_factor(patch, c) : 0.0;
    }
    const ChunkNumber chunk_count = layout().chunk_count();
    rows_.resize(chunk_count);
    diagonal_.assign(chunk_count, no_block);
    row_bytes_.assign(chunk_count, 0);
    for (std::size_t k = 0; k < blocks().size(); ++k) {
        const BlockInfo& block = blocks()[k];
        row_bytes_[block.a] += block.read_bytes;
        if (block.a == block.b) {
            diagonal_[block.a] = k;
            continue;
        }
        row_bytes_[block.b] += block.read_bytes;
        rows_[block.a].push_back({k, block.b, true});
        rows_[block.b].push_back({k, block.a, false});
    }
}

double Transport::reflectance(PatchNumber patch, std::size_t channel) const {
    return reflectance_[patch][static_cast<int>(channel)];
}

double Transport::self_factor(PatchNumber patch, std::size_t channel) const {
    const double factor = 1 - reflectance(patch, channel) * diagonal_m2(patch) / area_m2(patch);
    return std::max(factor, smallest_self_factor);
}

std::shared_ptr<const Block> Transport::load(std::size_t block_index) {
    requested_bytes_ += blocks()[block_index].read_bytes;
    return source_.share(block_index);
}

std::shared_ptr<const Block> Transport::load_diagonal(ChunkNumber chunk) {
    return has_diagonal(chunk) ? load(diagonal_[chunk]) : nullptr;
}

void Transport::expect_row(ChunkNumber chunk) {
    std::vector<std::size_t> indexes;
    for (const RowBlock& block : rows_[chunk]) indexes.push_back(block.index);
    source_.expect(indexes);
}

}  // namespace luxel
