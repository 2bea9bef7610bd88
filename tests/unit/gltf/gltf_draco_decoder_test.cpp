// Streams that claim more than they can hold: refused before memory or time is spent on them.
#include "formats/gltf/gltf_draco_decoder.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "tests/unit/gltf/made_gltf.h"

namespace luxel {
namespace {

using test::bad_input_of;
using testing::HasSubstr;

/// A flat, regular sheet of 2 * (side - 1)^2 triangles with texture coordinates: no surface takes fewer bytes a triangle.
Bytes sheet_stream(std::uint32_t side, draco::MeshEncoderMethod method, int speed) {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(static_cast<int>(2 * (side - 1) * (side - 1)));
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
    const auto triangle = [&](std::uint32_t t, const std::array<std::array<std::uint32_t, 2>, 3>& corners) {
        std::array<std::array<float, 3>, 3> points{};
        std::array<std::array<float, 2>, 3> places{};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto x = static_cast<float>(corners[k][0]), z = static_cast<float>(corners[k][1]);
            points[k] = {x, 0, z};
            places[k] = {x / static_cast<float>(side), z / static_cast<float>(side)};
        }
        builder.SetAttributeValuesForFace(position, draco::FaceIndex(t), points[0].data(), points[1].data(), points[2].data());
        builder.SetAttributeValuesForFace(uv, draco::FaceIndex(t), places[0].data(), places[1].data(), places[2].data());
    };
    for (std::uint32_t z = 0, t = 0; z + 1 < side; ++z)
        for (std::uint32_t x = 0; x + 1 < side; ++x) {
            triangle(t++, {{{x, z}, {x, z + 1}, {x + 1, z}}});
            triangle(t++, {{{x + 1, z}, {x, z + 1}, {x + 1, z + 1}}});
        }
    const auto mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    encoder.SetSpeedOptions(speed, speed);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 11);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, 10);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    return Bytes(buffer.data(), buffer.data() + buffer.size());
}

void put_varint(Bytes& out, std::uint32_t value) {
    for (; value > 127; value >>= 7) out.push_back(static_cast<std::uint8_t>(value | 128));
    out.push_back(static_cast<std::uint8_t>(value));
}

constexpr std::size_t header_bytes = 11;  // "DRACO", version, kind, method, flags

/// The stream with other counts in the place of the two that follow the first `before` bytes.
Bytes with_counts(const Bytes& stream, std::size_t before, std::uint32_t first, std::uint32_t second) {
    std::size_t after = before;
    for (int count = 0; count < 2; ++count)
        while (stream[after++] & 128) {}
    Bytes out(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(before));
    put_varint(out, first);
    put_varint(out, second);
    out.insert(out.end(), stream.begin() + static_cast<std::ptrdiff_t>(after), stream.end());
    return out;
}

std::string error_of(const Bytes& stream) {
    return bad_input_of([&] { decode_draco_mesh(stream, "here"); });
}

TEST(GltfDracoDecoder, RegularSheetsAreWithinTheBounds) {
    const Bytes stream = sheet_stream(257, draco::MESH_EDGEBREAKER_ENCODING, 0);
    EXPECT_LT(stream.size(), 2000u);
    EXPECT_EQ(decode_draco_mesh(stream, "here")->num_faces(), 2u * 256 * 256);
    EXPECT_EQ(decode_draco_mesh(sheet_stream(65, draco::MESH_SEQUENTIAL_ENCODING, 5), "here")->num_faces(), 2u * 64 * 64);
}

/// Wherever the number of orientations is, sooner or later it says 2^31 - 1: that alone took Draco 10 s.
TEST(GltfDracoDecoder, OrientationsAreAtMostTheCorners) {
    const Bytes good = sheet_stream(6, draco::MESH_EDGEBREAKER_ENCODING, 0);
    std::vector<std::string> refusals;
    for (std::size_t at = header_bytes; at + 4 <= good.size(); ++at) {
        Bytes stream = good;
        for (std::size_t k = 0; k < 4; ++k) stream[at + k] = k < 3 ? 255 : 127;
        const std::string error = error_of(stream);
        if (error.find("claims 2147483647 orientations") != std::string::npos) refusals.push_back(error);
    }
    ASSERT_EQ(refusals.size(), 1u);
    EXPECT_THAT(refusals[0], testing::AllOf(HasSubstr("here: Draco: "), HasSubstr("at most 150 for its corners")));
}

