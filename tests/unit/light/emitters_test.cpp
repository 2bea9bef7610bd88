/// Aiming at emitters: probabilities sum to 1, points lie where they are said to, as often as the density says.
#include "baker/light/emitters.h"

#include <gtest/gtest.h>

#include <cmath>

#include "baker/core/sobol.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::quad;
using test::SceneMaker;

std::unique_ptr<test::Prepared> lamps() {
    test::MadeMaterial dim, bright;
    dim.nits = {1, 1, 1};
    bright.nits = {50, 0, 0};
    return test::prepare(SceneMaker()
                             .add("walls", test::room({0, 0, 0}, {4, 3, 4}))
                             .add("dim", quad({1, 2.9f, 1}, {1.5f, 0, 0}, {0, 0, 1}), dim)
                             .add("bright", quad({3, 2.9f, 3}, {0.3f, 0, 0}, {0, 0, 0.3f}), bright)
                             .add("ball", test::moved(test::icosphere(2, 0.3f), {2, 1, 2}), dim)
                             .build());
}

TEST(Emitters, NoneWhereNothingEmits) {
    const auto made = test::prepare(SceneMaker().add("walls", test::room({0, 0, 0}, {1, 1, 1})).build());
    const EmitterSet emitters(made->scene, made->atlas, made->patches);
    EXPECT_TRUE(emitters.empty());
    EXPECT_EQ(emitters.cluster_count(), 0u);
}

TEST(Emitters, DensityIntegratesToOne) {
    const auto made = lamps();
    const EmitterSet emitters(made->scene, made->atlas, made->patches);
    std::vector<float> up_to;
    for (const Patch& receiver : made->patches.patches) {
        emitters.weigh(receiver.center, receiver.normal, up_to);
        if (up_to.empty()) continue;  // sees no emitter
        ASSERT_EQ(up_to.size(), emitters.cluster_count());
        EXPECT_TRUE(std::ranges::is_sorted(up_to));
        EXPECT_EQ(up_to.back(), 1.0f);
        double integral = 0;
        for (PatchNumber p = 0; p < made->patches.count(); ++p)
            integral += static_cast<double>(emitters.density(up_to, p) * made->patches.patches[p].area_m2);
        EXPECT_NEAR(integral, 1, 1e-4);
    }
}

/// What a receiver can see has a chance: otherwise the mean would miss it where no cosine ray is cast.
TEST(Emitters, WhatCanBeSeenHasAChance) {
    const auto made = lamps();
    const EmitterSet emitters(made->scene, made->atlas, made->patches);
    std::vector<float> up_to;
    for (const Patch& receiver : made->patches.patches) {
        emitters.weigh(receiver.center, receiver.normal, up_to);
        if (up_to.empty()) up_to.assign(emitters.cluster_count(), 0.0f);
        for (PatchNumber p = 0; p < made->patches.count(); ++p) {
            const Patch& sender = made->patches.patches[p];
            if (sender.emission == Rgb(0, 0, 0) || &sender == &receiver) continue;
            const Vec3f to = sender.center - receiver.center;
            if (to.dot(receiver.normal) > 0.01f * to.length() && -to.dot(sender.normal) > 0.01f * to.length()) {
                EXPECT_GT(emitters.density(up_to, p), 0);
            }
        }
    }
}

TEST(Emitters, AimsAsOftenAsTheDensitySays) {
    const auto made = lamps();
    const EmitterSet emitters(made->scene, made->atlas, made->patches);
    std::vector<float> up_to;
    emitters.weigh(Vec3f(2, 0, 2) - to_float(made->scene.origin), {0, 1, 0}, up_to);
    std::vector<double> count(made->patches.count());
    const SobolSequence sequence(5);
    constexpr std::uint32_t aims = 1 << 16;
    for (std::uint32_t k = 0; k < aims; ++k) {
        const auto u = sequence.point(k);
        const EmitterSet::Aim aim = emitters.aim(up_to, u[0], u[1], u[2]);
        ASSERT_LT(aim.patch, made->patches.count());
        ++count[aim.patch];
        const auto fragments = made->patches.fragments_of(aim.patch);
        EXPECT_TRUE(
            std::ranges::any_of(fragments, [&](const Fragment& f) { return f.triangle == aim.point.triangle; }));
    }
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        const double expected =
            static_cast<double>(emitters.density(up_to, p) * made->patches.patches[p].area_m2) * aims;
        EXPECT_NEAR(count[p], expected, 4 * std::sqrt(expected) + 2);
        if (made->patches.patches[p].emission == Rgb(0, 0, 0)) {
            EXPECT_EQ(count[p], 0);
        }
    }
    // The ends of the choice are legal.
    EXPECT_LT(emitters.aim(up_to, 0, 0, 0).patch, made->patches.count());
    EXPECT_LT(emitters.aim(up_to, 0x1.fffffep-1f, 0x1.fffffep-1f, 0x1.fffffep-1f).patch, made->patches.count());
}

}  // namespace
}  // namespace luxel
