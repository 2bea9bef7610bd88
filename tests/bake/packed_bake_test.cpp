// Whole bakes with --draco and --meshopt: the light that a viewer finds on the surface is that of the plain model, the
// program reads what it wrote, and nothing but the model depends on the packing.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "formats/base/file.h"
#include "formats/gltf/gltf_in.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

/// A triangle as it lies in the world, with its place on a lightmap page (0..1).
struct MappedTriangle {
    std::array<Imath::V3d, 3> corners;
    std::array<Imath::V2f, 3> uv;
    std::uint64_t page = 0;
    [[nodiscard]] Imath::V3d normal() const { return (corners[1] - corners[0]).cross(corners[2] - corners[0]); }
};

std::vector<MappedTriangle> mapped_triangles(const std::filesystem::path& model) {
    const GltfDocument document = load_gltf(model);
    const SceneRecord record = read_scene(document);
    std::vector<MappedTriangle> triangles;
    for (const InstanceRecord& instance : record.instances)
        for (const PrimitiveRecord& primitive : record.meshes[static_cast<std::size_t>(instance.mesh)].primitives) {
            if (primitive.material < 0) continue;
            const nlohmann::json& material = document.json["materials"][static_cast<std::size_t>(primitive.material)];
            if (!material.contains("extensions") || !material["extensions"].contains("MOZ_lightmap")) continue;
            const std::size_t texture = material["extensions"]["MOZ_lightmap"]["index"];
            for (std::size_t first = 0; first < primitive.indices.size(); first += 3) {
                MappedTriangle& triangle = triangles.emplace_back();
                for (std::size_t c = 0; c < 3; ++c) {
                    const std::uint32_t vertex = primitive.indices[first + c];
                    triangle.corners[c] = Imath::V3d(primitive.positions[vertex]) * instance.world;
                    triangle.uv[c] = primitive.uv[1][vertex];
                }
                triangle.page = document.json["textures"][texture]["source"];
            }
        }
    return triangles;
}

/// Barycentric weights of the point of the plane that is nearest.
Imath::V3d weights_of(const MappedTriangle& triangle, const Imath::V3d& point) {
    const Imath::V3d normal = triangle.normal();
    Imath::V3d weights;
    for (int c = 0; c < 3; ++c) {
        const auto next = static_cast<std::size_t>((c + 1) % 3), last = static_cast<std::size_t>((c + 2) % 3);
        weights[c] = (triangle.corners[last] - triangle.corners[next]).cross(point - triangle.corners[next]).dot(normal) / normal.length2();
    }
    return weights;
}

/// The triangle that the point lies on or nearest above, looking from its front.
const MappedTriangle* triangle_below(const std::vector<MappedTriangle>& triangles, const Imath::V3d& point, const Imath::V3d& normal) {
    const MappedTriangle* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const MappedTriangle& triangle : triangles) {
        const Imath::V3d own = triangle.normal();
        if (own.length2() == 0 || own.dot(normal) < 0.99 * own.length() * normal.length()) continue;
        const Imath::V3d weights = weights_of(triangle, point);
        if (std::min({weights.x, weights.y, weights.z}) < 0) continue;
        const double distance = std::abs((point - triangle.corners[0]).dot(own) / own.length());
        if (distance < least) least = distance, nearest = &triangle;
    }
    return least < 1e-2 ? nearest : nullptr;
}

struct Sample {
    std::array<double, 3> light{};
    bool is_on_empty_texel = false;  ///< one of its four texels has no value, and yet a share
};

/// What a viewer's bilinear filter finds.
Sample sample_at(const MappedTriangle& triangle, const Imath::V3d& weights, const PagePixels& page) {
    double u = 0, v = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        u += weights[static_cast<int>(c)] * static_cast<double>(triangle.uv[c].x) * page.width;
        v += weights[static_cast<int>(c)] * static_cast<double>(triangle.uv[c].y) * page.height;
    }
    Sample sample;
    const double left = std::floor(u - 0.5), top = std::floor(v - 0.5), fx = u - 0.5 - left, fy = v - 0.5 - top;
    for (int k = 0; k < 4; ++k) {
        const double share = (k % 2 ? fx : 1 - fx) * (k / 2 ? fy : 1 - fy);
        const auto x = static_cast<std::size_t>(std::clamp(left + k % 2, 0.0, page.width - 1.0));
        const auto y = static_cast<std::size_t>(std::clamp(top + k / 2, 0.0, page.height - 1.0));
        const auto& texel = page.pixels[y * page.width + x];
        if (share > 0 && texel[0] + texel[1] + texel[2] == 0) sample.is_on_empty_texel = true;
        for (std::size_t c = 0; c < 3; ++c) sample.light[c] += share * static_cast<double>(texel[c]);
    }
    return sample;
}

/// Points spread over the surface by area, none within a millimetre of an edge, where rounding decides the triangle.
struct SurfacePoint {
    std::size_t triangle;
    Imath::V3d point;
};
std::vector<SurfacePoint> surface_points(const std::vector<MappedTriangle>& triangles, std::size_t count) {
    std::vector<double> areas;
    for (const MappedTriangle& triangle : triangles) areas.push_back(triangle.normal().length() / 2);
    std::mt19937_64 random(7);
    std::discrete_distribution<std::size_t> pick(areas.begin(), areas.end());
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<SurfacePoint> points;
    while (points.size() < count) {
        const std::size_t t = pick(random);
        double a = unit(random), b = unit(random);
        if (a + b > 1) a = 1 - a, b = 1 - b;
        const auto& corners = triangles[t].corners;
        const Imath::V3d weights(1 - a - b, a, b);
        bool is_inside = true;
        for (std::size_t c = 0; c < 3; ++c) {
            const double height = 2 * areas[t] / (corners[(c + 1) % 3] - corners[(c + 2) % 3]).length();
            is_inside = is_inside && weights[static_cast<int>(c)] * height > 1e-3;
        }
        if (is_inside) points.push_back({t, corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z});
    }
    return points;
}

