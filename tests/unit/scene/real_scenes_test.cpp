/// Scenes made by others, from the folder beside the project (LUXEL_SCENES); skipped where it is missing.
/// LUXEL_LARGE_SCENES=1 adds those of millions of triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <ostream>

#include "baker/scene/scene_build.h"
#include "formats/gltf/gltf_in.h"
#include "tests/unit/gltf/made_gltf.h"

namespace luxel {
namespace {

using test::scenes_folder;

/// Geometry and materials are the matter here, not pictures.
std::optional<DecodedImage> grey_pixel(ByteView, const std::string&) {
    return DecodedImage{1, 1, {{0.5f, 0.5f, 0.5f, 1.0f}}};
}

struct Read {
    SceneRecord record;
    Scene scene;
    std::vector<Warning> warnings;
    explicit Read(const std::filesystem::path& path) {
        record = read_scene(load_gltf(path));
        warnings = record.warnings;
        scene = build_scene(record, grey_pixel, {}, warnings);
    }
    /// Of the record, every instance counted, before anything is dropped.
    [[nodiscard]] std::uint64_t source_triangles() const {
        std::uint64_t count = 0;
        for (const InstanceRecord& instance : record.instances)
            for (const auto& primitive : record.meshes[static_cast<std::size_t>(instance.mesh)].primitives)
                count += primitive.indices.size() / 3;
        return count;
    }
};

void expect_sound(const Scene& scene, const std::string& name) {
    std::uint64_t bad_positions = 0, bad_normals = 0, bad_areas = 0, bad_uv = 0;
    for (const Vec3f& p : scene.positions) bad_positions += !std::isfinite(p.length2());
    for (const Vec3f& n : scene.normals) bad_normals += !(std::abs(n.length() - 1.0f) < 1e-5f);
    for (const auto& set : scene.uv)
        for (const Vec2f& uv : set) bad_uv += !std::isfinite(uv.x) || !std::isfinite(uv.y);
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) bad_areas += !(scene.area_m2(t) > 0);
    EXPECT_EQ(bad_positions + bad_normals + bad_areas + bad_uv, 0u) << name;
    EXPECT_EQ(scene.materials.size() > 0, true);
    for (const Material& material : scene.materials)
        for (int c = 0; c < 3; ++c) {
            EXPECT_TRUE(material.reflectance[c] >= 0 && material.reflectance[c] <= 1) << name;
            EXPECT_TRUE(material.emission[c] >= 0 && std::isfinite(material.emission[c])) << name;
        }
}

struct Expected {
    const char* file;
    std::uint64_t triangles;
    std::size_t meshes, lamps;
    double kept = 0.99;  ///< share of triangles that have an area, at least
};

void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.file; }

class RealScene : public testing::TestWithParam<Expected> {};

TEST_P(RealScene, IsReadAndBuilt) {
    const auto path = scenes_folder() / GetParam().file;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    if (GetParam().triangles > 1000000 && !std::getenv("LUXEL_LARGE_SCENES")) GTEST_SKIP() << "set LUXEL_LARGE_SCENES=1";
    const Read read(path);
    EXPECT_EQ(read.source_triangles(), GetParam().triangles);
    EXPECT_EQ(read.record.meshes.size(), GetParam().meshes);
    EXPECT_EQ(read.record.lamps.size(), GetParam().lamps);
    EXPECT_LE(read.scene.triangle_count(), GetParam().triangles);
    EXPECT_GE(static_cast<double>(read.scene.triangle_count()), GetParam().kept * static_cast<double>(GetParam().triangles));
    expect_sound(read.scene, GetParam().file);
}

INSTANTIATE_TEST_SUITE_P(
    All, RealScene,
    testing::Values(Expected{"chess-board/chess-board.glb", 178848, 8, 0}, Expected{"city/city-small.glb", 177906, 27, 76},
                    Expected{"city/city.glb", 7356396, 27, 1241}, Expected{"cornell-box/cornell-box.glb", 36, 8, 0},
                    Expected{"dutch-ship/dutch_ship_medium_1k.gltf", 69162, 3, 0},
                    Expected{"hotel-room/hotel-room.glb", 99029, 1, 3}, Expected{"house/house.glb", 10497, 2, 0},
                    Expected{"living-room/living-room.glb", 143163, 65, 0},
                    Expected{"lq-e1m1/lq_e1m1-packed.glb", 32523, 111, 259}, Expected{"lq-e1m1/lq_e1m1.glb", 32523, 111, 259},
                    Expected{"neon-sign/neon-sign.glb", 46552, 22, 0},
                    Expected{"staircase/staircase-draco.glb", 262578, 775, 0},
                    Expected{"staircase/staircase.glb", 262663, 775, 0}, Expected{"torture-1/torture-1.glb", 391, 19, 3, 0.7},
                    Expected{"zdm2/zdm2.glb", 70754, 84, 1}));

/// Compressed and plain forms of one scene are the same surface.
TEST(RealScenes, CompressionKeepsTheSurface) {
    const auto area = [](const Scene& scene) {
        double sum = 0;
        for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) sum += scene.area_m2(t);
        return sum;
    };
    for (const auto& [plain, packed] : {std::pair{"lq-e1m1/lq_e1m1.glb", "lq-e1m1/lq_e1m1-packed.glb"},
                                        {"staircase/staircase.glb", "staircase/staircase-draco.glb"}}) {
        if (!std::filesystem::exists(scenes_folder() / plain)) GTEST_SKIP() << "no scenes";
        const double a = area(Read(scenes_folder() / plain).scene), b = area(Read(scenes_folder() / packed).scene);
        EXPECT_NEAR(b / a, 1, 2e-3) << packed;
    }
}

TEST(RealScenes, AssetGenerator) {
    const auto folder = scenes_folder() / "asset-generator";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
    std::size_t read_count = 0, refused_count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.path().extension() != ".gltf") continue;
        const std::string name = entry.path().stem().string();
        const bool refuse = name == "Compatibility_04" || name == "Compatibility_05";
        const std::string message = test::bad_input_of([&] {
            const Read read(entry.path());
            expect_sound(read.scene, name);
            const bool has_area = name < "Mesh_PrimitiveMode_00" || name > "Mesh_PrimitiveMode_15" || !read.scene.objects.empty();
            EXPECT_TRUE(has_area || !read.warnings.empty()) << name;
        });
        EXPECT_EQ(message.empty(), !refuse) << name << ": " << message;
        (refuse ? refused_count : read_count)++;
    }
    EXPECT_EQ(read_count, 45u);
    EXPECT_EQ(refused_count, 2u);
}

/// Mirrored scales in a hierarchy: the front stays where the shading normals are.
TEST(RealScenes, NegativeScalesKeepFronts) {
    const auto folder = scenes_folder() / "asset-generator" / "Node_NegativeScale";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() != ".gltf") continue;
        const Scene scene = Read(entry.path()).scene;
        for (std::uint32_t t = 0; t < scene.triangle_count(); ++t)
            EXPECT_GT(scene.geometric_normal(t).dot(scene.normals[scene.triangles[t][0]]), 0.0f) << entry.path();
    }
}

}  // namespace
}  // namespace luxel
