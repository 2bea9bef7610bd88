/// Blocks traced again against the strips that pooling makes of the same rays.
#include "baker/store/traced_strips.h"

#include <gtest/gtest.h>

#include <numeric>

#include "baker/core/parallel.h"
#include "tests/unit/store/made_evidence.h"

namespace luxel {
namespace {

using test::MadeEvidence;
using test::TemporaryFolder;

/// Answers with made-up records as if it had traced them; counts how often it was asked.
class MadeEstimator final : public Estimator {
  public:
    explicit MadeEstimator(const MadeEvidence& made) {
        std::map<PatchId, PatchNumber> number;
        for (PatchNumber p = 0; p < made.ids.size(); ++p) number[made.ids[p]] = p;
        landings_.resize(made.ids.size());
        for (const EvidenceRecord& record : made.records) {
            replicates_ = std::max<std::uint32_t>(replicates_, record.replicate + 1u);
            auto& all = landings_[number.at(record.patch_id)];
            all.resize(std::max<std::size_t>(all.size(), record.replicate + std::size_t{1}));
            Landings& l = all[record.replicate];
            l.open += record.open;
            l.back += record.back;
            for (std::size_t k = record.count.size(); k-- > 0;) {  // in no particular order
                l.patches.push_back(number.at(record.target_id[k]));
                l.weights.push_back(record.count[k]);
            }
        }
    }
    void cast(PatchNumber patch, LevelRange, std::vector<Landings>& out) const override {
        ++casts_;
        out = landings_[patch];
    }
    [[nodiscard]] std::uint32_t replicate_count() const override { return replicates_; }
    [[nodiscard]] Key identity() const override { return {}; }
    [[nodiscard]] std::uint64_t casts() const { return casts_; }

