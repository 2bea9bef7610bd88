/// Skies of all kinds as they come into the scene, and sizes of lamps.
#include "baker/scene/scene_sky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace luxel {
namespace {

SkyMap sky_of(const SkyWish& wish, const SkyRecord& record = {}, const ImageDecoder& decode = {},
              std::vector<Warning>* found = nullptr, BadValues bad_values = BadValues::clamp) {
    std::vector<Warning> warnings;
    BuildOptions options;
    options.sky = wish;
    options.bad_values = bad_values;
    const SkyMap sky = build_sky(record, decode, options, warnings);
    if (found)
        *found = warnings;
    else
        EXPECT_TRUE(warnings.empty());
    return sky;
}

DecodedImage picture(std::uint32_t width, std::uint32_t height,
                     const std::function<float(std::uint32_t, std::uint32_t)>& value) {
    DecodedImage made{width, height, {}};
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) made.rgba.push_back({value(x, y), 2 * value(x, y), 0, 1});
    return made;
}

TEST(SceneSky, IsWhatIsAskedFor) {
    EXPECT_TRUE(sky_of({}).empty());
    const SkyMap even = sky_of({.color = std::array{10.0, 20.0, 30.0}, .turn_degrees = 90, .scale = 2});
    ASSERT_EQ(even.nits.size(), 1u);
    EXPECT_EQ(even.nits[0], Rgb(20, 40, 60));
    EXPECT_NEAR(even.turn, 1.5707963, 1e-6);
    const SkyMap map =
        sky_of({.picture = picture(4, 2, [](auto x, auto y) { return static_cast<float>(x + 4 * y); }), .scale = 10});
    EXPECT_EQ(map.width, 4u);
    EXPECT_EQ(map.height, 2u);
    EXPECT_EQ(map.nits[6], Rgb(60, 120, 0));
    EXPECT_FALSE(sky_of({.color = std::array{0.0, 0.0, 0.0}}).empty()) << "a black sky is a sky";
}

TEST(SceneSky, LargePicturesAreAveraged) {
    const SkyMap map = sky_of({.picture = picture(4096, 2, [](auto x, auto) { return x % 2 ? 3.0f : 1.0f; })});
    EXPECT_EQ(map.width, 2048u);
    EXPECT_EQ(map.height, 1u);
    for (const Rgb& nits : map.nits) ASSERT_EQ(nits.x, 2);
}

TEST(SceneSky, BadValuesAreClampedOrRefused) {
    const auto bad = picture(2, 1, [](auto x, auto) { return x ? std::numeric_limits<float>::quiet_NaN() : -1.0f; });
    std::vector<Warning> warnings;
    for (const Rgb& nits : sky_of({.picture = bad}, {}, {}, &warnings).nits) EXPECT_EQ(nits, Rgb(0, 0, 0));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0].code, "sky-clamped");
    EXPECT_THROW(sky_of({.picture = bad}, {}, {}, &warnings, BadValues::refuse), Error);
}

/// Each face of the cubemap in a colour of its own, with one bright quarter of the +Z face.
struct Cube {
    Cube() {
        record.is_there = true;
        for (std::size_t k = 0; k < 6; ++k) record.faces[k].bytes = {static_cast<std::uint8_t>(k)};
    }
    static std::optional<DecodedImage> decode(ByteView bytes, const std::string&) {
        DecodedImage face{16, 16, {}};
        for (int k = 0; k < 256; ++k) {
            const bool upper_left = k % 16 < 8 && k / 16 < 8;
            // RGBD: white divided by alpha.
            face.rgba.push_back(
                {1, 1, 1, bytes[0] == 4 && upper_left ? 0.01f : 1.0f / static_cast<float>(bytes[0] + 1)});
        }
        return face;
    }
    /// At the middle of the picture's pixel that looks along d.
    static float at(const SkyMap& sky, const Vec3d& d) {
        const double down = std::acos(d.y / d.length()) / 3.14159265358979,
                     along = std::atan2(d.z, d.x) / (2 * 3.14159265358979) + 0.5;
        return sky
            .nits[static_cast<std::size_t>(down * sky.height) * sky.width + static_cast<std::size_t>(along * sky.width)]
            .x;
    }
    SkyRecord record;
};