TEST(GltfDracoDecoder, TrianglesAreBoundedByTheBytes) {
    constexpr std::uint32_t many = 1u << 30, allowed = 1u << 21;  // twice, for the seams of the texture coordinates
    const Bytes edgebreaker = sheet_stream(6, draco::MESH_EDGEBREAKER_ENCODING, 0);
    const std::size_t before = header_bytes + 1;  // how the triangles are followed
    EXPECT_THAT(error_of(with_counts(edgebreaker, before, 36, many)), HasSubstr("triangles or points"));
    EXPECT_THAT(error_of(with_counts(edgebreaker, before, many, many)), HasSubstr("triangles or points"));
    EXPECT_THAT(error_of(with_counts(edgebreaker, before, 36, allowed)), testing::Not(testing::AnyOf("", HasSubstr("claims"))));
    const Bytes sequential = sheet_stream(6, draco::MESH_SEQUENTIAL_ENCODING, 5);
    EXPECT_THAT(error_of(with_counts(sequential, header_bytes, many, 36)), HasSubstr("triangles or points"));
    EXPECT_THAT(error_of(with_counts(sequential, header_bytes, 50, 1u << 31)), HasSubstr("triangles or points"));
}

/// Each attribute with seams of its own has a table of all corners.
TEST(GltfDracoDecoder, TablesOfSeamsCountAsTriangles) {
    Bytes stream = with_counts(sheet_stream(6, draco::MESH_EDGEBREAKER_ENCODING, 0), header_bytes + 1, 36, 1u << 20);
    const std::size_t tables = header_bytes + 1 + 1 + 3;  // 36 takes a byte, 2^20 takes three
    ASSERT_EQ(stream[tables], 1);
    EXPECT_THAT(error_of(stream), testing::Not(testing::AnyOf("", HasSubstr("claims"))));
    stream[tables] = 255;
    EXPECT_THAT(error_of(stream), HasSubstr("claims 268435456 triangles"));
}

/// A stream whose indices are not compressed, with one attribute of integers, up to that attribute's values.
Bytes plain_stream(std::uint32_t triangles, std::uint32_t points, draco::DataType type, std::uint8_t components, const Bytes& indices) {
    Bytes stream{'D', 'R', 'A', 'C', 'O', 2, 2, draco::TRIANGULAR_MESH, draco::MESH_SEQUENTIAL_ENCODING, 0, 0};
    put_varint(stream, triangles);
    put_varint(stream, points);
    stream.push_back(1);
    stream.insert(stream.end(), indices.begin(), indices.end());
    const Bytes one_attribute{1, 1, draco::GeometryAttribute::GENERIC, static_cast<std::uint8_t>(type), components, 0, 0,
                              draco::SEQUENTIAL_ATTRIBUTE_ENCODER_INTEGER};
    stream.insert(stream.end(), one_attribute.begin(), one_attribute.end());
    return stream;
}

/// 300,000 points, and all corners of triangles at the first one.
TEST(GltfDracoDecoder, AttributesAreBoundedByTheBytes) {
    EXPECT_THAT(error_of(plain_stream(100000, 300000, draco::DT_FLOAT64, 255, Bytes(300000))), HasSubstr("claims 612000000 bytes of attributes"));
}

TEST(GltfDracoDecoder, PredictionsThatAreNoneAreRefused) {
    const auto stream_with = [](int method, int transform) {
        Bytes stream = plain_stream(1, 3, draco::DT_UINT8, 1, {0, 1, 2});
        // Of one byte each, not compressed: 3 and two differences of 0; then least and largest value, of 32 bits.
        const Bytes values{static_cast<std::uint8_t>(method), static_cast<std::uint8_t>(transform), 0, 1, 6, 0, 0, 0, 0, 0, 0, 9, 0, 0, 0};
        stream.insert(stream.end(), values.begin(), values.end());
        return stream;
    };
    EXPECT_EQ(error_of(stream_with(draco::PREDICTION_DIFFERENCE, draco::PREDICTION_TRANSFORM_WRAP)), "");
    EXPECT_THAT(error_of(stream_with(-34, draco::PREDICTION_TRANSFORM_WRAP)), HasSubstr("attributes"));
    EXPECT_THAT(error_of(stream_with(draco::NUM_PREDICTION_SCHEMES, draco::PREDICTION_TRANSFORM_WRAP)), HasSubstr("attributes"));
    EXPECT_THAT(error_of(stream_with(draco::PREDICTION_DIFFERENCE, 77)), HasSubstr("attributes"));
    EXPECT_THAT(error_of(stream_with(draco::PREDICTION_DIFFERENCE, -2)), HasSubstr("attributes"));
}

TEST(GltfDracoDecoder, OtherKindsAreNamed) {
    Bytes stream = sheet_stream(3, draco::MESH_SEQUENTIAL_ENCODING, 5);
    stream[8] = 7;
    EXPECT_THAT(error_of(stream), HasSubstr("found method 7"));
    stream[7] = draco::POINT_CLOUD;
    EXPECT_THAT(error_of(stream), HasSubstr("no mesh"));
    EXPECT_THAT(error_of({}), HasSubstr("here: Draco"));
}

}  // namespace
}  // namespace luxel
