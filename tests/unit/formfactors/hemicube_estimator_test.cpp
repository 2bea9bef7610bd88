/// Delta form factors, the place of the cube, and evidence by hemicube against closed forms.
#include "baker/formfactors/hemicube_estimator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "baker/core/units.h"
#include "baker/formfactors/evidence.h"
#include "baker/formfactors/exact_form_factor.h"
#include "baker/formfactors/hemicube_weights.h"
#include "baker/patches/patch_lookup.h"
#include "formats/base/error.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/formfactors/made_evidence_scene.h"

namespace luxel {
namespace {

using test::Prepared;
using test::quad;
using test::SceneMaker;

constexpr LevelRange all_levels{0, hemicube_level};
constexpr double whole = 1 << hemicube_level;

std::unique_ptr<Estimator> hemicube_of(const Prepared& made, const HemicubeOptions& options = {}) {
    return make_hemicube_estimator(made.scene, made.atlas, made.patches, *made.tracer, options);
}

TEST(HemicubeWeights, SumToOneExactly) {
    for (const std::uint32_t resolution : {2u, 4u, 16u, 50u, 64u, 256u}) {
        const HemicubeWeights weights(resolution);
        std::uint64_t sum = 0;
        for (std::uint32_t face = 0; face < 5; ++face)
            for (std::uint32_t row = 0; row < weights.rows(face); ++row)
                for (std::uint32_t column = 0; column < resolution; ++column) sum += weights.weight(face, row, column);
        EXPECT_EQ(sum, std::uint64_t{1} << hemicube_level) << resolution;
    }
    for (const std::uint32_t wrong : {0u, 1u, 17u, 4098u}) EXPECT_THROW(HemicubeWeights{wrong}, Error);
}

/// Of every pixel: the closed form of a rectangle, to a unit of the fixed point and the little that Gauss points leave.
TEST(HemicubeWeights, ArePixelFormFactors) {
    const HemicubeWeights weights(32);
    const double size = 2.0 / 32;
    const Vec3d up(0, 0, 1);
    for (std::uint32_t face = 0; face < 5; ++face)
        for (std::uint32_t row = 0; row < weights.rows(face); ++row)
            for (std::uint32_t column = 0; column < 32; ++column) {
                const Vec3d middle = to_double(weights.direction(face, row, column));
                const Vec3d inward = face == 0 ? Vec3d(0, 0, -1) : face % 2 ? Vec3d(-middle.x, 0, 0) : Vec3d(0, -middle.y, 0);
                const Vec3d u = face == 0 ? Vec3d(size, 0, 0) : up * size, v = inward.cross(u);
                const std::vector<Vec3d> pixel{middle - (u + v) / 2, middle + (u - v) / 2, middle + (u + v) / 2,
                                               middle - (u - v) / 2};
                EXPECT_NEAR(weights.weight(face, row, column), exact_point_form_factor({0, 0, 0}, up, pixel) * whole, 2);
            }
}

TEST(Hemicube, StandsOnItsPatch) {
    SceneMaker maker;
    const auto made = test::prepare(test::add_furnished_room(maker, "room", Vec3d(0, 0, 0)).build());
    std::size_t backs = 0;
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        const Patch& patch = made->patches.patches[p];
        const HemicubePlace place = hemicube_place(made->scene, made->atlas, made->patches, p);
        // From a little above the surface the nearest thing below is the patch itself.
        const Vec3f above = place.position + place.normal * 1e-3f;
        const TraceHit hit = made->tracer->first_hit({above, -place.normal, none});
        ASSERT_NE(hit.triangle, none);
        EXPECT_NEAR(hit.distance_m, 1e-3f, 1e-4f);
        const PatchNumber front = patch.is_back ? patch.other_side : p;
        EXPECT_EQ(front_patch_at(made->scene, made->atlas, made->patches, hit.triangle, hit.b1, hit.b2), front);
        EXPECT_GT(place.normal.dot(patch.normal), 0);
        EXPECT_LT((place.position - patch.center).length2(), patch.area_m2 * 2);
        backs += patch.is_back;
    }
    EXPECT_GT(backs, 0u);
}

TEST(Hemicube, EvidenceIsWholeAndFinal) {
    SceneMaker maker;
    const auto made = test::prepare(test::add_furnished_room(maker, "room", Vec3d(0, 0, 0)).build(), {.chunk_patches = 100});
    const auto estimator = hemicube_of(*made, {0, 16});
    EXPECT_EQ(estimator->replicate_count(), 1u);
    const auto expected = test::evidence_of(*made, *estimator, all_levels);
    for (const auto& [id, records] : expected) {
        ASSERT_EQ(records.size(), 1u);
        EXPECT_EQ(records[0].open, 0u) << "the room is closed";
        // The decoder checks that the weights sum to what the levels stand for.
        EXPECT_EQ(record_of(decode_evidence(encode_evidence({records.data(), 1}), "record"), 0), records[0]);
    }
    // Numbers mean nothing.
    std::vector<PatchNumber> numbers(made->patches.count());
    std::iota(numbers.rbegin(), numbers.rend(), 0u);
    renumber(made->patches, numbers);
    EXPECT_EQ(test::evidence_of(*made, *estimator, all_levels), expected);

    std::vector<Landings> out;
    EXPECT_THROW(estimator->cast(0, {0, 8}, out), Error);
    EXPECT_THROW(hemicube_of(*made, {0, 15}), Error);
    EXPECT_NE(estimator->identity(), hemicube_of(*made, {0, 18})->identity());
    EXPECT_NE(estimator->identity(), hemicube_of(*made, {1, 16})->identity());
    EXPECT_NE(estimator->identity(), test::estimator_of(*made)->identity());
}

TEST(Hemicube, FilesSayTheSameAsRecords) {
    const test::TemporaryFolder folder;
    SceneMaker maker;
    const auto made = test::prepare(test::add_furnished_room(maker, "room", Vec3d(0, 0, 0)).build(), {.chunk_patches = 150});
    const auto estimator = hemicube_of(*made, {0, 20});
    const auto ids = made->ids();
    const LevelPlan plan{std::vector<LevelRange>(ids.size(), all_levels)};
    Publisher publisher;
    write_chunk_evidence(*estimator, made->layout, ids, 0, plan, folder / "chunk", {1, 2}, publisher, nullptr);
    publisher.finish();
    const BlockFileReader file(folder / "chunk", FileKind::evidence, evidence_version);
    PatchNumber patch = 0;
    for (std::size_t k = 0; k < file.blocks().size(); ++k) {
        const EvidenceBlock block = decode_evidence(file.read(k), "block");
        for (std::size_t row = 0; row < block.rows.size(); ++row, ++patch) {
            std::vector<EvidenceRecord> expected;
            collect_records(*estimator, ids, patch, all_levels, expected);
            EXPECT_EQ(record_of(block, row), expected[0]);
        }
    }
    EXPECT_EQ(patch, made->layout.first_patch[1]);
}

/// Error against the closed form of the same points, so that only the alias of the pixels is left.
double alias_error(const Prepared& made, std::uint32_t resolution, const std::vector<Vec3d>& target) {
    const auto estimator = hemicube_of(made, {0, resolution});
    double sum = 0;
    std::size_t count = 0;
    std::vector<Landings> out;
    for (PatchNumber p = 0; p < made.patches.count(); ++p) {
        if (made.path_of(p) != "a") continue;
        estimator->cast(p, all_levels, out);
        double f = 0;
        for (std::size_t k = 0; k < out[0].patches.size(); ++k)
            if (made.path_of(out[0].patches[k]) == "b") f += out[0].weights[k] / whole;
        EXPECT_EQ(out[0].open + std::accumulate(out[0].weights.begin(), out[0].weights.end(), 0.0), whole);
        const HemicubePlace place = hemicube_place(made.scene, made.atlas, made.patches, p);
        const double error = f - exact_point_form_factor(to_double(place.position) + made.scene.origin, to_double(place.normal), target);
        sum += error * error;
        ++count;
    }
    return std::sqrt(sum / static_cast<double>(count));
}

TEST(Hemicube, AliasGoesDownWithResolution) {
    const auto made = test::prepare(SceneMaker()
                                        .add("a", quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}))
                                        .add("b", quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}))
                                        .build());
    const std::vector<Vec3d> target{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}};
    const double coarse = alias_error(*made, 16, target), fine = alias_error(*made, 256, target);
    EXPECT_LT(coarse, 0.02);
    EXPECT_LT(fine, 0.001);
    EXPECT_LT(fine, coarse / 8);
}

}  // namespace
}  // namespace luxel
