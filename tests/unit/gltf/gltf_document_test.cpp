#include "formats/gltf/gltf_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "formats/base/base64.h"
#include "formats/gltf/gltf_in.h"
#include "formats/gltf/gltf_uri.h"
#include "tests/unit/gltf/made_gltf.h"

namespace luxel {
namespace {

using test::bad_input_of;
using test::MadeGltf;
using testing::HasSubstr;

GltfDocument parse_text(const std::string& text) {
    return parse_gltf({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, "made.gltf", ".");
}

Bytes square_glb() {
    MadeGltf made;
    made.primitive(made.square())["mode"] = 6;
    return made.glb();
}

TEST(GltfDocument, TextAndBinaryAreToldApartByTheirBytes) {
    EXPECT_FALSE(parse_text(R"({"asset":{"version":"2.0"}})").binary);
    EXPECT_TRUE(parse_gltf(square_glb(), "square.gltf", ".").binary);
}

TEST(GltfDocument, EveryTruncationIsAnErrorThatNamesTheFile) {
    const Bytes whole = square_glb();
    EXPECT_EQ(read_scene(parse_gltf(whole, "cut.glb", ".")).meshes[0].primitives[0].indices.size(), 6u);
    for (std::size_t length = 0; length < whole.size(); ++length) {
        // A fresh allocation of exactly this size, so that the address sanitizer sees a read past its end.
        const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
        EXPECT_THAT(bad_input_of([&] { read_scene(parse_gltf(cut, "cut.glb", ".")); }), HasSubstr("cut.glb")) << length;
    }
}

TEST(GltfDocument, EveryFlippedByteEndsInAnErrorOrASceneNeverInACrash) {
    const Bytes whole = square_glb();
    for (std::size_t at = 0; at < whole.size(); ++at)
        for (const int flip : {0x01, 0x80, 0xff}) {
            Bytes damaged = whole;
            damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ flip);
            try {
                read_scene(parse_gltf(damaged, "flipped.glb", "/nonexistent"));
            } catch (const Error& error) {
                EXPECT_EQ(error.code, ErrorCode::bad_input);
            }
        }
}

TEST(GltfDocument, ContainerFaultsAreNamed) {
    const auto with_word = [](std::size_t at, std::uint32_t value) {
        Bytes bytes = square_glb();
        std::memcpy(bytes.data() + at, &value, 4);
        return bad_input_of([&] { parse_gltf(bytes, "x.glb", "."); });
    };
    EXPECT_THAT(with_word(4, 1), HasSubstr("GLB version: expected 2, found 1"));
    EXPECT_THAT(with_word(8, 0xffffffff), HasSubstr("GLB length"));
    EXPECT_THAT(with_word(8, 13), HasSubstr("at least 20"));
    EXPECT_THAT(with_word(12, 0xfffffffc), HasSubstr("are left"));
    EXPECT_THAT(with_word(16, 0), HasSubstr("first chunk is not JSON"));
}

TEST(GltfDocument, VersionAndExtensionsAreChecked) {
    EXPECT_THAT(bad_input_of([] { parse_text("{}"); }), HasSubstr("\"asset\" is missing"));
    EXPECT_THAT(bad_input_of([] { parse_text("[]"); }), HasSubstr("expected an object"));
    EXPECT_THAT(bad_input_of([] { parse_text("solid cube"); }), HasSubstr("not valid JSON"));
    EXPECT_THAT(bad_input_of([] { parse_text(R"({"asset":{"version":"1.0"}})"); }), HasSubstr("expected 2.x"));
    EXPECT_THAT(bad_input_of([] { parse_text(R"({"asset":{"version":"2.1","minVersion":"2.1"}})"); }), HasSubstr("minVersion"));
    EXPECT_THAT(bad_input_of([] { parse_text(R"({"asset":{"version":"2.0"},"extensionsRequired":["EXT_odd"]})"); }),
                HasSubstr("EXT_odd"));
    const GltfDocument used = parse_text(R"({"asset":{"version":"2.0"},"extensionsUsed":["EXT_odd","MOZ_lightmap"]})");
    ASSERT_EQ(used.warnings.size(), 1u);
    EXPECT_EQ(used.warnings[0].code, "unknown-extension");
    EXPECT_EQ(bad_input_of([] { parse_text(R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_materials_ior"]})"); }), "");
}

TEST(GltfDocument, DeepNestingIsRefusedBeforeAnyRecursion) {
    const std::string deep = R"({"asset":{"version":"2.0"},"extras":)" + std::string(100000, '[');
    EXPECT_THAT(bad_input_of([&] { parse_text(deep); }), HasSubstr("nested deeper"));
    const std::string in_text = R"({"asset":{"version":"2.0"},"extras":")" + std::string(1000, '[') + R"(\"["})";
    EXPECT_EQ(bad_input_of([&] { parse_text(in_text); }), "");
}

