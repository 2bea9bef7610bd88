// The baked model as files: what lies beside it, what is never overwritten, and what a failure leaves behind.
#include "formats/gltf/gltf_out_files.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <functional>

#include "formats/base/file.h"
#include "formats/gltf/gltf_in.h"
#include "formats/gltf/gltf_out.h"
#include "formats/gltf/gltf_primitive.h"
#include "tests/unit/gltf/made_gltf_out.h"

namespace luxel {
namespace {

TEST_F(GltfOut, PicturesOutsideAreTakenAlong) {
    Model model;
    std::filesystem::create_directories(folder / "in" / "tex");
    publish_file(folder / "in" / "tex" / "a b.png", fake_png);
    model.root["images"] = json::array({{{"uri", "tex/a%20b.png"}}, {{"uri", "missing.png"}}});
    model.root["meshes"] = json::array({{{"primitives", json::array({model.quad(-1)})}}});
    model.root["meshes"][0]["primitives"][0].erase("material");
    model.show(0, "n");
    const GltfDocument document = model.parse(folder / "in");
    const GltfDocument out = bake(document, weld);
    EXPECT_FALSE(out.json["images"][0].contains("uri"));
    const ByteView inside = out.view(out.json["images"][0]["bufferView"].get<std::int64_t>(), "image");
    EXPECT_EQ(Bytes(inside.begin(), inside.end()), fake_png);
    EXPECT_EQ(out.json["images"][1]["uri"], "missing.png");
    ASSERT_EQ(written.warnings.size(), 1u);
    EXPECT_EQ(written.warnings[0].code, "picture-left-behind");

    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = lightmaps(record);
    maps.instances[0] = laid_out({welded(record.meshes[0].primitives[0])});
    std::filesystem::create_directories(folder / "text");
    written = write_gltf(folder / "text" / "out.gltf", document, record, maps);
    EXPECT_EQ(written.files.size(), 4u) << "model, lightmap, picture, .bin";
    const GltfDocument text = load_gltf(folder / "text" / "out.gltf");
    for (const std::size_t image : {0u, 2u})
        EXPECT_EQ(read_uri(text, text.json["images"][image]["uri"].get<std::string>(), "image"), fake_png);
    EXPECT_EQ(corners(read_primitive(text, 0, 0), "POSITION"), corners(read_primitive(document, 0, 0), "POSITION"));
}

TEST_F(GltfOut, FilesOfTheInputSurvive) {
    Model model;
    publish_file(folder / "out.bin", Bytes(48, 7));
    model.root["buffers"] = json::array({{{"uri", "out.bin"}, {"byteLength", 48}}});
    model.root["bufferViews"] = json::array({{{"buffer", 0}, {"byteLength", 36}}});
    model.root["accessors"] =
        json::array({{{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}});
    model.root["meshes"] = json::array({{{"primitives", json::array({{{"attributes", {{"POSITION", 0}}}}})}}});
    model.show(0, "n");
    const GltfDocument document = model.parse(folder);
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = lightmaps(record);
    maps.instances[0] = laid_out({welded(record.meshes[0].primitives[0])});
    write_gltf(folder / "out.gltf", document, record, maps);
    EXPECT_EQ(read_file(folder / "out.bin"), Bytes(48, 7));
    EXPECT_EQ(load_gltf(folder / "out.gltf").json["buffers"][0]["uri"], "out.baked.bin");
}

TEST_F(GltfOut, SameBytesTwice) {
    Model model;
    model.root["meshes"] = json::array({{{"primitives", json::array({model.quad(-1)})}}});
    model.root["meshes"][0]["primitives"][0].erase("material");
    model.show(0, "n");
    bake(model.parse(), scatter);
    const Bytes first = read_file(folder / "out.glb");
    bake(model.parse(), scatter);
    EXPECT_EQ(first, read_file(folder / "out.glb"));
}

ErrorCode code_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.code;
    }
    return ErrorCode{};
}

TEST_F(GltfOut, FailuresLeaveNothingBehind) {
    Model model;
    model.root["meshes"] = json::array({{{"primitives", json::array({model.quad(-1)})}}});
    model.root["meshes"][0]["primitives"][0].erase("material");
    model.show(0, "n");
    const GltfDocument document = model.parse();
    const SceneRecord record = read_scene(document);
    GltfLightmaps maps = lightmaps(record);
    maps.instances[0] = laid_out({welded(record.meshes[0].primitives[0])});
    std::filesystem::create_directories(folder / "taken.glb");
    std::filesystem::create_directories(folder / "full.bin");
    const auto write = [&](const char* name) {
        return code_of([&] { write_gltf(folder / name, document, record, maps); });
    };
    EXPECT_EQ(write("taken.glb"), ErrorCode::cannot_write);
    EXPECT_EQ(write("missing/out.glb"), ErrorCode::cannot_write);
    EXPECT_EQ(write("full.gltf"), ErrorCode::cannot_write) << "a folder in the place of the .bin";
    EXPECT_EQ(file_count(), 0u);

    // A disk that fills up: the system refuses bytes beyond a limit.
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    ::getrlimit(RLIMIT_FSIZE, &before);
    rlimit small = before;
    small.rlim_cur = 500;
    ::setrlimit(RLIMIT_FSIZE, &small);
    const ErrorCode binary = write("out.glb"), text = write("out.gltf");
    ::setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_EQ(binary, ErrorCode::cannot_write);
    EXPECT_EQ(text, ErrorCode::cannot_write);
    EXPECT_EQ(file_count(), 0u);

    MeshLayout shorter = *maps.instances[0].mesh;
    shorter[0].triangle_page.pop_back();
    maps.instances[0] = laid_out(std::move(shorter));
    EXPECT_EQ(write("out.glb"), ErrorCode::internal);
    maps.instances[0].mesh.reset();
    EXPECT_NO_THROW(write_gltf(folder / "out.glb", document, record, maps)) << "no layout: the node stays as it is";
    EXPECT_EQ(file_count(), 1u);
}

}  // namespace
}  // namespace luxel
