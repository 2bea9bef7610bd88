/// Shadows at texels: their edges against exact coverage, gaps thinner than a texel, and many lamps.
#include "baker/light/texel_lamps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "baker/light/lamps.h"
#include "baker/patches/patch_sampler.h"
#include "tests/support/scenes.h"

namespace luxel {
namespace {

using test::Prepared;
using test::quad;
using test::SceneMaker;

constexpr float floor_side = 10;

/// Metres as the maker had them.
Vec3f world(const Prepared& made, const Vec3f& position) {
    return {static_cast<float>(static_cast<double>(position.x) + made.scene.origin.x), static_cast<float>(static_cast<double>(position.y) + made.scene.origin.y),
            static_cast<float>(static_cast<double>(position.z) + made.scene.origin.z)};
}

/// A floor with one thing above it, under a sun that stands straight above.
std::unique_ptr<Prepared> under_the_sun(const test::MadeMesh& above, double texels_per_metre) {
    auto made = test::prepare(SceneMaker().add("floor", quad({0, 0, 0}, {0, 0, floor_side}, {floor_side, 0, 0})).add("above", above).build(),
                              {.texels_per_metre = texels_per_metre});
    Lamp sun;
    sun.position = {0, 0, 0};
    sun.kind = LampKind::directional;
    sun.direction = {0, -1, 0};
    sun.intensity = {1, 1, 1};
    made->scene.lamps = {sun};
    return made;
}

struct FloorTexel {
    Parallelogram place;
    Rgb light;
};

/// Those of the floor that are whole squares.
std::vector<FloorTexel> light_floor(const Prepared& made, const TexelLampOptions& options) {
    std::vector<FloorTexel> found;
    for (const PageTexels& page : made.texels.pages) {
        const std::vector<float> nothing(page.texels.size(), 0);
        const auto light = texel_lamps(made.scene, made.atlas, page, made.texels.page_size, *made.tracer, nothing, options);
        if (!light) throw std::runtime_error("nobody asked it to stop");
        for (std::size_t k = 0; k < page.texels.size(); ++k) {
            const Texel& texel = page.texels[k];
            const SurfaceSampler sampler(made.scene, made.atlas, {page.fragments.data() + texel.first_fragment, texel.fragment_count}, false);
            if (sampler.flat() && std::fabs(world(made, sampler.flat()->origin).y) < 1e-4f) found.push_back({*sampler.flat(), (*light)[k]});
        }
    }
    return found;
}

/// Largest and root mean square error against a lit half plane: all points that `is_lit` in a fine grid.
struct Errors {
    double largest = 0, root_mean_square = 0;
    std::size_t edges = 0;  ///< texels that an edge runs through
};
template <class IsLit>
Errors errors(const Prepared& made, const std::vector<FloorTexel>& floor, const IsLit& is_lit) {
    constexpr int steps = 200;
    Errors found;
    for (const FloorTexel& texel : floor) {
        int lit = 0;
        for (int i = 0; i < steps * steps; ++i) {
            const float u = (static_cast<float>(i % steps) + 0.5f) / steps, v = (static_cast<float>(i / steps) + 0.5f) / steps;
            lit += is_lit(world(made, texel.place.origin + texel.place.side_u * u + texel.place.side_v * v));
        }
        if (lit == 0 || lit == steps * steps) {
            EXPECT_EQ(texel.light.x, lit ? 1.0f : 0.0f);
            continue;
        }
        const double error = std::fabs(static_cast<double>(texel.light.x) - static_cast<double>(lit) / (steps * steps));
        found.largest = std::max(found.largest, error), found.root_mean_square += error * error, ++found.edges;
    }
    found.root_mean_square = std::sqrt(found.root_mean_square / static_cast<double>(std::max<std::size_t>(found.edges, 1)));
    return found;
}

TEST(TexelLamps, EdgesOfShadowsAreRight) {
    // The plate's edge runs through the middle of the floor, aslant.
    const Vec3f along(std::cos(0.3f), 0, std::sin(0.3f)), aside(along.z, 0, -along.x);
    const Vec3f middle(floor_side / 2, 1, floor_side / 2);
    const auto made = under_the_sun(test::turned(quad(middle - along * 20, along * 40, aside * 40)), 4);
    const auto is_lit = [&](const Vec3f& at) { return (at - middle).dot(aside) < 0; };
    const Errors few = errors(*made, light_floor(*made, {.points = 4}), is_lit),
                 many = errors(*made, light_floor(*made, {.points = 4, .edge_points = 64}), is_lit);
    EXPECT_GT(many.edges, 40u);
    EXPECT_GT(few.largest, 0.15);
    EXPECT_LT(many.root_mean_square, 0.02);
    EXPECT_LT(many.largest, 0.08);
    EXPECT_LT(many.root_mean_square, few.root_mean_square / 4);
}

/// If a texel's own first points decided that it is dark, the light of thin gaps would be lost.
TEST(TexelLamps, LightThroughThinGapsIsNotLost) {
    test::MadeMesh grate;
    constexpr float period = 0.37f, gap = 0.02f;
    for (float x = 0; x < floor_side; x += period) test::add_quad(grate, {x + gap, 1, -1}, {0, 0, floor_side + 2}, {period - gap, 0, 0});
    const auto made = under_the_sun(test::turned(grate), 4);
    const auto floor = light_floor(*made, {.points = 4, .edge_points = 64});
    double sum = 0;
    for (const FloorTexel& texel : floor) sum += static_cast<double>(texel.light.x);
    // 28 gaps of 2 cm over 10 m.
    EXPECT_NEAR(sum / static_cast<double>(floor.size()), 28 * 0.02 / 10, 0.05 * 0.056);
}

TEST(TexelLamps, ManyLampsGiveTheirSum) {
    const auto made = under_the_sun(quad({2, 1, 2}, {5, 0, 0}, {0, 0, 5}), 2);
    std::vector<Lamp> lamps;
    for (int k = 0; k < 150; ++k) {
        const float turn = static_cast<float>(k) * 0.7f;
        Lamp lamp;
        lamp.kind = LampKind::point;
        lamp.direction = {0, -1, 0};
        lamp.position = Vec3f(4 * std::cos(turn), 1.5f + static_cast<float>(k % 7) * 0.2f, 4 * std::sin(turn)) + Vec3f(5, 0, 5) - world(*made, {0, 0, 0});
        lamp.intensity = Rgb(1, 2, 3) * static_cast<float>(1 + k % 11);
        if (k % 3 == 0) lamp.radius = 0.05f;
        lamps.push_back(lamp);
    }
    std::vector<Rgb> all;
    for (const Lamp& lamp : lamps) {
        made->scene.lamps = {lamp};
        const auto floor = light_floor(*made, {.points = 64});
        all.resize(floor.size(), Rgb(0, 0, 0));
        for (std::size_t k = 0; k < floor.size(); ++k) all[k] += floor[k].light;
    }
    made->scene.lamps = lamps;
    double mean = 0, expected = 0, squares = 0;
    const auto floor = light_floor(*made, {.points = 4, .edge_points = 64});
    ASSERT_GT(floor.size(), 80u);
    for (std::size_t k = 0; k < floor.size(); ++k) {
        mean += static_cast<double>(floor[k].light.y), expected += static_cast<double>(all[k].y);
        squares += std::pow(static_cast<double>(floor[k].light.y - all[k].y), 2);
    }
    EXPECT_NEAR(mean, expected, 0.005 * expected);
    const double count = static_cast<double>(floor.size());
    EXPECT_LT(std::sqrt(squares / count), 0.03 * expected / count);
}

TEST(TexelLamps, EndsEmptyWhenItIsAskedToStop) {
    const auto made = under_the_sun(quad({2, 1, 2}, {5, 0, 0}, {0, 0, 5}), 2);
    StopRequest stop;
    stop.ask();
    const PageTexels& page = made->texels.pages[0];
    const std::vector<float> nothing(page.texels.size(), 0);
    EXPECT_FALSE(texel_lamps(made->scene, made->atlas, page, made->texels.page_size, *made->tracer, nothing, {.stop = &stop}));
}

/// A lamp that is left out of the list lights no point around the place.
TEST(LampStrengths, HoldsEveryLampThatLightsAPointNearby) {
    std::uint32_t state = 1;
    const auto random = [&] { return static_cast<float>(state = state * 1664525u + 1013904223u) / 4294967296.0f; };
    const auto any = [&](float side) { return Vec3f(random() - 0.5f, random() - 0.5f, random() - 0.5f) * side; };
    int left_out = 0, lit = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        Lamp lamp;
        lamp.kind = static_cast<LampKind>(trial % 3);
        lamp.position = any(4), lamp.direction = any(1).normalized(), lamp.intensity = {1, 1, 1};
        lamp.cos_outer = 0.9f * random(), lamp.cos_inner = lamp.cos_outer + 0.05f;
        if (random() < 0.5f) lamp.range = 0.2f + random();
        if (random() < 0.5f && lamp.kind != LampKind::directional) lamp.radius = 0.3f * random();
        if (random() < 0.5f && lamp.kind == LampKind::directional) lamp.sin_radius = 0.3f * random();
        const Vec3f place = any(2), normal = any(1).normalized();
        const float around = random() < 0.2f ? 0.0f : random();
        const bool found = !lamp_strengths({&lamp, 1}, place, around, &normal).empty();
        EXPECT_TRUE(!found || !lamp_strengths({&lamp, 1}, place, around, nullptr).empty());
        left_out += !found;
        for (int k = 0; k < 8; ++k) {
            const Vec3f at = place + any(1).normalized() * (around * random());
            if (unshadowed_irradiance(lamp, at, normal) != Rgb(0, 0, 0)) {
                ++lit;
                EXPECT_TRUE(found) << trial;
            }
        }
    }
    EXPECT_GT(left_out, 1000);
    EXPECT_GT(lit, 1000);
}

/// Solid angle of the rectangle from the corner (0, 0) to (x, z), seen from the height h above that corner; odd in x and z.
double corner_angle(double x, double z, double h) { return std::atan(x * z / (h * std::sqrt(x * x + z * z + h * h))); }

/// A lamp two centimetres above a floor of texels of more than a metre: each gets the intensity times its solid angle over its area. Even points would miss the spot,
/// or find it a thousand times too bright.
TEST(TexelLamps, ALampCloseToALargeTexel) {
    auto made = test::prepare(SceneMaker().add("floor", quad({0, 0, 0}, {0, 0, floor_side}, {floor_side, 0, 0})).build(), {.texels_per_metre = 0.8});
    Lamp lamp;
    lamp.direction = {0, -1, 0};
    lamp.position = {3.3f - static_cast<float>(made->scene.origin.x), 0.02f - static_cast<float>(made->scene.origin.y), 6.1f - static_cast<float>(made->scene.origin.z)};
    lamp.intensity = {1, 1, 1};
    made->scene.lamps = {lamp};
    double largest = 0, all = 0;
    for (const FloorTexel& texel : light_floor(*made, {.points = 16, .edge_points = 128})) {
        const Vec3f a = texel.place.origin - lamp.position, b = a + texel.place.side_u + texel.place.side_v;
        const auto part = [&](float x, float z) { return corner_angle(static_cast<double>(x), static_cast<double>(z), 0.02); };
        const double angle = std::fabs(part(b.x, b.z) - part(a.x, b.z) - part(b.x, a.z) + part(a.x, a.z));
        const double area = static_cast<double>(std::fabs(texel.place.side_u.cross(texel.place.side_v).length()));
        const double expected = angle / area;
        largest = std::max(largest, expected), all += angle;
        EXPECT_NEAR(static_cast<double>(texel.light.x) / expected, 1, expected > 1 ? 0.05 : 0.2) << a.x << " " << a.z;
    }
    EXPECT_GT(largest, 1);
    EXPECT_GT(all, 6) << "nearly half of all directions end on the floor";
}

}  // namespace
}  // namespace luxel
