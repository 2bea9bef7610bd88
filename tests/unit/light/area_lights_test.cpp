/// Surfaces that shine over a black floor, through the whole of gathering, against closed forms. E = M F with M = pi L, and F from a
/// point to a shape: J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, numbers as there.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "baker/light/gather.h"
#include "baker/patches/patch_sampler.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::quad;

constexpr double pi_d = std::numbers::pi, nits = 100;

/// B-12: parallel disk of radius r, its plane h above, its axis `aside`. On the axis it is sin^2 of half its apparent angle.
double disk(double r, double h, double aside) {
    const double z = aside * aside + h * h + r * r;
    return 0.5 * (1 - (aside * aside + h * h - r * r) / std::sqrt(z * z - 4 * r * r * aside * aside));
}

/// B-3: parallel rectangle a x b, a corner straight above at h. Odd in a and b.
double parallel_corner(double a, double b, double h) {
    const double x = a / h, y = b / h, p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
    return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2 * pi_d);
}

/// B-4: upright rectangle that begins at the height of the point, a high, b wide, the point at c before a lower corner. Odd in b.
double upright_corner(double a, double b, double c) {
    if (a == 0 || b == 0) return 0;
    const double x = a / std::fabs(b), y = c / std::fabs(b), s = std::sqrt(x * x + y * y);
    return std::copysign((std::atan(1 / y) - y / s * std::atan(1 / s)) / (2 * pi_d), b);
}

/// A disk as a polygon of the same area that looks down.
test::MadeMesh round_plate(double radius, const Vec3f& centre) {
    constexpr std::uint32_t sides = 96;
    test::MadeMesh mesh;
    mesh.positions.push_back(centre);
    const double step = 2 * pi_d / sides, corner = radius * std::sqrt(step / std::sin(step));
    for (std::uint32_t k = 0; k < sides; ++k) {
        mesh.positions.push_back(centre + Vec3f(static_cast<float>(corner * std::cos(k * step)), 0, static_cast<float>(corner * std::sin(k * step))));
        mesh.triangles.push_back({0, 1 + k, 1 + (k + 1) % sides});
    }
    return mesh;
}

struct Errors {
    double mean = 0, rms = 0, worst = 0;  ///< relative to the largest light
    double noise = 0;                     ///< root mean square standard error, by the two halves of the rays
    std::size_t texels = 0;
};

/// A floor of 2 x 2 m around the origin under `plate`. `factor`: from a place on the floor, its normal up.
Errors errors(const test::MadeMesh& plate, const std::function<double(const Vec3d&)>& factor) {
    test::MadeMaterial black, light;
    black.reflectance = light.reflectance = {0, 0, 0};
    light.nits = {nits, nits, nits};
    const auto made = test::prepare(
        test::SceneMaker().add("floor", quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}), black).add("plate", plate, light).build());
    const EmitterSet emitters(made->scene, made->atlas, made->patches);
    const RadiosityDetail detail(std::vector<Rgb>(made->patches.count(), Rgb(0, 0, 0)));
    const LightGuides guides;
    const GatherInput input{made->scene, made->atlas, made->texels, made->patches, *made->tracer, emitters, detail, guides};
    // Several: a texel close to the light has ten times the noise of all, and may be lucky or not.
    constexpr std::uint64_t seeds = 4;
    std::vector<GatheredPage> gathered;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) gathered.push_back(*gather_page(input, 0, {.rays = 1024, .seed = seed}, nullptr));
    const PageTexels& page = made->texels.pages[0];
    Errors sum;
    double largest = 0;
    for (std::size_t k = 0; k < page.texels.size(); ++k) {
        const Texel& texel = page.texels[k];
        if (made->scene.materials[made->scene.objects[made->atlas.charts[texel.chart].object].material].name != "floor") continue;
        const SurfaceSampler sampler(made->scene, made->atlas, {page.fragments.data() + texel.first_fragment, texel.fragment_count}, false);
        double truth = 0;
        for (int i = 0; i < 16; ++i) {
            const SurfacePoint at = sampler.point((static_cast<float>(i % 4) + 0.5f) / 4, (static_cast<float>(i / 4) + 0.5f) / 4);
            truth += pi_d * nits * factor(to_double(at.position) + made->scene.origin) / 16;
        }
        largest = std::max(largest, truth);
        for (const GatheredPage& found : gathered) {
            const auto& halves = found.emitted.halves;
            const double off = static_cast<double>(found.gathered(k).x) - truth;
            const double apart = static_cast<double>(halves[0][k].x - halves[1][k].x) / 2;
            sum.noise += apart * apart, sum.mean += off, sum.rms += off * off, sum.worst = std::max(sum.worst, std::fabs(off)), ++sum.texels;
        }
    }
    const auto count = static_cast<double>(sum.texels);
    return {sum.mean / count / largest, std::sqrt(sum.rms / count) / largest, sum.worst / largest,
            std::sqrt(sum.noise / count) / largest, sum.texels};
}

