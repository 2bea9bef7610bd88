/// COLOR_0 as read_scene gives it: every kind that glTF knows, and what becomes of the others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "formats/gltf/gltf_in.h"
#include "tests/unit/gltf/made_gltf.h"

namespace luxel {
namespace {

using test::MadeGltf;
using testing::ElementsAre;
using testing::HasSubstr;
using Color = std::array<float, 4>;

/// A square of which two corners are given, the others are zero.
template <class T>
MadeGltf square_with(std::vector<T> values, int component, const std::string& type, bool normalized) {
    MadeGltf made;
    const auto square = made.square();
    const std::size_t width = type == "VEC2" ? 2 : type == "VEC3" ? 3 : 4;
    values.resize(width * 4);
    const std::size_t stride = (width * sizeof(T) + 3) / 4 * 4;
    std::vector<std::uint8_t> bytes(4 * stride);
    for (std::size_t i = 0; i < 4; ++i) std::memcpy(bytes.data() + i * stride, values.data() + i * width, width * sizeof(T));
    const auto colors = made.accessor(made.view(bytes, stride), component, type, 4);
    if (normalized) made.json["accessors"][colors]["normalized"] = true;
    auto& primitive = made.primitive(square);
    primitive["mode"] = 5;
    primitive["attributes"]["COLOR_0"] = colors;
    return made;
}

std::vector<Color> colors_of(const MadeGltf& made, SceneRecord* whole = nullptr) {
    SceneRecord record = read_scene(made.document());
    auto colors = record.meshes[0].primitives[0].colors;
    if (whole) *whole = std::move(record);
    return colors;
}

TEST(GltfColor, AllKinds) {
    const std::vector<Color> none(2, Color{0, 0, 0, 1}), clear(2, Color{0, 0, 0, 0});
    EXPECT_THAT(colors_of(square_with<float>({0.5f, 0.25f, 2, 1, 0, 0}, 5126, "VEC3", false)),
                ElementsAre(Color{0.5f, 0.25f, 2, 1}, Color{1, 0, 0, 1}, none[0], none[1]));
    EXPECT_THAT(colors_of(square_with<float>({0.5f, 0.25f, 0, 0.75f}, 5126, "VEC4", false)),
                ElementsAre(Color{0.5f, 0.25f, 0, 0.75f}, clear[0], clear[0], clear[0]));
    EXPECT_THAT(colors_of(square_with<std::uint8_t>({255, 51, 0}, 5121, "VEC3", true))[0],
                ElementsAre(testing::FloatEq(1), testing::FloatEq(0.2f), 0, 1));
    EXPECT_THAT(colors_of(square_with<std::uint8_t>({255, 51, 0, 102}, 5121, "VEC4", true))[0],
                ElementsAre(testing::FloatEq(1), testing::FloatEq(0.2f), 0, testing::FloatEq(0.4f)));
    EXPECT_THAT(colors_of(square_with<std::uint16_t>({65535, 13107, 0}, 5123, "VEC3", true))[0],
                ElementsAre(testing::FloatEq(1), testing::FloatEq(0.2f), 0, 1));
    EXPECT_THAT(colors_of(square_with<std::uint16_t>({65535, 13107, 0, 26214}, 5123, "VEC4", true))[0],
                ElementsAre(testing::FloatEq(1), testing::FloatEq(0.2f), 0, testing::FloatEq(0.4f)));
}

TEST(GltfColor, IntegersCountAsNormalized) {
    SceneRecord record;
    EXPECT_THAT(colors_of(square_with<std::uint8_t>({255, 51, 0}, 5121, "VEC3", false), &record)[0],
                ElementsAre(testing::FloatEq(1), testing::FloatEq(0.2f), 0, 1));
    ASSERT_EQ(record.warnings.size(), 1u);
    EXPECT_EQ(record.warnings[0].code, "vertex-colours");
    EXPECT_THAT(record.warnings[0].where, HasSubstr("mesh \"m\" primitive 0"));
}

TEST(GltfColor, WhatCannotBeAColourIsIgnoredWithAWarning) {
    for (const MadeGltf& made : {square_with<float>({1, 0}, 5126, "VEC2", false), square_with<std::int8_t>({1, 0}, 5120, "VEC3", true),
                                 square_with<std::int16_t>({1, 0}, 5122, "VEC4", true), square_with<std::uint32_t>({1, 0}, 5125, "VEC3", false)}) {
        SceneRecord record;
        EXPECT_TRUE(colors_of(made, &record).empty());
        ASSERT_EQ(record.warnings.size(), 1u);
        EXPECT_EQ(record.warnings[0].code, "vertex-colours");
    }
}

TEST(GltfColor, DamageIsNamed) {
    MadeGltf made = square_with<float>({1, 0, 0}, 5126, "VEC3", false);
    made.json["accessors"].back()["count"] = 3;
    EXPECT_THAT(test::bad_input_of([&] { read_scene(made.document()); }), HasSubstr("COLOR_0 has 3 elements, POSITION has 4"));
    made.json["accessors"].back()["count"] = 400;
    EXPECT_THAT(test::bad_input_of([&] { read_scene(made.document()); }), HasSubstr("COLOR_0"));
}

TEST(GltfColor, NotReadWhereNotWanted) {
    MadeGltf made = square_with<float>({1, 0, 0}, 5126, "VEC3", false);
    made.json["accessors"].back()["count"] = 400;  // of an array that nobody looks at
    EXPECT_TRUE(read_scene(made.document(), {.vertex_colors = false}).meshes[0].primitives[0].colors.empty());
}

}  // namespace
}  // namespace luxel
