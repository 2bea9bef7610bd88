#include "baker/solver/energy_audit.h"

#include <gtest/gtest.h>

#include "baker/solver/shoot.h"
#include "tests/unit/solver/matrices.h"

namespace luxel {
namespace {

TEST(EnergyAudit, EmittedIsAbsorbedAndLost) {
    for (const bool closed : {true, false})
        for (const float highest : {0.0f, 0.2f, 0.9f}) {
            const test::Matrix matrix = test::random_matrix({.patches = 150, .chunk_patches = 40, .closed = closed}, 6);
            auto reflectance = test::random_reflectance(150, 0.0f, highest, 3);
            reflectance[9] = {0, 0, 0};
            const auto emission = test::random_emission(150, 4);
            MemoryBlocks blocks = matrix.blocks();
            const SolveInput input{reflectance, emission};
            const SolveResult result = solve_by_shooting(blocks, input, {});
            const EnergyAudit audit = audit_energy(matrix.area_m2, matrix.row_open_m2(), input, result);
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_GT(audit.emitted_lm[c], 0);
                EXPECT_NEAR((audit.absorbed_lm[c] + audit.lost_lm[c]) / audit.emitted_lm[c], 1.0, 1e-3);
                EXPECT_LE(audit.remaining_lm[c], 1e-3 * audit.emitted_lm[c] / (1 - static_cast<double>(highest)));
                if (closed) {
                    EXPECT_NEAR(audit.lost_lm[c], 0, 1e-6 * audit.emitted_lm[c]);
                }
            }
            EXPECT_LE(audit.imbalance, 1e-3);
        }
}

TEST(EnergyAudit, NoticesAMatrixThatIsNotSymmetricEnough) {
    // The open area of the audit does not belong to the matrix that was solved.
    const test::Matrix matrix = test::random_matrix({.patches = 80, .chunk_patches = 40, .closed = true}, 6);
    const auto reflectance = test::random_reflectance(80, 0.5f, 0.9f, 3);
    const auto emission = test::random_emission(80, 4);
    MemoryBlocks blocks = matrix.blocks();
    const SolveInput input{reflectance, emission};
    const SolveResult result = solve_by_shooting(blocks, input, {});
    std::vector<double> open = matrix.row_open_m2();
    for (std::size_t i = 0; i < open.size(); ++i) open[i] += 0.05 * matrix.area_m2[i];
    EXPECT_GT(audit_energy(matrix.area_m2, open, input, result).imbalance, 0.01);
}

TEST(EnergyAudit, NothingIsNothing) {
    const EnergyAudit audit = audit_energy({}, {}, {}, {});
    EXPECT_EQ(audit.imbalance, 0);
}

}  // namespace
}  // namespace luxel
