/// Mean light of lamps over a patch: both sides, edges of shadows, nothing that depends on numbers.
#include "baker/light/patch_lamps.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::quad;
using test::SceneMaker;

LampRecord sun(float lux) {
    LampRecord lamp;
    lamp.kind = LampKind::directional;
    lamp.intensity = {lux, lux, lux};
    // -Z of the node becomes -Y: it shines down.
    lamp.world = Imath::M44d(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1);
    return lamp;
}

TEST(PatchLamps, ZeroWithoutLamps) {
    const auto made = test::prepare(SceneMaker().add("a", quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0})).build());
    const auto light = patch_lamp_irradiance(made->scene, made->atlas, made->patches, *made->tracer, 4, 16);
    EXPECT_EQ(light, std::vector<Rgb>(made->patches.count(), Rgb(0, 0, 0)));
}

TEST(PatchLamps, EachSideGetsItsOwn) {
    test::MadeMaterial two_sided;
    two_sided.double_sided = true;
    const auto made = test::prepare(SceneMaker()
                                        .add("sheet", quad({0, 1, 0}, {0, 0.6f, 0.8f}, {1, 0, 0}), two_sided)
                                        .add("floor", quad({-3, 0, -3}, {0, 0, 6}, {6, 0, 0}))
                                        .add_lamp(sun(100))
                                        .build());
    const auto light = patch_lamp_irradiance(made->scene, made->atlas, made->patches, *made->tracer, 16, 64);
    std::size_t fronts = 0, backs = 0, shadowed = 0, lit = 0;
    for (PatchNumber p = 0; p < made->patches.count(); ++p) {
        if (made->path_of(p) == "sheet") {
            const bool up = made->patches.patches[p].normal.y > 0;
            EXPECT_NEAR(light[p].x, up ? 80 : 0, 1e-3);
            ++(made->patches.patches[p].is_back ? backs : fronts);
        } else {
            EXPECT_LE(light[p].x, 100.001f);
            shadowed += light[p].x == 0;
            lit += light[p].x > 99.99f;
        }
    }
    EXPECT_GT(fronts, 0u);
    EXPECT_GT(backs, 0u);
    EXPECT_GT(shadowed, 0u);
    EXPECT_GT(lit, shadowed);
}

TEST(PatchLamps, DoNotDependOnNumbers) {
    const auto light_by_id = [](std::uint32_t chunk_patches) {
        const auto made = test::prepare(SceneMaker()
                                            .add("plate", quad({-1, 1, -1}, {0, 0, 1.3f}, {1.1f, 0, 0}))
                                            .add("floor", quad({-3, 0, -3}, {0, 0, 6}, {6, 0, 0}))
                                            .add_lamp(sun(100))
                                            .build(),
                                        {.chunk_patches = chunk_patches});
        const auto light = patch_lamp_irradiance(made->scene, made->atlas, made->patches, *made->tracer, 8, 32);
        std::map<PatchId, std::array<float, 3>> found;
        for (PatchNumber p = 0; p < light.size(); ++p)
            found[made->patches.patches[p].id] = {light[p].x, light[p].y, light[p].z};
        return found;
    };
    EXPECT_EQ(light_by_id(10), light_by_id(1000));
}

}  // namespace
}  // namespace luxel
