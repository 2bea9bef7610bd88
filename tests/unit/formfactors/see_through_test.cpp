/// Evidence through sheets and panes against closed forms: what passes, both ways alike, and how surfaces with holes count.
#include <gtest/gtest.h>

#include <cmath>

#include "baker/formfactors/hemicube_estimator.h"
#include "baker/formfactors/hemicube_weights.h"
#include "tests/support/see_through.h"
#include "tests/unit/formfactors/made_evidence_scene.h"

namespace luxel {
namespace {

using test::Prepared;
using test::quad;
using test::SceneMaker;

constexpr double facing_squares = 0.199825;  // Howell, C-11: two unit squares one apart

/// Squares "a" (below) and "b" (above), and what `add` puts between them.
std::unique_ptr<Prepared> squares(const std::function<void(SceneMaker&)>& add) {
    SceneMaker maker;
    maker.add("a", quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0})).add("b", quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}));
    add(maker);
    return test::prepare(test::build_with_pictures(maker));
}

/// A sheet far larger than the squares, half way.
test::MadeMesh between() { return quad({-4, 0.5f, -4}, {0, 0, 9}, {9, 0, 0}); }

struct Exchange {
    double area_m2 = 0;     ///< of the patches rays left from
    double exchange_m2 = 0;  ///< sum of A_i n_ij / N_i
    double count = 0;
    std::uint64_t back = 0;
};

Exchange exchange(const Prepared& made, const Estimator& estimator, LevelRange levels, const std::string& from, const std::string& to) {
    const auto ids = made.ids();
    std::map<PatchId, PatchNumber> number;
    for (PatchNumber p = 0; p < made.patches.count(); ++p) number[ids[p]] = p;
    Exchange sum;
    for (const auto& [id, records] : test::evidence_of(made, estimator, levels)) {
        if (made.path_of(number[id]) != from) continue;
        const double area = static_cast<double>(made.patches.patches[number[id]].area_m2);
        sum.area_m2 += area;
        for (const EvidenceRecord& record : records) {
            sum.back += record.back;
            for (std::size_t k = 0; k < record.count.size(); ++k) {
                if (made.path_of(number[record.target_id[k]]) != to) continue;
                sum.count += record.count[k];
                sum.exchange_m2 += area * record.count[k] / static_cast<double>(record.ray_count()) / static_cast<double>(records.size());
            }
        }
    }
    return sum;
}

/// Within four standard errors of the counting; chances of passing are independent of the pattern.
void expect_both_ways(const Prepared& made, double expected) {
    const auto estimator = test::estimator_of(made, {3, 16});
    for (const bool forward : {true, false}) {
        const Exchange g = exchange(made, *estimator, {0, 11}, forward ? "a" : "b", forward ? "b" : "a");
        EXPECT_NEAR(g.exchange_m2, expected, 4 * expected / std::sqrt(g.count));
        EXPECT_GT(g.count, 4000);
    }
}

TEST(SeeThroughEvidence, ASheetBetweenTwoSquares) {
    for (const double alpha : {0.25, 0.8})
        expect_both_ways(*squares([&](SceneMaker& maker) { maker.add("sheet", between()), test::blend(maker, alpha); }),
                         facing_squares * (1 - alpha));
}

TEST(SeeThroughEvidence, ATintedPaneCountsByItsMean) {
    expect_both_ways(*squares([&](SceneMaker& maker) {
                         maker.add("pane", between());
                         test::glass(maker, {0.9, 0.6, 0.3}, 0.8);
                         maker.add("second", test::moved(between(), {0, 0.1f, 0}));
                         test::glass(maker, {0.5, 1, 1});
                     }),
                     facing_squares * 0.8 * (0.45 + 0.6 + 0.3) / 3);
}

TEST(SeeThroughEvidence, RaysAreAccountedFor) {
    const auto made = squares([&](SceneMaker& maker) { maker.add("pane", between()), test::glass(maker, {0.5, 0.5, 0.5}); });
    for (const auto& [id, records] : test::evidence_of(*made, *test::estimator_of(*made), {0, 7}))
        for (const EvidenceRecord& record : records) EXPECT_EQ(record.ray_count(), 128u);
    const Exchange g = exchange(*made, *test::estimator_of(*made), {0, 7}, "a", "b");
    EXPECT_GT(g.back, 0u) << "what the pane absorbs";
}

/// A masked and a half transparent square exchange with a whole one what is there of them, and the same from both sides.
TEST(SeeThroughEvidence, SurfacesWithHolesAreSymmetric) {
    for (const bool is_mask : {true, false}) {
        SceneMaker maker;
        maker.add("a", quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0})).add("b", quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}));
        if (is_mask) test::checker_mask(maker, 0.25f);
        else test::blend(maker, 0.5, {0.5, 0.5, 0.5});
        const auto made = test::prepare(test::build_with_pictures(maker));
        const auto estimator = test::estimator_of(*made, {3, 16});
        const Exchange out = exchange(*made, *estimator, {0, 8}, "a", "b"), back = exchange(*made, *estimator, {0, 8}, "b", "a");
        EXPECT_NEAR(back.area_m2, 0.5, 1e-3);
        EXPECT_NEAR(out.exchange_m2, back.exchange_m2, 4 * out.exchange_m2 * std::sqrt(1 / out.count + 1 / back.count));
        // A fine checker sees as much as half of all.
        EXPECT_NEAR(out.exchange_m2, facing_squares / 2, 0.003);
    }
}

TEST(SeeThroughEvidence, TheHemicubeSeesThroughToo) {
    const auto open = squares([](SceneMaker&) {});
    const auto tinted = squares([&](SceneMaker& maker) { maker.add("pane", between()), test::glass(maker, {0.9, 0.6, 0.3}, 0.75); });
    const auto of = [](const Prepared& made) {
        const auto estimator = make_hemicube_estimator(made.scene, made.atlas, made.patches, *made.tracer, {.resolution = 64});
        return exchange(made, *estimator, {0, hemicube_level}, "a", "b").exchange_m2;
    };
    EXPECT_NEAR(of(*tinted) / of(*open), 0.75 * 0.6, 0.01);
}

TEST(SeeThroughEvidence, ThreadsChangeNothing) {
    const auto made = squares([&](SceneMaker& maker) {
        maker.add("pane", between()), test::glass(maker, {0.9, 0.6, 0.3}, 0.5);
        maker.add("mask", test::moved(between(), {0, 0.2f, 0})), test::checker_mask(maker, 0.2f);
    });
    const auto run = [&](unsigned threads) {
        const ThreadLimit limit(threads);
        return test::evidence_of(*made, *test::estimator_of(*made), {0, 6});
    };
    EXPECT_EQ(run(1), run(2));
}

}  // namespace
}  // namespace luxel
