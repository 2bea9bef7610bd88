// Is the error that a bake states the error that it makes? Two rooms, one lit by a lamp and one through the door, many
// seeds.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "baker/bake/bake_folder.h"
#include "baker/bake/geometry_stages.h"
#include "baker/bake/stage_clock.h"
#include "baker/bake/stage_files.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

constexpr int seeds = 100;

struct Answer {
    std::vector<double> radiosity, sigma;  ///< green channel
    double rays_per_patch = 0;
};

class Calibration : public testing::TestWithParam<double> {
  protected:
    Calibration() {
        input_ = edited_sample("two_rooms", folder_.path(), [](nlohmann::json& document) {
            for (auto& material : document["materials"]) {
                auto& pbr = material["pbrMetallicRoughness"];
                pbr.erase("baseColorTexture");
                pbr["baseColorFactor"] = {GetParam(), GetParam(), GetParam(), 1.0};
            }
        });
    }

    [[nodiscard]] BakeOptions options() const {
        BakeOptions o = small_options(input_, folder_.path() / "out.glb");
        o.work = folder_.path() / "work";
        o.unwrap.texels_per_metre = 4;
        o.patch_texels = 4;
        o.chunk_patches = 1024;
        o.closure_iterations = BakeOptions{}.closure_iterations;
        o.gather_rays = 0;
        o.tolerance = 1e-4;
        return o;
    }

    Answer run(const BakeOptions& o) const {
        std::filesystem::remove_all(o.work);
        const BakeReport report = bake(o);
        Answer found;
        found.rays_per_patch = static_cast<double>(report.evidence_rays) / static_cast<double>(report.patches);
        for (const Channels& b : stored_solution(o.work, report.patches).radiosity) found.radiosity.push_back(b[1]);
        const auto path = stored_file(o.work, "accuracy-");
        const auto error = load_accuracy(path, key_in_name(path.filename().string()), report.patches);
        for (const Channels& b : error->radiosity) found.sigma.push_back(b[1]);
        return found;
    }

    /// The same patches, a thousand times the rays, every patch the same number.
    [[nodiscard]] Answer truth() const {
        BakeOptions o = options();
        o.importance = false;
        o.rays = 262144;
        o.seed = 1000003;
        return run(o);
    }

    /// Per patch: does it lie in the lit room?
    [[nodiscard]] std::vector<bool> lit_room() const {
        BakeReport report;
        const BakeOptions o = options();
        StageClock clock(o, report);
        const auto geometry = prepare_geometry(o, BakeFolder(o.work, o.output), clock, report);
        std::vector<bool> lit;
        for (const Patch& patch : geometry->patches.patches)
            lit.push_back(geometry->scene.origin.x + static_cast<double>(patch.center.x) < 4.1);
        return lit;
    }

    /// Prints and checks what `seeds` runs say, room by room.
    void expect_calibrated(const BakeOptions& with, const char* name) const {
        const Answer true_light = truth();
        const std::vector<bool> lit = lit_room();
        std::array<double, 2> inside{}, count{}, square{}, sum{}, expected{};
        double rays = 0;
        BakeOptions o = with;
        for (int seed = 1; seed <= seeds; ++seed) {
            o.seed = static_cast<std::uint64_t>(seed);
            const Answer found = run(o);
            rays += found.rays_per_patch / seeds;
            for (std::size_t p = 0; p < lit.size(); ++p) {
                if (found.sigma[p] <= 0) continue;
                // The truth has an error of its own.
                const double sigma = std::hypot(found.sigma[p], true_light.sigma[p]),
                             difference = found.radiosity[p] - true_light.radiosity[p];
                inside[lit[p]] += std::fabs(difference) < 2 * sigma;
                sum[lit[p]] += found.radiosity[p], expected[lit[p]] += true_light.radiosity[p];
                square[lit[p]] += difference * difference / (sigma * sigma);
                ++count[lit[p]];
            }
        }
        for (const bool room : {false, true}) {
            const double share = inside[room] / count[room], bias = sum[room] / expected[room] - 1;
            std::printf(
                "%s, albedo %.2f, %s room: within two sigma %.1f %%, error / sigma %.2f rms, bias %+.3f %%, %.0f rays "
                "per patch\n",
                name, GetParam(), room ? "lit" : "unlit", 100 * share, std::sqrt(square[room] / count[room]),
                100 * bias, rays);
            EXPECT_GE(share, 0.92);
            EXPECT_LE(share, 0.98);
            EXPECT_LT(std::fabs(bias), 0.01);  // of each room by itself: the dim one is 0.6 % too dark at albedo 0.95
        }
        EXPECT_LT(std::fabs((sum[0] + sum[1]) / (expected[0] + expected[1]) - 1), 0.002);
    }

    TemporaryFolder folder_;
    std::filesystem::path input_;
};

TEST_P(Calibration, TrueErrorsLieWithinTwoSigma) {
    BakeOptions o = options();
    o.rays = 256;
    expect_calibrated(o, "256 rays");
}

/// Stopping when the estimate says so must not make the estimate wrong. After 256 rays the stated error is 1.7 to 2 %: some runs stop
/// there, and some go on.
class CalibrationOfStopping : public Calibration {};

TEST_P(CalibrationOfStopping, StoppingOnTheErrorDoesNotHideIt) {
    BakeOptions o = options();
    o.error = 0.018;
    expect_calibrated(o, "--error 0.018");
}

INSTANTIATE_TEST_SUITE_P(Albedos, Calibration, testing::Values(0.5, 0.7, 0.95));
INSTANTIATE_TEST_SUITE_P(Albedos, CalibrationOfStopping, testing::Values(0.7));

}  // namespace
}  // namespace luxel::test
