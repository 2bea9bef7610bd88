/// One lamp out of many: probabilities that are true, and lamps close by that are not missed.
#include "baker/light/lamp_tree.h"

#include <gtest/gtest.h>

#include <map>

#include "baker/core/sobol.h"
#include "baker/light/lamps.h"

namespace luxel {
namespace {

/// A level of 300 lamps, a sun among them.
std::vector<Lamp> level() {
    std::vector<Lamp> lamps(300);
    const SobolSequence places(7);
    for (std::uint32_t k = 0; k < lamps.size(); ++k) {
        const auto u = places.point(k);
        lamps[k].position = {100 * u[0], 10 * u[1], 100 * u[2]};
        lamps[k].intensity = {1 + u[3], 1, 1};
        lamps[k].range = k % 3 == 0 ? 30.0f : 0.0f;
        if (k % 5 == 0) lamps[k].kind = LampKind::spot, lamps[k].direction = {0, -1, 0};
        if (k % 7 == 0) lamps[k].radius = 0.2f;
    }
    lamps[11].kind = LampKind::directional, lamps[11].direction = {0, -1, 0}, lamps[11].intensity = {0.01f, 0.01f, 0.01f};
    return lamps;
}

TEST(LampTree, AMeanOverChoicesIsTheSumOfAll) {
    const std::vector<Lamp> lamps = level();
    const LampTree tree(lamps);
    constexpr std::uint32_t count = 1 << 18;
    for (const LitPoint& at : {LitPoint{{50, 0, 50}, {0, 1, 0}}, LitPoint{{3, 4, 97}, {0, 0, -1}}, LitPoint{{-40, 2, 10}, {1, 0, 0}}}) {
        double expected = 0, sum = 0;
        for (const Lamp& lamp : lamps) expected += static_cast<double>(luminance(unshadowed_irradiance(lamp, at.position, at.normal)));
        std::map<std::uint32_t, std::pair<double, double>> chosen;  // probability as said, share as found
        for (std::uint32_t k = 0; k < count; ++k) {
            const auto choice = tree.choose(at, (static_cast<float>(k) + 0.5f) / count, 0.01f);
            if (!choice) continue;
            auto& [said, found] = chosen[choice->lamp];
            if (said > 0) {
                EXPECT_FLOAT_EQ(static_cast<float>(said), choice->probability);
            }
            said = static_cast<double>(choice->probability), found += 1.0 / count;
            EXPECT_GE(choice->rest, 0.0f);
            EXPECT_LT(choice->rest, 1.0f);
            sum += static_cast<double>(luminance(unshadowed_irradiance(lamps[choice->lamp], at.position, at.normal)) / choice->probability) / count;
        }
        EXPECT_GT(chosen.size(), 100u);
        EXPECT_GT(expected, 0);
        EXPECT_NEAR(sum / expected, 1, 0.005);
        for (const auto& [lamp, shares] : chosen) EXPECT_NEAR(shares.second, shares.first, 2e-5 + 0.01 * shares.first) << lamp;
    }
}

TEST(LampTree, ALampCloseByIsChosenOften) {
    std::vector<Lamp> lamps = level();
    const LitPoint at{{50, 0, 50}, {0, 1, 0}};
    lamps[200].position = at.position + Vec3f(0.05f, 0.05f, 0);
    lamps[200].kind = LampKind::point, lamps[200].radius = 0;
    const LampTree tree(lamps);
    constexpr std::uint32_t count = 4096;
    double often = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
        const auto choice = tree.choose(at, (static_cast<float>(k) + 0.5f) / count, 0.01f);
        often += choice && choice->lamp == 200 ? 1.0 / count : 0;
    }
    EXPECT_GT(often, 0.1) << "it has nearly all light, and is one of 300";
}

/// Intensity over the square of a distance beyond single precision.
TEST(LampTree, TheBrightestLampsAtTheSmallestDistances) {
    std::vector<Lamp> lamps = level();
    for (Lamp& lamp : lamps) lamp.intensity *= 1e37f;
    const LampTree tree(lamps);
    const LitPoint at{lamps[200].position - Vec3f(0, 1e-6f, 0), {0, 1, 0}};
    int chosen = 0;
    for (int k = 0; k < 64; ++k) {
        const auto choice = tree.choose(at, (static_cast<float>(k) + 0.5f) / 64, 0.01f);
        if (!choice) continue;
        ++chosen;
        EXPECT_GT(choice->probability, 0.0f);
        EXPECT_LE(choice->probability, 1.0f);
    }
    EXPECT_GT(chosen, 0);
}

TEST(LampTree, WithoutLampsThereIsNoChoice) {
    const LampTree tree({});
    EXPECT_TRUE(tree.empty());
    EXPECT_FALSE(tree.choose({{0, 0, 0}, {0, 1, 0}}, 0.5f, 1));
}

}  // namespace
}  // namespace luxel