void expect_small(const Errors& found, const char* name) {
    EXPECT_EQ(found.texels, 4 * 256u) << name;
    ::testing::Test::RecordProperty(name, std::to_string(found.mean) + " mean, " + std::to_string(found.rms) + " rms of " + std::to_string(found.noise) + ", " + std::to_string(found.worst) + " worst");
    EXPECT_LT(found.noise, 0.01) << name;
    EXPECT_LT(found.rms, 1.3 * found.noise) << name << ": texels are right but for their noise";
    EXPECT_LT(std::fabs(found.mean), 3 * found.noise / std::sqrt(static_cast<double>(found.texels))) << name;
    EXPECT_LT(found.worst, 16 * found.noise) << name << ": noise is larger close to the light";
}

TEST(AreaLights, DiskOverAFloor) {
    EXPECT_NEAR(disk(1, 1, 0), 0.5, 1e-12) << "sin^2 of 45 degrees";
    for (const double r : {0.1, 0.5})
        expect_small(errors(round_plate(r, {0.2f, 0.8f, -0.1f}), [&](const Vec3d& p) { return disk(r, 0.8, std::hypot(p.x - 0.2, p.z + 0.1)); }),
                     r < 0.3 ? "small_disk" : "large_disk");
}

TEST(AreaLights, RectangleOverAFloor) {
    EXPECT_NEAR(4 * parallel_corner(1e6, 1e6, 1), 1, 1e-5) << "a plane without end";
    expect_small(errors(quad({-0.3f, 0.7f, -0.6f}, {0.9f, 0, 0}, {0, 0, 0.4f}),
                        [](const Vec3d& p) {
                            const auto up_to = [&](double x, double z) { return parallel_corner(x - p.x, z - p.z, 0.7); };
                            return up_to(0.6, -0.2) - up_to(-0.3, -0.2) - up_to(0.6, -0.6) + up_to(-0.3, -0.6);
                        }),
                 "rectangle");
}

TEST(AreaLights, UprightRectangleBesideAFloor) {
    EXPECT_NEAR(2 * upright_corner(1e6, 1e6, 1), 0.5, 1e-5) << "half of all is a wall without end";
    // Along x = -1.2, from 0.3 to 0.9 m of height, seen from where x is larger.
    expect_small(errors(quad({-1.2f, 0.3f, -0.5f}, {0, 0.6f, 0}, {0, 0, 0.8f}),
                        [](const Vec3d& p) {
                            const auto up_to = [&](double y, double z) { return upright_corner(y, z - p.z, p.x + 1.2); };
                            return up_to(0.9, 0.3) - up_to(0.9, -0.5) - up_to(0.3, 0.3) + up_to(0.3, -0.5);
                        }),
                 "upright");
}

}  // namespace
}  // namespace luxel
