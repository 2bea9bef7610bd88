/// Settings of nodes where rays are concerned: what casts no shadow is not there for them, and sides are as the node says.
#include <gtest/gtest.h>

#include "baker/patches/see_through_texels.h"
#include "tests/support/see_through.h"

namespace luxel {
namespace {

using test::quad;
using test::SceneMaker;

constexpr float far = std::numeric_limits<float>::infinity();

NodeSettings& settings(SceneMaker& maker, std::size_t node) { return maker.record().instances[node].settings; }

/// A level sheet of 8 x 8 m at height y, around the origin.
test::MadeMesh sheet(float y) { return quad({-4, y, -4}, {0, 0, 8}, {8, 0, 0}); }

/// Sheets at 0, 1, 2 and 3, of which the ones at 1 and, as the same triangles, at 3 cast no shadow; that at 3 there twice.
Scene four_sheets(bool with_pane) {
    SceneMaker maker;
    maker.add("floor", sheet(0)).add("passed", sheet(1)).add("table", sheet(2));
    if (with_pane) test::glass(maker, {1, 1, 1});
    maker.add("top", sheet(3)).add("copy", sheet(3));
    settings(maker, 1).cast_shadow = settings(maker, 3).cast_shadow = settings(maker, 4).cast_shadow = false;
    return maker.build();
}

TEST(NodeSettingsTrace, RaysPassWhatCastsNoShadow) {
    const Scene scene = four_sheets(false);
    const Tracer tracer(scene);
    EXPECT_FALSE(tracer.is_see_through());
    const TraceRay down{{0.5f, 5, 1}, {0, -1, 0}, none}, low{{0.5f, 1.5f, 1}, {0, -1, 0}, none};
    std::vector<TraceRay> rays(9, down);  // a packet and one more
    rays[3] = low;
    std::vector<TraceHit> hits(rays.size());
    tracer.first_hits(rays, hits);
    for (std::size_t k = 0; k < rays.size(); ++k) {
        EXPECT_EQ(hits[k].triangle / 2, k == 3 ? 0u : 2u);
        EXPECT_TRUE(hits[k].front);
    }
    EXPECT_EQ(tracer.first_hit(down).triangle / 2, 2u);
    EXPECT_FALSE(tracer.occluded(down, 2.5f));
    EXPECT_TRUE(tracer.occluded(down, 3.5f));
    EXPECT_EQ(tracer.transmittance(low, 1.4f), Rgb(1, 1, 1));
    EXPECT_EQ(tracer.transmittance(low, far), Rgb(0, 0, 0));
}

TEST(NodeSettingsTrace, AlsoBesidePanes) {
    const Scene scene = four_sheets(true);
    const Tracer tracer(scene);
    EXPECT_TRUE(tracer.is_see_through());
    const TraceRay down{{0.5f, 5, 1}, {0, -1, 0}, none};
    std::vector<TraceHit> hits(9);
    tracer.first_hits(std::vector<TraceRay>(9, down), hits);
    for (const TraceHit& hit : hits) EXPECT_EQ(hit.triangle / 2, 0u);
    EXPECT_EQ(tracer.transmittance(down, 4.5f), Rgb(1, 1, 1));
}

TEST(NodeSettingsTrace, ACopyInTheSamePlaceIsStillMet) {
    SceneMaker maker;
    maker.add("passed", sheet(1)).add("met", sheet(1)).add("also met", sheet(1));
    settings(maker, 0).cast_shadow = false;
    const Scene scene = maker.build();
    const Tracer tracer(scene);
    EXPECT_EQ(tracer.first_hit({{0.5f, 5, 1}, {0, -1, 0}, none}).triangle / 2, 1u);
    // From the first one its copies are others.
    EXPECT_EQ(tracer.first_hit({{0.5f, 0, 1}, {0, 1, 0}, none}).triangle / 2, 1u);
}

TEST(NodeSettingsTrace, WithoutAnyShadowThereIsNothing) {
    SceneMaker maker;
    maker.add("passed", sheet(1));
    settings(maker, 0).cast_shadow = false;
    const Scene scene = maker.build();
    const Tracer tracer(scene);
    EXPECT_EQ(tracer.first_hit({{0.5f, 5, 1}, {0, -1, 0}, none}).triangle, none);
}

TEST(NodeSettingsTrace, ItsPatchesReceiveButHaveNoWeight) {
    SceneMaker maker;
    maker.add("passed", sheet(1), {.reflectance = {0.5, 0.5, 0.5}, .nits = {10, 10, 10}}).add("floor", sheet(0));
    settings(maker, 0).cast_shadow = false;
    std::vector<Warning> warnings;
    const auto made = test::prepare(build_scene(maker.record(), {}, {}, warnings));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0].code, "emission-left-out");
    double area = 0;
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        if (made->path_of(p) != "passed") continue;
        const Patch& patch = made->patches.patches[p];
        area += static_cast<double>(patch.area_m2);
        EXPECT_EQ(patch.emission, Rgb(0, 0, 0));
        EXPECT_EQ(patch.reflectance, Rgb(0, 0, 0));
        EXPECT_FALSE(made->patches.fragments_of(p).empty());
    }
    EXPECT_NEAR(area, 64.0 / fragment_parts, 1e-4);
}

TEST(NodeSettingsTrace, SidesAreAsTheNodeSays) {
    for (const bool by_material : {false, true})
        for (const std::optional<bool> by_node : {std::optional<bool>(), std::optional<bool>(false), std::optional<bool>(true)}) {
            SceneMaker maker;
            maker.add("sheet", quad({2, 1, 1}, {0, 1, 0}, {0, 0, 1}), {.double_sided = by_material});
            maker.add("walls", test::room({0, 0, 0}, {4, 3, 4}));
            settings(maker, 0).two_sided = by_node;
            const Scene scene = maker.build();
            EXPECT_EQ(scene.objects[0].double_sided, by_node.value_or(by_material));
            const auto made = test::prepare(maker.build());
            std::size_t backs = 0;
            for (PatchNumber p = 0; p < made->patches.count(); ++p) backs += made->path_of(p) == "sheet" && made->patches.patches[p].is_back;
            EXPECT_EQ(backs > 0, by_node.value_or(by_material));
        }
}

/// Keys: what rays depend on, what only light does, and nothing where nothing is said.
TEST(NodeSettingsTrace, Keys) {
    const auto keys = [](const NodeSettings& of_node) {
        SceneMaker maker;
        maker.add("sheet", sheet(0));
        settings(maker, 0) = of_node;
        const Scene scene = maker.build();
        return std::pair(scene.geometry_key, scene.light_key);
    };
    const auto nothing = keys({});
    EXPECT_EQ(nothing, keys({.lightmap = true, .receive = true, .cast_shadow = true, .two_sided = false}));
    EXPECT_EQ(nothing, keys({.lightmap = false, .texels_per_metre = 3})) << "of the atlas alone";
    EXPECT_NE(nothing.first, keys({.cast_shadow = false}).first);
    EXPECT_NE(nothing.first, keys({.two_sided = true}).first);
    EXPECT_EQ(nothing.first, keys({.receive = false}).first);
    EXPECT_NE(nothing.second, keys({.receive = false}).second);
}

}  // namespace
}  // namespace luxel
