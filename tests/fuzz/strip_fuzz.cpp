/// Any blocks as the first of two strips: refused as a damaged store, or pairs within their chunks that are, written again, the
/// same.
#include <cstddef>

#include "baker/store/pooling.h"
#include "baker/store/strip_store.h"
#include "tests/fuzz/fuzz_file.h"

namespace luxel {
namespace {

const ChunkLayout layout{{0, 6, 76}};

struct Strips {
    RayTallies tallies;
    std::vector<BlockInfo> blocks;
    std::vector<CountBlock> counts;
};

Strips load(const std::filesystem::path& folder) {
    const StripStore store(folder, fuzz::key, layout);
    Strips strips{store.tallies(), {store.blocks().begin(), store.blocks().end()}, std::vector<CountBlock>(store.block_count())};
    for (std::size_t k = 0; k < store.block_count(); ++k) store.load(k, strips.counts[k]);
    return strips;
}

void check(const Strips& strips) {
    fuzz::require(strips.tallies.rays.size() == layout.patch_count());
    for (std::size_t k = 0; k < strips.counts.size(); ++k) {
        const CountBlock& block = strips.counts[k];
        fuzz::require(block.a <= block.b && block.b < layout.chunk_count() && block.row_begin.size() == layout.size(block.a) + 1u);
        fuzz::require(block.row_begin.front() == 0 && block.row_begin.back() == block.columns.size());
        fuzz::require(block.columns.size() == block.counts.size() && strips.blocks[k].pair_count == block.counts.size());
        for (std::uint32_t row = 0; row + 1 < block.row_begin.size(); ++row)
            for (std::uint32_t p = block.row_begin[row]; p < block.row_begin[row + 1]; ++p) {
                fuzz::require(block.columns[p] < layout.size(block.b) && block.counts[p] > 0);
                fuzz::require(p == block.row_begin[row] || block.columns[p - 1] < block.columns[p]);
                fuzz::require(block.a != block.b || block.columns[p] > row);
            }
    }
}

void write_again(const Strips& strips, ChunkNumber a, const std::filesystem::path& path) {
    const auto part = [&](const std::vector<std::uint32_t>& all) {
        return std::vector<std::uint32_t>(all.begin() + layout.first_patch[a], all.begin() + layout.first_patch[a + 1]);
    };
    const RayTallies& t = strips.tallies;
    StripWriter strip(path, fuzz::key, {part(t.rays), part(t.self), part(t.open), part(t.back)});
    for (const CountBlock& block : strips.counts)
        if (block.a == a)
            strip.append(block.b, block.counts.size(),
                         pack_pairs({layout.size(a), layout.size(block.b), block.row_begin, block.columns, block.counts}));
    strip.publish();
}

}  // namespace
}  // namespace luxel

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace luxel;
    const std::filesystem::path& folder = fuzz::scratch_folder();
    static const bool second_is_there = [&] {
        const std::vector<std::uint32_t> zero(layout.size(1));
        StripWriter(strip_path(folder, 1), fuzz::key, {zero, zero, zero, zero}).publish();
        return true;
    }();
    fuzz::require(second_is_there);
    test::write_contents(strip_path(folder, 0), fuzz::contents_from({data, size}, FileKind::strip, strip_version));
    Strips strips;
    if (!fuzz::accepts([&] { strips = load(folder); })) return 0;
    check(strips);
    write_again(strips, 0, strip_path(folder, 0));
    const Strips again = load(folder);
    fuzz::require(again.counts.size() == strips.counts.size() && again.tallies.rays == strips.tallies.rays);
    fuzz::require(again.tallies.self == strips.tallies.self && again.tallies.open == strips.tallies.open);
    fuzz::require(again.tallies.back == strips.tallies.back);
    for (std::size_t k = 0; k < again.counts.size(); ++k) {
        const CountBlock &x = again.counts[k], &y = strips.counts[k];
        fuzz::require(x.row_begin == y.row_begin && x.columns == y.columns && x.counts == y.counts);
    }
    return 0;
}
