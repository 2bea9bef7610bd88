/// Form factors that are known: two unit squares, the inside of a sphere, reciprocity in a furnished room.
#include <gtest/gtest.h>

#include <cmath>

#include "baker/core/units.h"
#include "tests/unit/formfactors/made_evidence_scene.h"

namespace luxel {
namespace {

using test::quad;
using test::SceneMaker;

struct Estimate {
    double mean = 0, standard_error = 0;
};

/// F from all patches of object `from` to object `to`, area-weighted; the error from independent replicates.
Estimate form_factor(const test::Prepared& made, const std::string& from, const std::string& to) {
    constexpr std::uint32_t replicates = 64;
    const auto estimator = test::estimator_of(made, {7, replicates});
    std::map<PatchId, PatchNumber> number;
    for (PatchNumber p = 0; p < made.patches.count(); ++p) number[made.patches.patches[p].id] = p;
    std::vector<double> f(replicates);
    double area = 0;
    for (const auto& [id, records] : test::evidence_of(made, *estimator, {0, 6})) {
        if (made.path_of(number[id]) != from) continue;
        const double a = static_cast<double>(made.patches.patches[number[id]].area_m2);
        area += a;
        for (const EvidenceRecord& record : records)
            for (std::size_t k = 0; k < record.count.size(); ++k)
                if (made.path_of(number[record.target_id[k]]) == to)
                    f[record.replicate] += a * record.count[k] / static_cast<double>(record.ray_count());
    }
    Estimate estimate;
    for (double& value : f) estimate.mean += (value /= area) / replicates;
    for (const double value : f) estimate.standard_error += (value - estimate.mean) * (value - estimate.mean);
    estimate.standard_error = std::sqrt(estimate.standard_error / (replicates - 1) / replicates);
    return estimate;
}

void expect_factor(const test::Prepared& made, double exact) {
    for (const bool forward : {true, false}) {
        const Estimate f = forward ? form_factor(made, "a", "b") : form_factor(made, "b", "a");
        EXPECT_NEAR(f.mean, exact, 3 * f.standard_error);
        EXPECT_LT(f.standard_error, 0.002);
        EXPECT_GT(f.standard_error, 0);
    }
}

/// Source of the closed forms: Howell, A Catalog of Radiation Heat Transfer Configuration Factors, C-11 and C-14.
double facing_unit_squares() {
    const double root = std::sqrt(2.0), turn = std::atan(1.0), part = std::atan(1 / root);
    return 2 / pi * (std::log(std::sqrt(4.0 / 3)) + 2 * root * part - 2 * turn);
}

TEST(ClosedForms, TheCatalogue) { EXPECT_NEAR(facing_unit_squares(), 0.1998, 5e-5); }

TEST(ClosedForms, FacingUnitSquares) {
    const auto made = test::prepare(SceneMaker()
                                        .add("a", quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}))
                                        .add("b", quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}))
                                        .build());
    expect_factor(*made, facing_unit_squares());
}

TEST(ClosedForms, UnitSquaresAtRightAngles) {
    const auto made = test::prepare(SceneMaker()
                                        .add("a", quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}))
                                        .add("b", quad({0, 0, 0}, {0, 1, 0}, {0, 0, 1}))
                                        .build());
    expect_factor(*made, 0.2000438);
}

/// Turned, far away and small: the same factor.
TEST(ClosedForms, DoNotDependOnPlaceAndScale) {
    const Frame turn(Vec3f(1, 2, 3).normalized());
    for (const float scale : {1e-3f, 1.0f, 1e3f}) {
        SceneMaker maker;
        for (const bool upper : {false, true}) {
            test::MadeMesh mesh = upper ? quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}) : quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0});
            for (Vec3f& p : mesh.positions) p = turn.to_world(p) * scale;
            maker.add(upper ? "b" : "a", mesh, {}, Vec3d(1e5, -2e5, 3e4) * static_cast<double>(scale));
        }
        const auto made = test::prepare(maker.build(), {.texels_per_metre = 8 / static_cast<double>(scale)});
        expect_factor(*made, facing_unit_squares());
    }
}

/// F_ij = A_j / A for every pair, the patch itself included.
TEST(ClosedForms, InsideOfASphere) {
    const auto made = test::prepare(SceneMaker().add("sphere", test::turned(test::icosphere(3, 1))).build());
    const auto ids = made->ids();
    double area = 0;
    for (const Patch& patch : made->patches.patches) area += static_cast<double>(patch.area_m2);
    const auto evidence = test::evidence_of(*made, *test::estimator_of(*made), {0, 10});
    double chi_squared = 0;
    std::size_t pairs = 0, far_off = 0;
    for (const auto& [id, records] : evidence) {
        std::map<PatchId, double> met;
        double rays = 0;
        for (const EvidenceRecord& record : records) {
            EXPECT_EQ(record.open + record.back, 0u) << "nothing leaves a sphere";
            rays += static_cast<double>(record.ray_count());
            for (std::size_t k = 0; k < record.count.size(); ++k) met[record.target_id[k]] += record.count[k];
        }
        for (const Patch& target : made->patches.patches) {
            const double expected = rays * static_cast<double>(target.area_m2) / area;
            if (expected < 10) continue;  // slivers of charts: too few rays to judge
            const double z = (met[target.id] - expected) / std::sqrt(expected);
            chi_squared += z * z;
            far_off += std::fabs(z) > 4.5;
            ++pairs;
        }
    }
    ASSERT_GT(pairs, 2000u);
    // Stratified points scatter less than independent ones; flat triangles differ a little from the sphere.
    EXPECT_LT(chi_squared / static_cast<double>(pairs), 1.1);
    EXPECT_LE(far_off, pairs / 1000);
}

/// Flux out by a patch's own rays = flux in by the others' rays, within its standard error: A_i F_ij = A_j F_ji.
TEST(ClosedForms, Reciprocity) {
    SceneMaker maker;
    const auto made = test::prepare(test::add_furnished_room(maker, "room", Vec3d(0, 0, 0)).build());
    const auto evidence = test::evidence_of(*made, *test::estimator_of(*made), {0, 8});
    std::map<PatchId, double> out, in, variance;
    std::map<PatchId, double> area;
    for (const Patch& patch : made->patches.patches) area[patch.id] = static_cast<double>(patch.area_m2);
    for (const auto& [id, records] : evidence)
        for (const EvidenceRecord& record : records)
            for (std::size_t k = 0; k < record.count.size(); ++k) {
                const double weight = area[id] / static_cast<double>(4 * record.ray_count());
                const double flux = weight * record.count[k];
                out[id] += flux;
                in[record.target_id[k]] += flux;
                variance[record.target_id[k]] += weight * flux;
            }
    double sum = 0;
    std::size_t far_off = 0;
    for (const auto& [id, a] : area) {
        const double z = (out[id] - in[id]) / std::sqrt(variance[id]);
        sum += z * z;
        far_off += std::fabs(z) > 5;
    }
    EXPECT_LT(sum / static_cast<double>(area.size()), 1.2);
    EXPECT_EQ(far_off, 0u);
}

}  // namespace
}  // namespace luxel
