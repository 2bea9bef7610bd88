#include "baker/bake/inspect.h"

#include <algorithm>
#include <cmath>

#include "baker/bake/stage_files.h"
#include "baker/core/parallel.h"
#include "baker/store/pooling.h"

namespace luxel {
namespace {

const StageEntry& need(const FolderListing& listing, const std::string& stage, const Key& key) {
    if (const StageEntry* entry = listing.find(stage, key)) return *entry;
    throw Error(ErrorCode::damaged_store, listing.root.string(), stage + "-" + key.text() + " is missing",
                "run the same bake again");
}

/// Sums over the rows of the stored matrix.
struct Rows {
    explicit Rows(std::size_t patches) : exchange_m2(patches), pairs(patches) {}
    std::vector<double> exchange_m2;
    std::vector<std::uint32_t> pairs;

    void add(const CountBlock& block, const ChunkLayout& layout, std::span<const double> mu) {
        const PatchNumber first_row = layout.first_patch[block.a], first_column = layout.first_patch[block.b];
        for (std::uint32_t row = 0; row + 1 < block.row_begin.size(); ++row)
            for (std::uint32_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k) {
                const PatchNumber i = first_row + row, j = first_column + block.columns[k];
                const double area_m2 = static_cast<double>(exchange_area(block.counts[k], mu[i], mu[j]));
                exchange_m2[i] += area_m2, exchange_m2[j] += area_m2;
                ++pairs[i], ++pairs[j];
            }
    }
};

Rows add_rows(const StoredMatrix& m, const ProgressFunction& progress) {
    constexpr std::size_t batch = 16;
    Rows rows(m.layout.patch_count());
    std::vector<CountBlock> blocks(batch);
    const std::size_t total = m.strips->block_count();
    for (std::size_t first = 0; first < total; first += batch) {
        const std::size_t count = std::min(batch, total - first);
        parallel_for(count, 1, [&](std::size_t k) { m.strips->load(first + k, blocks[k]); });
        for (std::size_t k = 0; k < count; ++k) rows.add(blocks[k], m.layout, m.closure.mu);
        if (progress) progress(first + count, total);
    }
    return rows;
}

void judge_rows(const StoredMatrix& m, const Rows& rows, MatrixInspection& out) {
    out.least_row = INFINITY;
    double surface_m2 = 0;
    for (PatchNumber p = 0; p < m.layout.patch_count(); ++p) {
        const double area_m2 = m.patches.area_m2[p], row_m2 = rows.exchange_m2[p] + m.closure.diagonal_m2[p];
        out.least_row = std::min(out.least_row, row_m2 / area_m2);
        out.most_row = std::max(out.most_row, row_m2 / area_m2);
        out.row_error = std::max(out.row_error, std::abs(row_m2 + m.closure.row_open_m2[p] - area_m2) / area_m2);
        surface_m2 += row_m2;
    }
    if (m.layout.patch_count() == 0) out.least_row = 0;
    out.mean_row = out.area_m2 > 0 ? surface_m2 / out.area_m2 : 0;
}

std::vector<StoredRow> largest(const StoredMatrix& m, const Rows& rows, std::size_t count) {
    std::vector<PatchNumber> order(m.layout.patch_count());
    for (PatchNumber p = 0; p < order.size(); ++p) order[p] = p;
    count = std::min(count, order.size());
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(), [&](PatchNumber a, PatchNumber b) {
        return rows.pairs[a] != rows.pairs[b] ? rows.pairs[a] > rows.pairs[b] : a < b;
    });
    std::vector<StoredRow> found;
    for (std::size_t k = 0; k < count; ++k) {
        const PatchNumber p = order[k];
        found.push_back({p, m.patches.ids[p], m.layout.chunk_of(p), rows.pairs[p], m.patches.area_m2[p]});
    }
    return found;
}

}  // namespace

const StageEntry* directory_of(const FolderListing& listing, const Key& strips) {
    return listing.find("strips", strips) ? nullptr : listing.find("directory", strips);
}