/// Largest difference of light between two models of one bake, as a part of the largest value of the page.
double largest_difference(const std::filesystem::path& plain, const std::filesystem::path& packed, const std::vector<PagePixels>& pages) {
    const auto before = mapped_triangles(plain), after = mapped_triangles(packed);
    EXPECT_FALSE(before.empty());
    double most = 0;
    for (const PagePixels& page : pages)
        for (const auto& texel : page.pixels) most = std::max({most, double{texel[0]}, double{texel[1]}, double{texel[2]}});
    double worst = 0;
    for (const SurfacePoint& at : surface_points(before, 4000)) {
        const MappedTriangle& triangle = before[at.triangle];
        const MappedTriangle* other = triangle_below(after, at.point, triangle.normal());
        if (!other) {
            ADD_FAILURE() << "no surface at " << at.point;
            continue;
        }
        EXPECT_EQ(pages.size(), 1u) << "these scenes fill one page";
        const Sample a = sample_at(triangle, weights_of(triangle, at.point), pages[0]);
        const Sample b = sample_at(*other, weights_of(*other, at.point), pages[0]);
        EXPECT_FALSE(a.is_on_empty_texel) << at.point;
        EXPECT_FALSE(b.is_on_empty_texel) << at.point;
        for (std::size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(a.light[c] - b.light[c]) / most);
    }
    return worst;
}

class PackedBake : public testing::Test {
  protected:
    /// The sphere with a lamp off its middle: many charts, and light that is not the same everywhere. One page.
    BakeOptions sphere_options() {
        const auto scene = edited_sample("sphere", folder / "scene", [](nlohmann::json& gltf) {
            gltf["extensionsUsed"].push_back("KHR_lights_punctual");
            gltf["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 1.0}}};
            gltf["scenes"][0]["nodes"].push_back(gltf["nodes"].size());
            gltf["nodes"].push_back({{"translation", {0.4, 0.2, 0.3}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
        });
        BakeOptions options = small_options(scene, {});
        options.unwrap.texels_per_metre = 0;
        options.unwrap.page_size = 128;
        return options;
    }
    /// The same bake stored in three ways; the bake folder is shared, so that it is computed once.
    void bake_all(BakeOptions options) {
        options.work = folder / "work";
        for (const char* name : {"plain", "draco", "meshopt"}) {
            options.output = model(name);
            options.draco.reset();
            if (name == std::string("draco")) options.draco = DracoBits();
            options.meshopt = name == std::string("meshopt");
            reports.push_back(bake(options));
        }
    }
    [[nodiscard]] std::filesystem::path model(const char* name) const { return folder / name / "scene.glb"; }
    [[nodiscard]] std::string exr(const char* name) const {
        return files_below(folder / name).at("scene.lightmap0.exr");
    }
    TemporaryFolder folder;
    std::vector<BakeReport> reports;
};

TEST_F(PackedBake, TheLightOnTheSurfaceStays) {
    bake_all(sphere_options());
    EXPECT_EQ(exr("plain"), exr("draco"));
    EXPECT_EQ(exr("plain"), exr("meshopt"));
    const auto pages = lightmap_pages(reports[0]);
    const double difference = largest_difference(model("plain"), model("draco"), pages);
    RecordProperty("largest_difference", std::to_string(difference));
    EXPECT_LT(difference, 0.01);
    EXPECT_GT(difference, 0) << "nothing was quantised: the comparison sees nothing";
    EXPECT_LT(largest_difference(model("plain"), model("meshopt"), pages), 1e-12);
}

TEST_F(PackedBake, CoarseCoordinatesAreFoundOut) {
    BakeOptions options = sphere_options();
    bake_all(options);
    options.work = folder / "work";
    options.output = model("coarse");
    options.draco = DracoBits{.texcoord = 6, .lightmap = 6};  // TEXCOORD_0 is the same array: nothing has a texture
    bake(options);
    EXPECT_GT(largest_difference(model("plain"), model("coarse"), lightmap_pages(reports[0])), 0.01)
        << "half a texel off, and the comparison does not see it";
}

TEST_F(PackedBake, OurOwnResultIsAnInput) {
    BakeOptions options = small_options(sample("sphere"), {});
    bake_all(options);
    const BakeReport again_of_plain = [&] {
        options.input = model("plain");
        options.output = folder / "again" / "plain.glb";
        return bake(options);
    }();
    for (const char* name : {"draco", "meshopt"}) {
        options.input = model(name);
        options.output = folder / "again" / (std::string(name) + ".glb");
        options.draco = DracoBits();
        options.meshopt = true;
        const BakeReport again = bake(options);
        EXPECT_EQ(again.triangles, again_of_plain.triangles) << name;
        EXPECT_NEAR(again.emitted_lm[0], again_of_plain.emitted_lm[0], again_of_plain.emitted_lm[0] * 1e-3) << name;
    }
}

}  // namespace
}  // namespace luxel::test
