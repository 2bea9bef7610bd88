#include "baker/solver/whole_read.h"

#include <algorithm>

#include "baker/core/parallel.h"

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

}  // namespace

std::vector<Lanes> exchange_between_chunks(Transport& transport, const ChunkVector& x, const BlockSeen& seen) {
    std::vector<Lanes> y(transport.layout().patch_count());
    std::vector<std::size_t> indexes;
    for (std::size_t k = 0; k < transport.blocks().size(); ++k)
        if (transport.blocks()[k].a != transport.blocks()[k].b) indexes.push_back(k);
    std::vector<Part> parts(transport_batch_blocks);
    for (std::size_t first = 0; first < indexes.size(); first += transport_batch_blocks) {
        const std::size_t batch = std::min(transport_batch_blocks, indexes.size() - first);
        parallel_for(batch, 1, [&](std::size_t k) {
            Block block;
            transport.load(indexes[first + k], block);
            Part& part = parts[k];
            part.a = block.a;
            part.b = block.b;
            part.y_a.assign(transport.size(block.a), Lanes{});
            part.y_b.assign(transport.size(block.b), Lanes{});
            const std::vector<Lanes> x_a = x(block.a);
            apply_both(block, x_a, x(block.b), part.y_a, part.y_b);
            if (seen) seen(indexes[first + k], x_a, part.y_a);
        });
        for (std::size_t k = 0; k < batch; ++k) {
            add(parts[k].y_a, y.data() + transport.first(parts[k].a));
            add(parts[k].y_b, y.data() + transport.first(parts[k].b));
        }
    }
    return y;
}

}  // namespace luxel