TEST(GltfDocument, DataUrisAreDecoded) {
    const GltfDocument base64 = parse_text(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":5,
        "uri":"data:application/octet-stream;base64,aGVsbG8="}]})");
    EXPECT_EQ(base64.buffers[0], (Bytes{'h', 'e', 'l', 'l', 'o'}));
    const GltfDocument percent = parse_text(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":3,"uri":"data:,a%20b"}]})");
    EXPECT_EQ(percent.buffers[0], (Bytes{'a', ' ', 'b'}));
    EXPECT_THAT(bad_input_of([] { parse_text(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":1,"uri":"data:;base64,a*"}]})"); }),
                HasSubstr("base64"));
    EXPECT_THAT(bad_input_of([] { parse_text(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":9,"uri":"data:,abc"}]})"); }),
                HasSubstr("byteLength says 9 bytes, found 3"));
}

TEST(GltfDocument, Base64OfEveryLength) {
    EXPECT_EQ(decode_base64(""), Bytes{});
    EXPECT_EQ(decode_base64("YQ"), Bytes{'a'});
    EXPECT_EQ(decode_base64("YWI="), (Bytes{'a', 'b'}));
    EXPECT_EQ(decode_base64("YWJj"), (Bytes{'a', 'b', 'c'}));
    EXPECT_EQ(decode_base64("-_8"), (Bytes{0xfb, 0xff}));
    EXPECT_EQ(decode_base64("Y"), std::nullopt);
    EXPECT_EQ(decode_percent("%zz"), std::nullopt);
    EXPECT_EQ(decode_percent("a%4"), std::nullopt);
}

TEST(GltfDocument, ExternalBuffers) {
    const auto folder = std::filesystem::temp_directory_path() / "luxel_gltf_document_test";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "my data.bin", std::ios::binary) << "abcd";
    const auto parse_with = [&](const std::string& uri, bool allow_outside = false) {
        const std::string text = R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":")" + uri + "\"}]}";
        return parse_gltf({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, "made.gltf", folder, allow_outside);
    };
    EXPECT_EQ(parse_with("my%20data.bin").buffers[0], (Bytes{'a', 'b', 'c', 'd'}));
    EXPECT_EQ(parse_with("inner/../my data.bin").buffers[0].size(), 4u);
    for (const char* outside : {"../luxel_gltf_document_test/my data.bin", "inner/../../luxel_gltf_document_test/my data.bin", "%2e%2e/x", ".."})
        EXPECT_THAT(bad_input_of([&] { parse_with(outside); }), testing::AllOf(HasSubstr("leads out of the folder"), HasSubstr("--allow-outside"))) << outside;
    EXPECT_EQ(parse_with("../luxel_gltf_document_test/my data.bin", true).buffers[0].size(), 4u);
    EXPECT_EQ(parse_with((folder / "my data.bin").string(), true).buffers[0].size(), 4u);
    EXPECT_THAT(bad_input_of([&] { parse_with("gone.bin"); }), testing::AllOf(HasSubstr("buffer 0"), HasSubstr("gone.bin")));
    EXPECT_THAT(bad_input_of([&] { parse_with("http://example.org/a.bin"); }), HasSubstr("http: is not followed"));
    EXPECT_THAT(bad_input_of([&] { parse_with("file:///etc/hostname"); }), HasSubstr("file: is not followed"));
    EXPECT_THAT(bad_input_of([&] { parse_with("/etc/hostname"); }), HasSubstr("absolute path"));
    EXPECT_THAT(bad_input_of([&] { parse_with("%2Fetc/hostname"); }), HasSubstr("absolute path"));
    EXPECT_THAT(bad_input_of([&] { parse_with("a%00b"); }), HasSubstr("not a valid relative path"));
    std::filesystem::remove_all(folder);
}

TEST(GltfDocument, BufferWithoutAnyData) {
    EXPECT_THAT(bad_input_of([] { parse_text(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4}]})"); }),
                HasSubstr("neither a uri nor a GLB chunk"));
}

TEST(GltfDocument, MissingFileAndFolder) {
    EXPECT_THAT(bad_input_of([] { load_gltf("/nonexistent/a.glb"); }), HasSubstr("a.glb"));
    EXPECT_NE(bad_input_of([] { load_gltf("/"); }), "");
}

}  // namespace
}  // namespace luxel