StoredMatrix::StoredMatrix(const FolderListing& listing, const Key& strip_key) : key(strip_key) {
    patches = load_patches(need(listing, "patches", key).path, key);
    layout.first_patch = patches.first_patch;
    auto closed = load_closure(need(listing, "closure", patches.closure).path, patches.closure, patches.ids.size());
    closure = std::move(*closed);
    if (const StageEntry* entry = directory_of(listing, key)) {
        directory = load_directory(entry->path, key);
        if (directory->tallies.rays.size() != patches.ids.size())
            throw Error(ErrorCode::damaged_store, entry->path.string(), "tallies of another number of patches", "run the same bake again");
        if (!directory->hot_bytes) return;
        const Key hot = BakeFolder::hot_key(key);
        strip_folder = need(listing, "hot", hot).path;
        strips = std::make_unique<StripStore>(strip_folder, hot, layout);
        return;
    }
    strip_folder = need(listing, "strips", key).path;
    strips = std::make_unique<StripStore>(strip_folder, key, layout);
    for (const Key& round : patches.evidence) {
        const auto folder = need(listing, "evidence", round).path;
        for (ChunkNumber c = 0; c < layout.chunk_count(); ++c) evidence.push_back({BakeFolder::evidence_file(folder, c), round});
    }
}

namespace {

void describe_store(const FolderListing& listing, const StoredMatrix& m, MatrixInspection& out) {
    if (m.strips) {
        out.kept_blocks = m.strips->block_count();
        out.kept_pairs = m.strips->pair_count();
        out.strip_bytes = m.strips->file_bytes();
    }
    if (m.is_whole()) {
        out.store = "all";
        out.blocks = out.kept_blocks;
        out.pairs = out.kept_pairs;
        return;
    }
    out.store = m.strips ? "hot" : "none";
    out.strip_bytes += directory_of(listing, m.key)->bytes;
    out.blocks = m.directory->blocks.size();
    for (const DirectoryBlock& block : m.directory->blocks) {
        out.pairs += block.pair_count;
        out.all_bytes += block.stored_bytes;
    }
}

}  // namespace

MatrixInspection inspect_matrix(const FolderListing& listing, const StoredMatrix& m, std::size_t largest_rows,
                                const ProgressFunction& progress) {
    MatrixInspection out;
    out.key = m.key;
    out.estimator = m.patches.estimator;
    out.patches = m.layout.patch_count();
    out.chunks = m.layout.chunk_count();
    for (ChunkNumber c = 0; c < out.chunks; ++c) {
        out.smallest_chunk = c ? std::min<std::uint64_t>(out.smallest_chunk, m.layout.size(c)) : m.layout.size(c);
        out.largest_chunk = std::max<std::uint64_t>(out.largest_chunk, m.layout.size(c));
    }
    describe_store(listing, m, out);
    out.possible_pairs = out.patches ? out.patches * (out.patches - 1) / 2 : 0;
    for (const Key& key : m.patches.evidence) {
        const StageEntry* entry = m.is_whole() ? &need(listing, "evidence", key) : nullptr;
        out.rounds.push_back({key, entry ? entry->files.size() : 0, entry ? entry->bytes : 0});
    }
    const auto& rays = m.tallies().rays;
    for (const std::uint32_t n : rays) out.rays += n;
    if (!rays.empty()) {
        out.least_rays = *std::min_element(rays.begin(), rays.end());
        out.most_rays = *std::max_element(rays.begin(), rays.end());
    }
    out.closure = m.closure.report;
    out.pairs_per_patch = out.patches ? 2.0 * static_cast<double>(out.pairs) / static_cast<double>(out.patches) : 0;
    for (const double area_m2 : m.patches.area_m2) out.area_m2 += area_m2;
    if (!m.is_whole()) return out;
    const Rows rows = add_rows(m, progress);
    judge_rows(m, rows, out);
    out.largest_rows = largest(m, rows, largest_rows);
    return out;
}

}  // namespace luxel
