/// Light where patches are too coarse: what is known in closed form stays, and what leaks through coarse patches does
/// not.
#include "baker/light/near_light.h"

#include <gtest/gtest.h>

#include <cmath>

#include "baker/core/parallel.h"
#include "baker/light/lamps.h"
#include "baker/light/patch_lamps.h"
#include "baker/patches/fragment_polygon.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::Prepared;
using test::quad;
using test::SceneMaker;

std::vector<Rgb> gather_all(const Prepared& made, std::span<const Rgb> radiosity, const GatherOptions& options) {
    const EmitterSet emitters(made.scene, made.atlas, made.patches);
    std::vector<Rgb> reflected;
    for (std::size_t p = 0; p < radiosity.size(); ++p) reflected.push_back(radiosity[p] - made.patches.patches[p].emission);
    const RadiosityDetail detail(reflected);
    const LightGuides guides;
    const GatherInput input{made.scene, made.atlas, made.texels, made.patches, *made.tracer, emitters, detail, guides};
    std::vector<Rgb> all;
    for (std::uint32_t page = 0; page < made.texels.pages.size(); ++page)
        for (const Rgb& h : gather_page(input, page, options, nullptr)->irradiance()) all.push_back(h);
    return all;
}

/// Walls that all emit M and reflect rho: B = M / (1 - rho) at every point, however far the paths go. `near_m` beyond
/// the size of the room: only the last bounce ends them. Without aimed rays every path says the same.
TEST(NearLight, FurnaceStaysAFurnace) {
    test::MadeMaterial glowing;
    glowing.nits = {1, 2, 4};
    glowing.reflectance = {0.8, 0.5, 0.2};
    const auto made = test::prepare(SceneMaker().add("walls", test::room({0, 0, 0}, {2, 1, 1.5f}), glowing).build(),
                                    {.texels_per_metre = 6});
    std::vector<Rgb> radiosity;
    for (const Patch& patch : made->patches.patches)
        radiosity.push_back(patch.emission / (Rgb(1, 1, 1) - patch.reflectance));
    for (const float near_m : {0.3f, 100.0f})
        for (const bool aim : {true, false}) {
            const auto light = gather_all(*made, radiosity, {.rays = 256, .aim_at_emitters = aim, .near_m = near_m});
            for (int c = 0; c < 3; ++c) {
                double mean = 0, square = 0;
                for (const Rgb& h : light) {
                    const double relative = static_cast<double>(h[c] / radiosity[0][c]);
                    mean += relative, square += relative * relative;
                }
                const double n = static_cast<double>(light.size());
                mean /= n;
                const double error = std::sqrt(std::max(square / n - mean * mean, 0.0) / n);
                EXPECT_NEAR(mean, 1, 4 * error + 1e-6) << near_m << " " << aim << " " << c;
                EXPECT_LT(error, aim ? 0.01 : 1e-6);
            }
        }
}

/// Two sheets a centimetre apart under a bright ceiling; their patches are half a metre wide. What the sheets facing
/// each other receive deep inside is almost nothing; patches that reach from the open into the gap say otherwise.
TEST(NearLight, DeepInAGapItIsDark) {
    SceneMaker maker;
    maker.add("floor", quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0}));
    maker.add("plate", test::moved(test::box(2, 0.05f, 4.4f), {2, 0.01f, -0.2f}));
    test::MadeMaterial lamp;
    lamp.nits = {100, 100, 100};
    maker.add("ceiling", quad({0, 3, 0}, {4, 0, 0}, {0, 0, 4}), lamp);
    const auto made = test::prepare(maker.build(), {.texels_per_metre = 8, .patch_texels = 16});
    // As a solve would give it: the floor's patches 2 m wide have the mean of light and dark.
    std::vector<Rgb> radiosity;
    for (PatchNumber p = 0; p < made->patches.count(); ++p)
        radiosity.push_back(made->path_of(p) == "ceiling" ? made->patches.patches[p].emission : Rgb(80, 80, 80));
    const auto deep = [&](float near_m) {
        const auto light = gather_all(*made, radiosity, {.rays = 256, .near_m = near_m});
        double sum = 0, count = 0;
        std::size_t k = 0;
        for (const PageTexels& page : made->texels.pages)
            for (const Texel& texel : page.texels) {
                const Rgb& h = light[k++];
                if (made->scene.materials[made->scene.objects[made->atlas.charts[texel.chart].object].material].name !=
                    "floor")
                    continue;
                const Fragment& f = page.fragments[texel.first_fragment];
                const Vec3f at =
                    surface_position(made->scene, f.triangle, fragment_polygon(made->scene, made->atlas, f).centroid());
                if (static_cast<double>(at.x) + made->scene.origin.x < 3) continue;  // a metre inside
                sum += static_cast<double>(h.x), ++count;
            }
        return sum / count;
    };
    const double open = 100 * 3.14159265;  // below the ceiling, about
    EXPECT_GT(deep(0), 0.1 * open);
    EXPECT_LT(deep(2), 0.005 * open);
}

