#include "baker/solver/whole_read.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "baker/core/parallel.h"
#include "baker/solver/chunk_system.h"
#include "baker/solver/coarse_vectors.h"

namespace luxel {

namespace {

/// What one block contributes; added to the result in block order.
struct Part {
    ChunkNumber a = 0, b = 0;
    std::vector<Lanes> y_a, y_b;
};

void add(std::span<const Lanes> part, Lanes* target) {
    for (std::size_t i = 0; i < part.size(); ++i)
        for (std::size_t c = 0; c < 4; ++c) target[i].v[c] += part[i].v[c];
}

/// `apply(index, block, part)` fills part.y_a and part.y_b, which are zero before.
template <class Apply>
std::vector<Lanes> sum_over_blocks(Transport& transport, std::span<const std::size_t> indexes, const Apply& apply) {
    std::vector<Lanes> y(transport.layout().patch_count());
    std::vector<Part> parts(transport_batch_blocks);
    for (std::size_t first = 0; first < indexes.size(); first += transport_batch_blocks) {
        const std::size_t batch = std::min(transport_batch_blocks, indexes.size() - first);
        parallel_for(batch, 1, [&](std::size_t k) {
            const std::shared_ptr<const Block> loaded = transport.load(indexes[first + k]);
            const Block& block = *loaded;
            Part& part = parts[k];
            part.a = block.a;
            part.b = block.b;
            part.y_a.assign(transport.size(block.a), Lanes{});
            part.y_b.assign(transport.size(block.b), Lanes{});
            apply(indexes[first + k], block, part);
        });
        for (std::size_t k = 0; k < batch; ++k) {
            add(parts[k].y_a, y.data() + transport.first(parts[k].a));
            add(parts[k].y_b, y.data() + transport.first(parts[k].b));
        }
    }
    return y;
}

}  // namespace

std::vector<Lanes> exchange_between_chunks(Transport& transport, const ChunkVector& x, const BlockSeen& seen) {
    std::vector<std::size_t> indexes;
    for (std::size_t k = 0; k < transport.blocks().size(); ++k)
        if (transport.blocks()[k].a != transport.blocks()[k].b) indexes.push_back(k);
    return sum_over_blocks(transport, indexes, [&](std::size_t index, const Block& block, Part& part) {
        const std::vector<Lanes> x_a = x(block.a);
        apply_both(block, x_a, x(block.b), part.y_a, part.y_b);
        if (seen) seen(index, x_a, part.y_a);
    });
}

std::vector<Lanes> exchange_everywhere(Transport& transport, std::span<const Lanes> x) {
    std::vector<std::size_t> indexes(transport.blocks().size());
    std::iota(indexes.begin(), indexes.end(), std::size_t{0});
    return sum_over_blocks(transport, indexes, [&](std::size_t, const Block& block, Part& part) {
        const std::span<const Lanes> x_a = x.subspan(transport.first(block.a), transport.size(block.a));
        if (block.a == block.b)
            apply_diagonal(block, 0, part.y_a.size(), x_a, part.y_a);
        else
            apply_both(block, x_a, x.subspan(transport.first(block.b), transport.size(block.b)), part.y_a, part.y_b);
    });
}

namespace {

/// Where block k is in the rows of its chunks a and b.
std::vector<std::array<std::size_t, 2>> places_in_rows(const Transport& transport) {
    std::vector<std::array<std::size_t, 2>> places(transport.blocks().size());
    for (ChunkNumber chunk = 0; chunk < transport.layout().chunk_count(); ++chunk) {
        const std::span<const RowBlock> row = transport.row(chunk);
        for (std::size_t place = 0; place < row.size(); ++place)
            places[row[place].index][row[place].is_a ? 0 : 1] = place;
    }
    return places;
}

}  // namespace

std::vector<Lanes> exchange_and_columns(Transport& transport, std::span<const Lanes> x, CoarseSpace& space) {
    const ChunkNumber chunk_count = transport.layout().chunk_count();
    std::uint64_t entries = 0;
    for (ChunkNumber chunk = 0; chunk < chunk_count; ++chunk) entries += space.entries_of(chunk);
    if (entries > CoarseSpace::most_entries(x.size())) return exchange_everywhere(transport, x);
    const auto of_chunk = [&](ChunkNumber chunk) { return x.subspan(transport.first(chunk), transport.size(chunk)); };
    std::vector<std::vector<Lanes>> inside(chunk_count);
    std::vector<std::vector<std::vector<Lanes>>> light(chunk_count), own(chunk_count);  // per chunk and part of it
    parallel_for(chunk_count, 1, [&](std::size_t k) {
        const auto chunk = static_cast<ChunkNumber>(k);
        const std::shared_ptr<const Block> diagonal = transport.load_diagonal(chunk);
        const ChunkSystem system(transport, chunk, diagonal.get());
        system.multiply(of_chunk(chunk), inside[k]);
        light[k] = even_light_of_parts(transport, system, diagonal.get());
        own[k].resize(light[k].size());
        for (std::size_t part = 0; part < light[k].size(); ++part) system.multiply(light[k][part], own[k][part]);
    });
    std::vector<std::vector<std::size_t>> vectors(chunk_count);
    for (ChunkNumber chunk = 0; chunk < chunk_count; ++chunk)
        for (std::size_t part = 0; part < light[chunk].size(); ++part)
            if (const auto vector = space.add(chunk, light[chunk][part], own[chunk][part]))
                vectors[chunk].push_back(*vector);
    const auto places = places_in_rows(transport);
    std::vector<std::size_t> indexes;
    for (std::size_t k = 0; k < transport.blocks().size(); ++k)
        if (transport.blocks()[k].a != transport.blocks()[k].b) indexes.push_back(k);
    std::vector<Lanes> y = sum_over_blocks(transport, indexes, [&](std::size_t index, const Block& block, Part& part) {
        apply_both(block, of_chunk(block.a), of_chunk(block.b), part.y_a, part.y_b);
        for (const std::size_t vector : vectors[block.a]) {
            std::vector<Lanes> to_b(part.y_b.size());
            scatter_columns(block, space.radiosity(vector), to_b);
            space.set_column(vector, places[index][0], to_b);
        }
        for (const std::size_t vector : vectors[block.b]) {
            std::vector<Lanes> to_a(part.y_a.size());
            gather_rows(block, space.radiosity(vector), to_a);
            space.set_column(vector, places[index][1], to_a);
        }
    });
    for (ChunkNumber chunk = 0; chunk < chunk_count; ++chunk) add(inside[chunk], y.data() + transport.first(chunk));
    for (std::size_t v = 0; v < space.vector_count(); ++v) space.finish(v);
    return y;
}

}  // namespace luxel