  private:
    std::vector<std::vector<Landings>> landings_;
    std::uint32_t replicates_ = 1;
    mutable std::atomic<std::uint64_t> casts_{0};
};

/// The same rays pooled into strips, and ready to be traced again.
struct Made {
    explicit Made(const std::vector<std::uint32_t>& sizes, std::size_t targets = 9)
        : evidence(test::random_evidence(sizes, targets, 3, 5)),
          strips(pool(folder, evidence, test::write_evidence(folder.path(), evidence.records, 1000, 64), "strips")),
          store(strips, test::strip_key, evidence.layout),
          estimator(evidence) {}
    [[nodiscard]] LevelPlan levels() const { return {std::vector<LevelRange>(evidence.ids.size(), LevelRange{0, 10})}; }
    TemporaryFolder folder;
    MadeEvidence evidence;
    std::filesystem::path strips;
    StripStore store;
    MadeEstimator estimator;
};

void expect_equal_tallies(const RayTallies& found, const RayTallies& expected) {
    EXPECT_EQ(found.rays, expected.rays);
    EXPECT_EQ(found.self, expected.self);
    EXPECT_EQ(found.open, expected.open);
    EXPECT_EQ(found.back, expected.back);
}

void expect_equal(const MatrixStore& found, const StripStore& expected) {
    expect_equal_tallies(found.tallies(), expected.tallies());
    ASSERT_EQ(found.block_count(), expected.block_count());
    for (std::size_t k = 0; k < expected.block_count(); ++k) {
        const BlockInfo &a = found.blocks()[k], &b = expected.blocks()[k];
        EXPECT_EQ(std::tuple(a.a, a.b, a.pair_count, a.read_bytes), std::tuple(b.a, b.b, b.pair_count, b.read_bytes)) << "block " << k;
    }
    std::atomic<std::size_t> wrong{0};
    // Forwards and backwards at once, so that threads meet at the same chunks.
    parallel_for(2 * expected.block_count(), 1, [&](std::size_t k) {
        const std::size_t index = k % 2 ? k / 2 : expected.block_count() - 1 - k / 2;
        CountBlock x, y;
        found.load(index, x);
        expected.load(index, y);
        wrong += x.a != y.a || x.b != y.b || x.row_begin != y.row_begin || x.columns != y.columns || x.counts != y.counts;
    });
    EXPECT_EQ(wrong, 0u);
}

TEST(TracedStrips, EqualsTheStripsWhateverIsKeptInMemory) {
    for (const std::vector<std::uint32_t>& sizes :
         {std::vector<std::uint32_t>{1}, {2}, {40, 1, 30}, {5, 0, 7, 0}, {1, 1, 1, 1, 1, 1, 1, 1}, {300, 70, 129}}) {
        const Made made(sizes);
        for (const std::uint64_t limit : {std::uint64_t{0}, std::uint64_t{20000}, std::uint64_t{1} << 30})
            for (const unsigned threads : {1u, 2u}) {
                const ThreadLimit limited(threads);
                TracedRows rows(made.estimator, made.evidence.layout, made.levels(), limit);
                const TracedStrips traced(rows, find_directory(rows, {}), nullptr, 0);
                expect_equal(traced, made.store);
                EXPECT_LE(rows.held_bytes(), limit + 40000) << "one chunk stays whatever the limit";
            }
    }
}

TEST(TracedStrips, TracesOnceWhatFitsIntoMemory) {
    const Made made({200, 150, 180, 70, 90});
    TracedRows rows(made.estimator, made.evidence.layout, made.levels(), std::uint64_t{1} << 30);
    const TracedStrips traced(rows, find_directory(rows, {}), nullptr, 0);
    expect_equal(traced, made.store);
    EXPECT_EQ(made.estimator.casts(), made.evidence.ids.size());
    EXPECT_EQ(rows.rays_traced(), rows.rays_of_all());
    rows.forget();
    EXPECT_EQ(rows.held_bytes(), 0u);
    expect_equal(traced, made.store);
    EXPECT_EQ(rows.rays_traced(), 2 * rows.rays_of_all());
}

/// Chunks that all see each other. With room for a share 1/m of the rows a pass in order falls into m parts, each of which traces the
/// chunks that come after its first: (m + 1) / 2 of the scene, not one trace for every block.
TEST(TracedStrips, APassTracesByTheMemoryThatIsMissing) {
    const Made made(std::vector<std::uint32_t>(24, 40), 60);
    TracedRows all(made.estimator, made.evidence.layout, made.levels(), std::uint64_t{1} << 30);
    const StripDirectory directory = find_directory(all, {});
    const std::uint64_t bytes = all.held_bytes();
    ASSERT_EQ(directory.blocks.size(), 24u * 25 / 2);
    for (const std::uint32_t m : {2u, 3u, 6u}) {
        TracedRows rows(made.estimator, made.evidence.layout, made.levels(), bytes / m);
        const TracedStrips traced(rows, directory, nullptr, 0);
        CountBlock block;
        constexpr int passes = 5;
        for (int pass = 0; pass < passes; ++pass)
            for (std::size_t k = 0; k < traced.block_count(); ++k) traced.load(k, block);
        const double wholes = static_cast<double>(rows.rays_traced()) / passes / static_cast<double>(rows.rays_of_all());
        std::printf("1/%u of the rows in memory: a pass over all blocks traces %.2f of the scene\n", m, wholes);
        EXPECT_GT(wholes, 0.5) << "1/" << m << " of the rows in memory";
        EXPECT_LT(wholes, (m + 1) / 2.0 + 0.5) << "1/" << m << " of the rows in memory";
        EXPECT_LE(rows.held_bytes(), rows.limit_bytes());
    }
}

/// Chunks that see only their neighbours: with room for four of sixteen a pass in order traces each once.
TEST(TracedStrips, NeighboursStayInMemoryUntilTheyAreDone) {
    std::vector<std::uint32_t> sizes(16, 40);
    MadeEvidence evidence;
    for (const std::uint32_t size : sizes) evidence.layout.first_patch.push_back(evidence.layout.first_patch.back() + size);
    for (PatchNumber p = 0; p < evidence.layout.patch_count(); ++p) evidence.ids.push_back(p + 1);
    for (PatchNumber p = 0; p < evidence.layout.patch_count(); ++p) {
        EvidenceRecord record{p + 1, 0, 0, 6, 0, 0, {}, {}};
        for (const int step : {-60, -30, 30, 60})
            if (const int target = static_cast<int>(p) + step; target >= 0 && target < 640)
                record.target_id.push_back(static_cast<PatchId>(target + 1)), record.count.push_back(1);
        record.open = 64 - static_cast<std::uint32_t>(record.count.size());
        evidence.records.push_back(record);
    }
    const MadeEstimator estimator(evidence);
    const LevelPlan levels{std::vector<LevelRange>(640, LevelRange{0, 6})};
    TracedRows all(estimator, evidence.layout, levels, std::uint64_t{1} << 30);
    const StripDirectory directory = find_directory(all, {});
    TracedRows rows(estimator, evidence.layout, levels, all.held_bytes() / 16 * 4);
    const TracedStrips traced(rows, directory, nullptr, 0);
    CountBlock block;
    for (std::size_t k = 0; k < traced.block_count(); ++k) traced.load(k, block);
    EXPECT_LE(static_cast<double>(rows.rays_traced()), 1.13 * static_cast<double>(rows.rays_of_all()));
    EXPECT_LE(rows.held_bytes(), rows.limit_bytes());
}

TEST(TracedStrips, KeptBlocksAreReadAndNotTraced) {
    const Made made({60, 1, 50, 0, 80, 40});
    const Key hot{31, 32};
    for (const double share : {0.0, 0.1, 0.5, 1.0}) {
        TracedRows rows(made.estimator, made.evidence.layout, made.levels(), std::uint64_t{1} << 30);
        StripDirectory directory = find_directory(rows, {});
        std::uint64_t all = 0, kept_bytes = 0, kept_blocks = 0;
        for (const DirectoryBlock& block : directory.blocks) all += block.stored_bytes;
        const auto budget = static_cast<std::uint64_t>(share * static_cast<double>(all));
        const std::vector<bool> keep = blocks_to_keep(directory, rows, budget);
        for (std::size_t k = 0; k < keep.size(); ++k)
            if (keep[k]) kept_bytes += directory.blocks[k].stored_bytes, ++kept_blocks;
        EXPECT_LE(kept_bytes, budget);
        for (std::size_t k = 0; k < keep.size(); ++k)
            EXPECT_TRUE(keep[k] || directory.blocks[k].stored_bytes > budget - kept_bytes) << "block " << k << " would have fitted";
        const auto folder = made.folder / ("hot" + std::to_string(share));
        std::filesystem::create_directory(folder);
        keep_blocks(rows, directory, keep, folder, hot, {});
        // Only what is missing is made again.
        const Bytes first = read_file(strip_path(folder, 0));
        std::filesystem::remove(strip_path(folder, 0));
        keep_blocks(rows, directory, keep, folder, hot, {});
        EXPECT_EQ(read_file(strip_path(folder, 0)), first);

        const TracedStrips traced(rows, directory, std::make_unique<StripStore>(folder, hot, made.evidence.layout), 0);
        expect_equal(traced, made.store);
        if (share == 1.0) {
            EXPECT_EQ(rows.rays_traced(), rows.rays_of_all()) << "what directory, choice and blocks need is traced once";
        }
        rows.forget();
        const std::uint64_t before = made.estimator.casts();
        CountBlock block;
        for (std::size_t k = 0; k < keep.size(); ++k)
            if (keep[k]) traced.load(k, block);
        EXPECT_EQ(made.estimator.casts(), before);
        EXPECT_EQ(kept_blocks == keep.size(), share == 1.0);
    }
}

TEST(TracedStrips, KeepsWhatCostsMostRaysPerByte) {
    const Made made({10, 10, 10});
    LevelPlan levels = made.levels();
    for (PatchNumber p = 20; p < 30; ++p) levels.levels[p].last = 14;  // the third chunk has sixteen times the rays
    TracedRows rows(made.estimator, made.evidence.layout, levels, 0);
    StripDirectory directory;
    directory.blocks = {{0, 0, 5, 100}, {0, 1, 5, 100}, {0, 2, 5, 100}, {1, 1, 5, 10}, {1, 2, 5, 2000}, {2, 2, 5, 100}};
    const auto kept = [&](std::uint64_t budget) {
        std::string text;
        for (const bool keep : blocks_to_keep(directory, rows, budget)) text += keep ? '1' : '0';
        return text;
    };
    // Rays per byte: 0.01, 0.02, 0.17, 0.1, 0.0085, 0.16 in units of a chunk's 1,024.
    EXPECT_EQ(kept(0), "000000");
    EXPECT_EQ(kept(100), "001000");
    EXPECT_EQ(kept(200), "001001");
    EXPECT_EQ(kept(110), "001100") << "what does not fit is passed over";
    EXPECT_EQ(kept(310), "011101");
    EXPECT_EQ(kept(410), "111101");
    EXPECT_EQ(kept(2410), "111111");
}

ErrorCode code_of(const std::function<void()>& body) {
    try {
        body();
    } catch (const Error& error) {
        EXPECT_FALSE(error.hint.empty());
        return error.code;
    }
    return {};
}

/// Chunks that see much of their neighbours and a little of all others, as rooms do, with little memory: a quarter of the bytes
/// holds most of the small blocks, so that a row wants the rays of few chunks and not of the whole scene.
TEST(TracedStrips, AQuarterOfTheBytesSparesMostTraces) {
    constexpr std::uint32_t chunks = 24, size = 40, patches = chunks * size;
    MadeEvidence evidence;
    for (ChunkNumber c = 0; c < chunks; ++c) evidence.layout.first_patch.push_back((c + 1) * size);
    std::mt19937_64 random(3);
    for (PatchNumber p = 0; p < patches; ++p) evidence.ids.push_back(p + 1);
    for (PatchNumber p = 0; p < patches; ++p) {
        EvidenceRecord record{p + 1, 0, 0, 6, 0, 0, {}, {}};
        std::set<PatchId> met;
        while (met.size() < 30) met.insert((p + patches - size + random() % (2 * size)) % patches + 1);
        met.insert(random() % patches + 1);
        record.target_id.assign(met.begin(), met.end());
        record.count.assign(met.size(), 1);
        record.open = 64 - static_cast<std::uint32_t>(met.size());
        evidence.records.push_back(record);
    }
    const MadeEstimator estimator(evidence);
    const LevelPlan levels{std::vector<LevelRange>(patches, LevelRange{0, 6})};
    TracedRows all(estimator, evidence.layout, levels, std::uint64_t{1} << 30);
    const StripDirectory directory = find_directory(all, {});
    std::uint64_t bytes = 0;
    for (const DirectoryBlock& block : directory.blocks) bytes += block.stored_bytes;
    // For comparison the same bytes of the largest blocks, those with most pairs.
    std::vector<std::size_t> order(directory.blocks.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) {
        return directory.blocks[x].stored_bytes > directory.blocks[y].stored_bytes;
    });
    std::vector<bool> large(order.size());
    std::uint64_t left = bytes / 4;
    for (const std::size_t k : order)
        if (directory.blocks[k].stored_bytes <= left) large[k] = true, left -= directory.blocks[k].stored_bytes;

