/// Lamps on coarse meshes with round normals: as the smooth surface has them, up to the terminator and beyond.
#include <gtest/gtest.h>

#include <cmath>

#include "baker/core/sobol.h"
#include "baker/light/gather.h"
#include "baker/light/lamps.h"
#include "baker/light/sky.h"
#include "baker/patches/patch_sampler.h"
#include "baker/patches/smooth_rise.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::Prepared;
using test::SceneMaker;

constexpr float lux = 1000;
/// Where the sun stands: not along a corner or an edge of the mesh.
const Vec3f to_sun = Vec3f(0.83f, 0.31f, 0.47f).normalized();

LampRecord sun() {
    LampRecord lamp;
    lamp.kind = LampKind::directional;
    lamp.intensity = {lux, lux, lux};
    // Rows are the images of the axes; the lamp shines along -Z.
    const Vec3f side = to_sun.cross(Vec3f(0, 1, 0)).normalized(), up = side.cross(to_sun);
    lamp.world = Imath::M44d(side.x, side.y, side.z, 0, up.x, up.y, up.z, 0, to_sun.x, to_sun.y, to_sun.z, 0, 0, 0, 0, 1);
    return lamp;
}

/// A ball in the sun, 12 meridians and 8 circles of latitude.
std::unique_ptr<Prepared> ball(bool smooth) {
    const test::MadeMesh mesh = test::uv_sphere(12, 8, 1);
    SceneMaker maker;
    maker.add("ball", mesh).add_lamp(sun());
    if (smooth) maker.record().meshes.back().primitives.front().normals = mesh.positions;
    return test::prepare(maker.build(), {.texels_per_metre = 12});
}

struct Errors {
    double rms = 0, worst = 0;  ///< relative to what the sun gives to a surface that faces it
};

/// Against the true sphere, whose normal at a point is that of shading; over points of all texels, or in a band along the terminator.
Errors errors(const Prepared& made, bool raised) {
    const LampLight light(made.scene, *made.tracer);
    Errors found;
    double count = 0;
    for (PatchNumber p = 0; p < made.patches.count(); ++p) {
        const PatchSampler sampler(made.scene, made.atlas, made.patches, p);
        const SobolSequence sequence(p);
        for (std::uint32_t k = 0; k < 64; ++k) {
            const auto u = sequence.point(k);
            const SurfacePoint at = sampler.point(u[0], u[1]);
            LightPoint point{at.position, at.normal, sampler.shading_normal(at), at.triangle};
            if (raised) point.rise = smooth_rise(made.scene, at.triangle, at.barycentric);
            const float truth = lux * std::max(0.0f, to_sun.dot(point.shading_normal));
            const double off = static_cast<double>((light.irradiance(point, 0.5f, {0.5f, 0.5f}).x - truth) / lux);
            found.rms += off * off, found.worst = std::max(found.worst, std::fabs(off)), ++count;
        }
    }
    found.rms = std::sqrt(found.rms / count);
    return found;
}

TEST(SmoothLight, TheTerminatorOfACoarseBallIsRound) {
    const auto made = ball(true);
    const Errors plain = errors(*made, false), raised = errors(*made, true);
    RecordProperty("on_the_triangles", std::to_string(plain.rms) + " rms, " + std::to_string(plain.worst) + " worst");
    RecordProperty("on_the_smooth_surface", std::to_string(raised.rms) + " rms, " + std::to_string(raised.worst) + " worst");
    EXPECT_GT(plain.rms, 0.01);
    EXPECT_GT(plain.worst, 0.2);
    EXPECT_LT(raised.rms, 1e-5);
    EXPECT_LT(raised.worst, 1e-4);
}

/// Irradiance of each texel with a page of light from a sky or lamps alone.
std::vector<Rgb> gathered(const Prepared& made, const Sky* sky, const GatherOptions& options) {
    const EmitterSet emitters(made.scene, made.atlas, made.patches);
    const RadiosityDetail detail(std::vector<Rgb>(made.patches.count(), Rgb(0, 0, 0)));
    const LightGuides guides;
    return gather_page({made.scene, made.atlas, made.texels, made.patches, *made.tracer, emitters, detail, guides, sky}, 0, options, nullptr)
        ->irradiance();
}

TEST(SmoothLight, TexelsOfACoarseBallInTheSun) {
    const auto made = ball(true);
    ASSERT_EQ(made->texels.pages.size(), 1u);
    const PageTexels& page = made->texels.pages[0];
    const std::vector<Rgb> light = gathered(*made, nullptr, {.rays = 4, .lamp_points = 256});
    for (std::size_t k = 0; k < page.texels.size(); ++k) {
        const SurfaceSampler sampler(made->scene, made->atlas, {page.fragments.data() + page.texels[k].first_fragment, page.texels[k].fragment_count}, false);
        const SobolSequence sequence(1);
        double truth = 0;
        for (std::uint32_t j = 0; j < 256; ++j) {
            const auto u = sequence.point(j);
            truth += static_cast<double>(std::max(0.0f, to_sun.dot(sampler.shading_normal(sampler.point(u[0], u[1]))))) / 256;
        }
        EXPECT_NEAR(light[k].x / lux, truth, 1e-3);
    }
}

/// Everywhere pi times the luminance of an even sky, though the triangles lean away from their normals.
TEST(SmoothLight, ACoarseBallSeesAllOfTheSky) {
    const SkyMap even{1, 1, {Rgb(1, 1, 1)}, 0};
    SkyMap uneven{16, 8, std::vector<Rgb>(128, Rgb(1, 1, 1)), 0};
    uneven.nits[35] = Rgb(300, 300, 300);
    for (const bool smooth : {false, true}) {
        const auto made = ball(smooth);
        made->scene.lamps.clear();
        const Sky sky(even);
        for (const Rgb& h : gathered(*made, &sky, {.rays = 64})) EXPECT_NEAR(h.x, 3.14159265f, 1e-4f);
    }
}

/// The same with rays that are aimed at what is bright in the sky, where it is below the horizon or grazes the ball.
TEST(SmoothLight, ACoarseBallUnderAnUnevenSky) {
    SkyMap map{16, 8, std::vector<Rgb>(128, Rgb(1, 1, 1)), 0};
    map.nits[35] = Rgb(300, 300, 300);
    const auto made = ball(true);
    made->scene.lamps.clear();
    const Sky sky(map);
    const PageTexels& page = made->texels.pages[0];
    const std::vector<Rgb> light = gathered(*made, &sky, {.rays = 1024});
    double truth = 0, found = 0;
    for (std::size_t k = 0; k < page.texels.size(); k += 4) {
        const Texel& texel = page.texels[k];
        const SurfaceSampler sampler(made->scene, made->atlas, {page.fragments.data() + texel.first_fragment, texel.fragment_count}, false);
        double own = 0;
        for (const float u : {0.25f, 0.75f})
            for (const float v : {0.25f, 0.75f})
                own += static_cast<double>(sky.irradiance(sampler.shading_normal(sampler.point(u, v))).x) / 4;
        if (own > 6) continue;
        const auto area = static_cast<double>(texel.area_m2);
        truth += area * own, found += area * static_cast<double>(light[k].x);
    }
    EXPECT_NEAR(found / truth, 1, 0.003);
}

}  // namespace
}  // namespace luxel
