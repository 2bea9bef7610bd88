/// What chunks cost: blocks, bytes and reads of the solve, with the same rays for all patches; and bytes per pair
/// when the patches inside chunks are put into other orders.
///
/// usage: chunk_bench SCENE [--chunks rooms|tiles] [--chunk-patches N] [--rays N] [--density T] [--atlas-size N]
/// [--patch-texels K]
///                          [--tolerance E] [--orders]
/// "own" is the share of pairs in the chunks' own blocks; "reads" are bytes read by a solve without a cache over bytes
/// of the store (a scene without light is given some); "fill" is patches per chunk over the limit. An order is the same
/// blocks with rows and columns permuted, encoded as the store does.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <numeric>

#include "baker/bake/solve_stage.h"
#include "baker/core/parallel.h"
#include "baker/solver/shoot.h"
#include "baker/store/closed_matrix.h"
#include "formats/bake/strip_file.h"

using namespace luxel;
namespace fs = std::filesystem;

namespace {

/// A block with the numbers of its chunks.
struct PlacedBlock {
    ChunkNumber a, b;
    StripPairs pairs;
};

std::vector<PlacedBlock> read_blocks(const fs::path& work) {
    std::vector<PlacedBlock> blocks;
    for (const auto& entry : fs::recursive_directory_iterator(work)) {
        if (entry.path().extension() != ".lxs") continue;
        const BlockFileReader file(entry.path(), FileKind::strip, strip_version);
        const auto a =
            static_cast<ChunkNumber>(std::stoul(entry.path().stem().string().substr(std::string("strip-").size())));
        const auto directory = read_strip_directory(file);
        for (std::size_t k = 0; k < directory.size(); ++k)
            blocks.push_back(
                {a, directory[k].b, unpack_pairs(file.read(first_pair_block + k), a == directory[k].b, file.name())});
    }
    return blocks;
}

using Cell = std::array<std::uint32_t, 3>;
constexpr std::uint32_t curve_bits = 16;

std::uint64_t interleave(const Cell& x) {
    std::uint64_t key = 0;
    for (std::uint32_t bit = curve_bits; bit-- > 0;)
        for (const std::uint32_t axis : x) key = 2 * key + (axis >> bit & 1u);
    return key;
}

/// Source: Skilling, Programming the Hilbert curve, AIP Conference Proceedings 707 (2004): axes to transpose.
std::uint64_t hilbert(Cell x) {
    constexpr std::uint32_t top = 1u << (curve_bits - 1);
    for (std::uint32_t q = top; q > 1; q >>= 1)
        for (std::uint32_t& axis : x) {
            if (axis & q) {
                x[0] ^= q - 1;
            } else {
                const std::uint32_t t = (x[0] ^ axis) & (q - 1);
                x[0] ^= t;
                axis ^= t;
            }
        }
    for (std::size_t k = 1; k < 3; ++k) x[k] ^= x[k - 1];
    std::uint32_t t = 0;
    for (std::uint32_t q = top; q > 1; q >>= 1)
        if (x[2] & q) t ^= q - 1;
    for (std::uint32_t& axis : x) axis ^= t;
    return interleave(x);
}

/// Per patch, what an order sorts a chunk's patches by; ties keep the order they have.
std::vector<std::uint64_t> curve_keys(const PatchSet& set, std::uint64_t (*curve)(Cell)) {
    Vec3f low(1e30f, 1e30f, 1e30f), high = -low;
    for (const Patch& patch : set.patches)
        for (int k = 0; k < 3; ++k)
            low[k] = std::min(low[k], patch.center[k]), high[k] = std::max(high[k], patch.center[k]);
    const float edge = std::max({high.x - low.x, high.y - low.y, high.z - low.z, 1e-9f});
    std::vector<std::uint64_t> keys;
    for (const Patch& patch : set.patches) {
        Cell cell;
        for (int k = 0; k < 3; ++k)
            cell[static_cast<std::size_t>(k)] =
                static_cast<std::uint32_t>((patch.center[k] - low[k]) / edge * 65535.0f);
        keys.push_back(curve(cell));
    }
    return keys;
}

/// Place in its chunk of every patch when chunks are sorted by `keys`.
std::vector<std::uint32_t> places(const ChunkLayout& layout, const std::vector<std::uint64_t>& keys) {
    std::vector<std::uint32_t> place(keys.size());
    for (ChunkNumber c = 0; c < layout.chunk_count(); ++c) {
        std::vector<PatchNumber> members(layout.size(c));
        std::iota(members.begin(), members.end(), layout.first_patch[c]);
        std::stable_sort(members.begin(), members.end(),
                         [&](PatchNumber a, PatchNumber b) { return keys[a] < keys[b]; });
        for (std::uint32_t k = 0; k < members.size(); ++k) place[members[k]] = k;
    }
    return place;
}

StripPairs permuted(const PlacedBlock& block, const ChunkLayout& layout, const std::vector<std::uint32_t>& place) {
    const StripPairs& from = block.pairs;
    std::vector<std::vector<std::pair<std::uint16_t, std::uint32_t>>> rows(from.rows);
    for (std::uint32_t r = 0; r < from.rows; ++r)
        for (std::uint32_t k = from.row_begin[r]; k < from.row_begin[r + 1]; ++k) {
            std::uint32_t row = place[layout.first_patch[block.a] + r],
                          column = place[layout.first_patch[block.b] + from.column[k]];
            if (block.a == block.b && row > column) std::swap(row, column);
            rows[row].emplace_back(static_cast<std::uint16_t>(column), from.count[k]);
        }
    StripPairs to{from.rows, from.columns, {0}, {}, {}};
    for (auto& row : rows) {
        std::sort(row.begin(), row.end());
        for (const auto& [column, count] : row) to.column.push_back(column), to.count.push_back(count);
        to.row_begin.push_back(static_cast<std::uint32_t>(to.column.size()));
    }
    return to;
}

void print_orders(const BakedGeometry& geometry, const std::vector<PlacedBlock>& blocks, double pairs) {
    std::vector<std::uint64_t> same(geometry.patches.count()), chart;
    for (const Patch& patch : geometry.patches.patches) chart.push_back(2 * patch.chart + patch.is_back);
    const auto morton_keys = curve_keys(geometry.patches, [](Cell c) { return interleave(c); });
    const auto hilbert_keys = curve_keys(geometry.patches, hilbert);
    auto charts_hilbert = hilbert_keys;
    for (std::size_t p = 0; p < chart.size(); ++p) charts_hilbert[p] |= chart[p] << 48;
    using Keys = std::vector<std::uint64_t>;
    const std::vector<std::pair<const char*, const Keys&>> orders{{"surface, raster", same},
                                                                  {"surface, Hilbert", charts_hilbert},
                                                                  {"Morton", morton_keys},
                                                                  {"Hilbert", hilbert_keys}};
    for (const auto& [name, keys] : orders) {
        const auto place = places(geometry.layout, keys);
        std::vector<std::uint64_t> bytes(blocks.size());
        parallel_for(blocks.size(), 1, [&](std::size_t k) {
            bytes[k] = pack_pairs(permuted(blocks[k], geometry.layout, place)).stored.size();
        });
        fmt::print("    {:<18} {:.3f} bytes/pair\n", name,
                   static_cast<double>(std::accumulate(bytes.begin(), bytes.end(), std::uint64_t{0})) / pairs);
    }
}

/// Bytes of all loads over bytes of the store, nothing cached.
double solve_reads(const BakedGeometry& geometry, const BakedMatrix& matrix, const BakedSources& sources,
                   double tolerance) {
    std::vector<Rgb> reflectance;
    std::vector<Channels> emission = sources.emission;
    const bool dark =
        std::all_of(emission.begin(), emission.end(), [](const Channels& m) { return m[0] + m[1] + m[2] == 0; });
    for (std::size_t p = 0; p < emission.size(); ++p) {
        const Patch& patch = geometry.patches.patches[p];
        reflectance.push_back(patch.reflectance);
        for (int c = 0; c < 3; ++c) reflectance.back()[c] = std::min(reflectance.back()[c], 0.99f);
        if (dark && patch.id % 256 == 0) emission[p] = {1, 1, 1};
    }
    ClosedMatrix source(*matrix.strips, matrix.area_m2, matrix.closure);
    SolveOptions solve;
    solve.tolerance = tolerance;
    return solve_by_shooting(source, {reflectance, emission}, solve).reads;
}

void run(const BakeOptions& o, const std::string& kind, bool orders) {
    BakeReport report;
    StageClock clock(o, report);
    const BakeFolder folder(o.work, o.output);
    const auto geometry = prepare_geometry(o, folder, clock, report);
    EvidenceRounds evidence(o, *geometry, folder);
    evidence.add(uniform_plan(geometry->patches.count(), o.replicates, o.rays), clock, report);
    MemoryPlan plan;
    plan.pooling_bytes = std::uint64_t{1} << 29;
    const BakedMatrix matrix = build_matrix(o, *geometry, evidence, folder, plan, clock, report);
    const double reads = solve_reads(*geometry, matrix, light_patches(o, *geometry, folder, clock, report), o.tolerance);
    const std::vector<PlacedBlock> blocks = read_blocks(o.work);
    double own = 0;
    for (const PlacedBlock& block : blocks)
        if (block.a == block.b) own += static_cast<double>(block.pairs.column.size());
    double chunk_seconds = 0;
    for (const StageReport& stage : report.stages) chunk_seconds += stage.name == "chunks" ? stage.seconds : 0;
    const auto pairs = static_cast<double>(report.pairs);
    fmt::print(
        "{} {} of {}: {} patches, {} chunks, fill {:.2f}, {} blocks, {:.2f} M pairs, own {:.1f} %, {:.3f} bytes/pair, "
        "reads {:.2f}; "
        "chunks {:.2f} s, evidence {:.1f} s\n",
        o.input.stem().string(), kind, o.chunk_patches, report.patches, report.chunks,
        static_cast<double>(report.patches) / static_cast<double>(report.chunks) / o.chunk_patches, report.blocks,
        pairs * 1e-6, 100 * own / pairs, static_cast<double>(report.store_bytes) / pairs, reads, chunk_seconds,
        report.evidence_seconds);
    if (orders) print_orders(*geometry, blocks, pairs);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("chunks and orders inside them");
    BakeOptions o;
    o.tolerance = 1e-3;
    o.rays = 256;
    std::string kind = "rooms";
    bool orders = false;
    app.add_option("scene", o.input)->required();
    app.add_option("--chunks", kind)->check(CLI::IsMember({"rooms", "tiles"}));
    app.add_option("--chunk-patches", o.chunk_patches);
    app.add_option("--rays", o.rays);
    app.add_option("--density", o.unwrap.texels_per_metre);
    app.add_option("--atlas-size", o.unwrap.page_size);
    app.add_option("--patch-texels", o.patch_texels);
    app.add_option("--tolerance", o.tolerance);
    app.add_flag("--orders", orders);
    CLI11_PARSE(app, argc, argv);
    o.chunks = kind == "tiles" ? ChunkKind::tiles : ChunkKind::rooms;
    const fs::path folder = fs::temp_directory_path() / fmt::format("chunk_bench-{}", ::getpid());
    fs::create_directories(folder);
    o.output = folder / "scene.glb";
    o.work = folder / "work";
    int status = 0;
    try {
        run(o, kind, orders);
    } catch (const Error& error) {
        fmt::print(stderr, "chunk_bench: {}\n", error.what());
        status = 1;
    }
    fs::remove_all(folder);
    return status;
}
