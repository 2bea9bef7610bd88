#include "formats/gltf/gltf_accessor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/gltf/made_gltf.h"

namespace luxel {
namespace {

using test::bad_input_of;
using test::MadeGltf;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<float> floats_of(const MadeGltf& made, std::size_t accessor) {
    return to_floats(read_elements(made.document(), static_cast<std::int64_t>(accessor), "test"));
}
std::string error_of(const MadeGltf& made, std::size_t accessor) {
    return bad_input_of([&] { floats_of(made, accessor); });
}

TEST(GltfAccessor, AllComponentTypes) {
    MadeGltf made;
    const auto i8 = made.array(std::vector<std::int8_t>{-128, 127}, 5120, "SCALAR", 2);
    const auto u8 = made.array(std::vector<std::uint8_t>{0, 255}, 5121, "SCALAR", 2);
    const auto i16 = made.array(std::vector<std::int16_t>{-32768, 32767}, 5122, "SCALAR", 2);
    const auto u16 = made.array(std::vector<std::uint16_t>{1, 65535}, 5123, "SCALAR", 2);
    const auto u32 = made.array(std::vector<std::uint32_t>{1, 65536}, 5125, "SCALAR", 2);
    const auto f32 = made.array(std::vector<float>{-1.5f, 1e30f}, 5126, "SCALAR", 2);
    EXPECT_THAT(floats_of(made, i8), ElementsAre(-128, 127));
    EXPECT_THAT(floats_of(made, u8), ElementsAre(0, 255));
    EXPECT_THAT(floats_of(made, i16), ElementsAre(-32768, 32767));
    EXPECT_THAT(floats_of(made, u16), ElementsAre(1, 65535));
    EXPECT_THAT(floats_of(made, u32), ElementsAre(1, 65536));
    EXPECT_THAT(floats_of(made, f32), ElementsAre(-1.5f, 1e30f));
    for (const auto a : {i8, u8, i16, u16}) made.json["accessors"][a]["normalized"] = true;
    EXPECT_THAT(floats_of(made, i8), ElementsAre(-1, 1));
    EXPECT_THAT(floats_of(made, u8), ElementsAre(0, 1));
    EXPECT_THAT(floats_of(made, i16), ElementsAre(-1, 1));
    EXPECT_THAT(floats_of(made, u16), ElementsAre(testing::FloatEq(1.0f / 65535), 1));
}

TEST(GltfAccessor, StrideOffsetAndMatrices) {
    MadeGltf made;
    const auto interleaved = made.view(std::vector<float>{9, 1, 2, 9, 3, 4, 9, 5, 6}, 12);
    const auto pairs = made.accessor(interleaved, 5126, "VEC2", 3);
    made.json["accessors"][pairs]["byteOffset"] = 4;
    EXPECT_THAT(floats_of(made, pairs), ElementsAre(1, 2, 3, 4, 5, 6));
    // Columns of small types start at multiples of 4 bytes.
    const auto mat2 = made.array(std::vector<std::uint8_t>{1, 2, 0, 0, 3, 4, 0, 0}, 5121, "MAT2", 1);
    EXPECT_THAT(floats_of(made, mat2), ElementsAre(1, 2, 3, 4));
    const auto mat3 = made.array(std::vector<std::uint8_t>{1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 9, 0}, 5121, "MAT3", 1);
    EXPECT_THAT(floats_of(made, mat3), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
    const auto mat4 = made.array(std::vector<float>(16, 2.0f), 5126, "MAT4", 1);
    EXPECT_EQ(floats_of(made, mat4), std::vector<float>(16, 2.0f));
}

TEST(GltfAccessor, LastElementMayEndWithTheView) {
    MadeGltf made;
    const auto view = made.view(std::vector<float>{1, 2, 3, 4, 5, 6, 7}, 16);
    const auto triples = made.accessor(view, 5126, "VEC3", 2);
    EXPECT_THAT(floats_of(made, triples), ElementsAre(1, 2, 3, 5, 6, 7));
}

TEST(GltfAccessor, Sparse) {
    for (const bool has_view : {true, false}) {
        MadeGltf made;
        const auto base = made.array(std::vector<float>{1, 1, 2, 2, 3, 3}, 5126, "VEC2", 3);
        if (!has_view) made.json["accessors"][base].erase("bufferView");
        const auto indices = made.view(std::vector<std::uint16_t>{0, 2});
        const auto values = made.view(std::vector<float>{7, 8, 9, 10});
        made.json["accessors"][base]["sparse"] = {{"count", 2},
                                                  {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                                  {"values", {{"bufferView", values}}}};
        if (has_view) EXPECT_THAT(floats_of(made, base), ElementsAre(7, 8, 2, 2, 9, 10));
        else EXPECT_THAT(floats_of(made, base), ElementsAre(7, 8, 0, 0, 9, 10));

        MadeGltf outside = made;
        outside.json["accessors"][base]["count"] = 2;
        EXPECT_THAT(error_of(outside, base), HasSubstr("index 2 of 2"));
        MadeGltf many = made;
        many.json["accessors"][base]["sparse"]["count"] = 4;
        EXPECT_THAT(error_of(many, base), HasSubstr("replaces 4 elements of 3"));
    }
}

TEST(GltfAccessor, NothingIsReadOutsideTheView) {
    MadeGltf made;
    const auto a = made.array(std::vector<float>(12), 5126, "VEC3", 4);
    const auto with = [&](const char* key, const nlohmann::json& value) {
        MadeGltf other = made;
        other.json["accessors"][a][key] = value;
        return error_of(other, a);
    };
    EXPECT_EQ(error_of(made, a), "");
    EXPECT_EQ(with("count", 0), "");
    EXPECT_THAT(with("count", 5), HasSubstr("do not fit"));
    EXPECT_THAT(with("count", 9007199254740992), HasSubstr("do not fit"));
    EXPECT_THAT(with("count", 1e300), HasSubstr("whole number"));
    EXPECT_THAT(with("count", -1), HasSubstr("whole number"));
    EXPECT_THAT(with("count", 1.5), HasSubstr("whole number"));
    EXPECT_THAT(with("count", "4"), HasSubstr("whole number"));
    EXPECT_THAT(with("byteOffset", 4), HasSubstr("do not fit"));
    EXPECT_THAT(with("byteOffset", 9007199254740992), HasSubstr("do not fit"));
    EXPECT_THAT(with("type", "VEC5"), HasSubstr("VEC5"));
    EXPECT_THAT(with("type", "MAT4"), HasSubstr("do not fit"));
    EXPECT_THAT(with("componentType", 5124), HasSubstr("5124"));
    EXPECT_THAT(with("bufferView", 7), HasSubstr("bufferViews[7]"));
    const auto with_view = [&](const char* key, const nlohmann::json& value) {
        MadeGltf other = made;
        other.json["bufferViews"][0][key] = value;
        return error_of(other, a);
    };
    EXPECT_THAT(with_view("byteLength", 1000), HasSubstr("which has 48"));
    EXPECT_THAT(with_view("byteOffset", 9007199254740992), HasSubstr("which has 48"));
    EXPECT_THAT(with_view("byteStride", 3), HasSubstr("byteStride"));
    EXPECT_THAT(with_view("byteStride", 252), HasSubstr("do not fit"));
    EXPECT_THAT(with_view("buffer", 1), HasSubstr("\"buffer\" is 1"));
}

TEST(GltfAccessor, WithoutAViewItIsZeroAndBounded) {
    MadeGltf made;
    made.json["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 2}});
    EXPECT_EQ(floats_of(made, 0), std::vector<float>(6));
    made.json["accessors"][0]["count"] = 1000000000000;
    EXPECT_THAT(error_of(made, 0), HasSubstr("without a buffer view"));
}

TEST(GltfAccessor, IndicesAreUnsignedScalars) {
    MadeGltf made;
    const auto u8 = made.array(std::vector<std::uint8_t>{3, 255}, 5121, "SCALAR", 2);
    const auto u16 = made.array(std::vector<std::uint16_t>{3, 65535}, 5123, "SCALAR", 2);
    const auto u32 = made.array(std::vector<std::uint32_t>{3, 0xffffffffu}, 5125, "SCALAR", 2);
    const auto i16 = made.array(std::vector<std::int16_t>{3, 4}, 5122, "SCALAR", 2);
    const auto pair = made.array(std::vector<std::uint16_t>{3, 4}, 5123, "VEC2", 1);
    const GltfDocument document = made.document();
    const auto read = [&](std::size_t a) { return to_indices(read_elements(document, static_cast<std::int64_t>(a), "t"), "t"); };
    EXPECT_THAT(read(u8), ElementsAre(3u, 255u));
    EXPECT_THAT(read(u16), ElementsAre(3u, 65535u));
    EXPECT_THAT(read(u32), ElementsAre(3u, 0xffffffffu));
    EXPECT_THAT(bad_input_of([&] { read(i16); }), HasSubstr("unsigned"));
    EXPECT_THAT(bad_input_of([&] { read(pair); }), HasSubstr("SCALAR"));
}

}  // namespace
}  // namespace luxel