    const TemporaryFolder folder;
    const auto keep = [&](const std::vector<bool>& choice, const char* name) {
        const auto place = folder / name;
        std::filesystem::create_directory(place);
        keep_blocks(all, directory, choice, place, Key{31, 32}, {});
        return std::make_unique<StripStore>(place, Key{31, 32}, evidence.layout);
    };
    // Each chunk shoots once: its own block, then all others of its row.
    const auto wholes = [&](std::unique_ptr<StripStore> kept) {
        TracedRows rows(estimator, evidence.layout, levels, all.held_bytes() / 12);
        const TracedStrips traced(rows, directory, std::move(kept), 0);
        CountBlock block;
        for (ChunkNumber c = 0; c < chunks; ++c)
            for (std::size_t k = 0; k < traced.block_count(); ++k)
                if (traced.blocks()[k].a == c || traced.blocks()[k].b == c) traced.load(k, block);
        return static_cast<double>(rows.rays_traced()) / static_cast<double>(rows.rays_of_all());
    };
    const double none = wholes(nullptr), largest = wholes(keep(large, "large"));
    const double hot = wholes(keep(blocks_to_keep(directory, all, bytes / 4), "hot"));
    std::printf("1/12 of the rows in memory: a shot of every chunk traces the scene %.1f times, %.1f with a quarter of the bytes kept (%.1f if "
                "these are the largest blocks)\n", none, hot, largest);
    EXPECT_LT(hot, none / 2);
    EXPECT_LT(hot, largest);
}

TEST(TracedStrips, RefusesADirectoryOfOtherRays) {
    const Made made({30, 20});
    TracedRows rows(made.estimator, made.evidence.layout, made.levels(), 1 << 20);
    const StripDirectory whole = find_directory(rows, {});
    StripDirectory directory = whole;
    ++directory.blocks[1].pair_count;
    const TracedStrips traced(rows, directory, nullptr, 0);
    CountBlock block;
    traced.load(0, block);
    EXPECT_EQ(code_of([&] { traced.load(1, block); }), ErrorCode::damaged_store);
    directory = whole;
    directory.tallies.rays.pop_back();
    EXPECT_EQ(code_of([&] { TracedStrips(rows, directory, nullptr, 0); }), ErrorCode::damaged_store);
    directory = whole;
    directory.blocks.push_back({1, 2, 1, 1});
    EXPECT_EQ(code_of([&] { TracedStrips(rows, directory, nullptr, 0); }), ErrorCode::damaged_store);
    // Kept blocks that the directory does not have, or has with other sizes.
    directory = whole;
    directory.blocks.erase(directory.blocks.begin());
    const auto kept = [&] { return std::make_unique<StripStore>(made.strips, test::strip_key, made.evidence.layout); };
    EXPECT_EQ(code_of([&] { TracedStrips(rows, directory, kept(), 0); }), ErrorCode::damaged_store);
    directory = whole;
    ++directory.blocks[0].pair_count;
    EXPECT_EQ(code_of([&] { TracedStrips(rows, directory, kept(), 0); }), ErrorCode::damaged_store);
}

TEST(TracedStrips, RefusesCountsThatStripsCannotHold) {
    MadeEvidence evidence;
    evidence.layout.first_patch = {0, 1, 2};
    evidence.ids = {7, 8};
    evidence.records = {{7, 0, 0, 31, 0, 0, {8}, {1u << 31}}, {8, 0, 0, 31, 0, 0, {7}, {1u << 31}}};
    const MadeEstimator estimator(evidence);
    TracedRows rows(estimator, evidence.layout, {{2, LevelRange{0, 20}}}, 1 << 20);
    EXPECT_EQ(code_of([&] { find_directory(rows, {}); }), ErrorCode::damaged_store) << "of a pair";
    evidence.records.push_back({7, 1, 0, 31, 1u << 31, 0, {}, {}});
    const MadeEstimator more(evidence);
    TracedRows too_many(more, evidence.layout, {{2, LevelRange{0, 20}}}, 1 << 20);
    EXPECT_EQ(code_of([&] { parallel_for(8, 1, [&](std::size_t k) { too_many.tallies(k % 2, {}); }); }), ErrorCode::damaged_store) << "of a patch";
    EXPECT_EQ(code_of([&] { too_many.tallies(0, {}); }), ErrorCode::damaged_store) << "again";
}

}  // namespace
}  // namespace luxel