TEST(SceneSky, CubemapsAreUnrolled) {
    Cube cube;
    cube.record.intensity = 10;
    const SkyMap sky = sky_of({}, cube.record, Cube::decode);
    EXPECT_EQ(sky.width, 64u);
    const std::array<Vec3d, 6> axes{
        {{1, 0.1, 0.1}, {-1, 0.1, 0.1}, {0.1, 1, 0.1}, {0.1, -1, 0.1}, {0.2, -0.2, 1}, {0.1, 0.1, -1}}};
    for (std::size_t k = 0; k < 6; ++k)
        EXPECT_NEAR(Cube::at(sky, axes[k]), 10.0f * static_cast<float>(k + 1), 1e-3) << k;
    // Seen from the middle, +X is on the left when one looks along +Z with Y up.
    EXPECT_NEAR(Cube::at(sky, {0.3, 0.3, 1}), 1000, 0.1) << "upper left";
    EXPECT_NEAR(Cube::at(sky, {-0.3, 0.3, 1}), 50, 0.1) << "upper right";
    // Half a turn about Y brings -X where +X was.
    cube.record.rotation = {0, 1, 0, 0};
    EXPECT_NEAR(Cube::at(sky_of({}, cube.record, Cube::decode), {1, 0.1, 0.1}), 20, 1e-3);
    // A quarter turn counter-clockwise from above takes +X to -Z.
    cube.record.rotation = {0, std::sqrt(0.5), 0, std::sqrt(0.5)};
    EXPECT_NEAR(Cube::at(sky_of({}, cube.record, Cube::decode), {0.1, 0.1, -1}), 10, 1e-3);
    EXPECT_TRUE(sky_of({.none = true}, cube.record, Cube::decode).empty());
    cube.record.faces[2].bytes.clear();
    std::vector<Warning> warnings;
    EXPECT_TRUE(sky_of({}, cube.record, Cube::decode, &warnings).empty());
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0].code, "sky-missing");
}

/// What a lamp is after its node was scaled, mirrored and nested: place and direction change, light and size do not.
TEST(SceneLamps, TransformsChangePlaceAndDirectionOnly) {
    SceneRecord record;
    LampRecord lamp;
    lamp.kind = LampKind::spot;
    lamp.intensity = {5, 6, 7};
    lamp.range = 4;
    lamp.inner_cone = 0.3, lamp.outer_cone = 0.6;
    lamp.radius = 0.25;
    Imath::M44d scale, turn, shift;
    scale.setScale(Imath::V3d(-3, 0.1, 20));
    turn.setAxisAngle(Imath::V3d(1, 0, 0), 3.14159265358979 / 2);
    shift.setTranslation(Imath::V3d(1, 2, 3));
    for (const Imath::M44d& world : {Imath::M44d(), scale, scale * turn * shift, turn * scale * shift}) {
        lamp.world = world;
        record.lamps = {lamp};
        std::vector<Warning> warnings;
        const Scene scene = build_scene(record, {}, {}, warnings);
        ASSERT_EQ(scene.lamps.size(), 1u);
        const Lamp& made = scene.lamps[0];
        EXPECT_EQ(made.intensity, Rgb(5, 6, 7));
        EXPECT_EQ(made.range, 4);
        EXPECT_EQ(made.radius, 0.25f);
        EXPECT_FLOAT_EQ(made.cos_outer, std::cos(0.6f));
        EXPECT_NEAR(made.direction.length(), 1, 1e-6);
        const Vec3d axis(-world[2][0], -world[2][1], -world[2][2]);
        EXPECT_NEAR((to_double(made.direction) - axis.normalized()).length(), 0, 1e-6);
        EXPECT_NEAR((to_double(made.position) + scene.origin - Vec3d(world[3][0], world[3][1], world[3][2])).length(),
                    0, 1e-6);
        EXPECT_TRUE(warnings.empty());
    }
}

TEST(SceneLamps, SizesOfTheFileComeBeforeTheOptions) {
    SceneRecord record;
    record.lamps.resize(4);
    for (LampRecord& lamp : record.lamps) lamp.intensity = {1, 1, 1};
    record.lamps[1].radius = 0;
    record.lamps[2].kind = record.lamps[3].kind = LampKind::directional;
    record.lamps[3].angle_degrees = 2;
    std::vector<Warning> warnings;
    const Scene scene = build_scene(record, {}, {.lamp_radius = 0.5, .sun_angle_degrees = 1}, warnings);
    EXPECT_EQ(scene.lamps[0].radius, 0.5f);
    EXPECT_EQ(scene.lamps[1].radius, 0) << "the file says that it is a point";
    EXPECT_FLOAT_EQ(scene.lamps[2].sin_radius, std::sin(0.5f * 3.14159265f / 180));
    EXPECT_FLOAT_EQ(scene.lamps[3].sin_radius, std::sin(3.14159265f / 180));
    EXPECT_NE(scene.light_key, build_scene(record, {}, {.lamp_radius = 0.6}, warnings).light_key);
}

}  // namespace
}  // namespace luxel