LampRecord point_lamp(const Vec3d& at, double candela) {
    LampRecord lamp;
    lamp.kind = LampKind::point;
    lamp.intensity = {candela, candela, candela};
    lamp.world.setTranslation(at);
    return lamp;
}

/// A black wall receives what lamps give to the floor before it: the patches say it, or the path's own shadow rays do.
TEST(NearLight, LampsLightTheWayOn) {
    test::MadeMaterial black;
    black.reflectance = {0, 0, 0};
    SceneMaker maker;
    maker.add("floor", quad({0, 0, 0}, {0, 0, 2}, {2, 0, 0}));
    maker.add("wall", quad({0, 0, 0}, {0, 1, 0}, {0, 0, 2}), black);
    maker.add_lamp(point_lamp({1000, 1000, 1}, 1e6))
        .add_lamp(point_lamp({-2000, 1000, 1}, 2e6));  // the second one only behind the wall
    const auto made = test::prepare(maker.build());
    std::vector<Rgb> dark(made->patches.count(), Rgb(0, 0, 0)), radiosity = dark;
    const auto direct = patch_lamp_irradiance(made->scene, made->atlas, made->patches, *made->tracer, 16, 64);
    for (PatchNumber p = 0; p < made->patches.count(); ++p)
        radiosity[p] = direct[p] * made->patches.patches[p].reflectance;
    const auto bounced = [&](std::span<const Rgb> of, float near_m) {
        double sum = 0;
        for (const Rgb& h : gather_all(*made, of, {.rays = 256, .near_m = near_m})) sum += static_cast<double>(h.x);
        return sum;
    };
    const double lit = bounced(dark, 0);
    EXPECT_NEAR((bounced(dark, 10) - lit) / (bounced(radiosity, 0) - lit), 1, 0.02);
}

/// A black wall sees the back of a sheet 12 m away, lit by a lamp that reaches no farther than around the sheet: the back is followed
/// however far it is, and finds the lamp that the wall's own table leaves out.
TEST(NearLight, BacksAreFollowedToLampsOfTheirOwn) {
    test::MadeMaterial black, sheet;
    black.reflectance = {0, 0, 0};
    sheet.double_sided = true;
    SceneMaker maker;
    maker.add("wall", quad({0, -5, -5}, {0, 10, 0}, {0, 0, 10}), black);
    maker.add("sheet", quad({12, -5, -5}, {0, 10, 0}, {0, 0, 10}), sheet);
    LampRecord lamp = point_lamp({10, 0, 0}, 1000);
    lamp.range = 4;
    maker.add_lamp(lamp);
    const auto made = test::prepare(maker.build(), {.texels_per_metre = 4});
    const std::vector<Rgb> dark(made->patches.count(), Rgb(0, 0, 0));
    std::vector<Rgb> radiosity = dark;
    const auto direct = patch_lamp_irradiance(made->scene, made->atlas, made->patches, *made->tracer, 16, 64);
    for (PatchNumber p = 0; p < made->patches.count(); ++p)
        if (made->patches.patches[p].is_back) radiosity[p] = direct[p] * made->patches.patches[p].reflectance;
    const auto on_wall = [&](std::span<const Rgb> of, float near_m) {
        double sum = 0;
        for (const Rgb& h : gather_all(*made, of, {.rays = 256, .near_m = near_m})) sum += static_cast<double>(h.x);
        return sum;
    };
    const double own = on_wall(dark, 0), known = on_wall(radiosity, 0) - own;  // the sheet's texels have light of the lamp of their own
    EXPECT_GT(known, 0);
    EXPECT_NEAR((on_wall(dark, 0.1f) - own) / known, 1, 0.02);
}

}  // namespace
}  // namespace luxel
