/// Scenes made by hand for the tests of unwrapping and of patches: no file, no texture.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "baker/core/sobol.h"
#include "baker/scene/scene.h"

namespace luxel::test {

struct MadeMesh {
    std::vector<Vec3f> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Vec2f> uv1;
};

/// Appends one object with its own white material. Copies of a mesh (same `content`) must be moved by `place` only.
inline Object& add_object(Scene& scene, const std::string& name, const MadeMesh& mesh, std::uint64_t content,
                          const std::function<Vec3f(const Vec3f&)>& place = {}, bool mirrored = false) {
    Object object;
    object.name = name;
    object.instance = static_cast<std::uint32_t>(scene.objects.size());
    object.material = static_cast<std::uint32_t>(scene.materials.size());
    object.first_triangle = static_cast<std::uint32_t>(scene.triangles.size());
    object.triangle_count = static_cast<std::uint32_t>(mesh.triangles.size());
    object.first_vertex = static_cast<std::uint32_t>(scene.positions.size());
    object.vertex_count = static_cast<std::uint32_t>(mesh.positions.size());
    object.path_hash = mix(std::hash<std::string>{}(name), 1);
    object.content_hash = content;
    object.mirrored = mirrored;
    const auto placed = [&](const Vec3f& p) { return to_double(place ? place(p) : p); };
    // The linear part of `place`, measured over the size of the mesh so that far places keep its digits.
    float size = 0;
    for (const Vec3f& p : mesh.positions) size = std::max({size, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    const Vec3d zero = placed({0, 0, 0});
    const auto row = [&](const Vec3f& axis) { return (placed(axis * size) - zero) / static_cast<double>(size); };
    object.metric = shape_metric(row({1, 0, 0}), row({0, 1, 0}), row({0, 0, 1}));
    const auto root = shape_root(object.metric);
    const auto number = static_cast<std::uint32_t>(scene.objects.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        scene.positions.push_back(place ? place(mesh.positions[i]) : mesh.positions[i]);
        scene.shape_positions.push_back(shape_position(root, mesh.positions[i]));
        scene.uv[0].emplace_back(0.0f, 0.0f);
        scene.uv[1].push_back(mesh.uv1.empty() ? Vec2f(0) : mesh.uv1[i]);
        scene.normals.emplace_back(0.0f, 0.0f, 0.0f);
    }
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        auto corners = mesh.triangles[t];
        if (mirrored) std::swap(corners[1], corners[2]);
        for (auto& c : corners) c += object.first_vertex;
        scene.triangles.push_back(corners);
        scene.source_triangle.push_back(t);
        scene.triangle_object.push_back(number);
    }
    for (std::uint32_t t = object.first_triangle; t < scene.triangles.size(); ++t)
        for (const std::uint32_t v : scene.triangles[t]) scene.normals[v] += scene.geometric_normal(t);
    for (std::uint32_t v = object.first_vertex; v < scene.normals.size(); ++v)
        scene.normals[v] = scene.normals[v].length() > 0 ? scene.normals[v].normalized() : Vec3f(0, 0, 1);
    scene.materials.emplace_back();
    scene.materials.back().name = name;
    scene.object_has_uv1.push_back(!mesh.uv1.empty());
    scene.objects.push_back(object);
    return scene.objects.back();
}

/// A box with its corner at the origin; faces outwards, 8 shared vertices.
inline MadeMesh box(float x, float y, float z) {
    MadeMesh mesh;
    for (int i = 0; i < 8; ++i) mesh.positions.emplace_back(i & 1 ? x : 0.0f, i & 2 ? y : 0.0f, i & 4 ? z : 0.0f);
    const std::array<std::array<std::uint32_t, 4>, 6> faces{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto& f : faces) {
        mesh.triangles.push_back({f[0], f[1], f[2]});
        mesh.triangles.push_back({f[0], f[2], f[3]});
    }
    return mesh;
}

/// A square of side x side quads with hashed heights of up to `roughness` of a quad.
inline MadeMesh terrain(std::uint32_t side, float quad, float roughness) {
    MadeMesh mesh;
    for (std::uint32_t y = 0; y <= side; ++y)
        for (std::uint32_t x = 0; x <= side; ++x) {
            const float noise = static_cast<float>(mix(x, y) >> 40) * 0x1p-24f;
            const float hill = std::sin(static_cast<float>(x) * 0.07f) * std::cos(static_cast<float>(y) * 0.05f);
            mesh.positions.emplace_back(static_cast<float>(x) * quad, quad * (roughness * noise + 4 * hill),
                                        static_cast<float>(y) * quad);
        }
    for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < side; ++x) {
            const std::uint32_t a = y * (side + 1) + x, b = a + 1, c = a + side + 1, d = c + 1;
            mesh.triangles.push_back({a, c, d});
            mesh.triangles.push_back({a, d, b});
        }
    return mesh;
}

/// A sphere of rings x 2 rings quads (triangles at the poles).
inline MadeMesh sphere(std::uint32_t rings, float radius) {
    MadeMesh mesh;
    const std::uint32_t around = 2 * rings;
    for (std::uint32_t r = 0; r <= rings; ++r)
        for (std::uint32_t s = 0; s < around; ++s) {
            const float polar = 3.14159265f * static_cast<float>(r) / static_cast<float>(rings);
            const float turn = 6.28318531f * static_cast<float>(s) / static_cast<float>(around);
            const float ring = r == 0 || r == rings ? 0.0f : radius * std::sin(polar);
            mesh.positions.emplace_back(ring * std::cos(turn), radius * std::cos(polar), ring * std::sin(turn));
        }
    for (std::uint32_t r = 0; r < rings; ++r)
        for (std::uint32_t s = 0; s < around; ++s) {
            const std::uint32_t next = (s + 1) % around;
            const std::uint32_t a = r * around + s, b = r * around + next, c = a + around, d = b + around;
            if (r) mesh.triangles.push_back({a, b, d});
            if (r + 1 < rings) mesh.triangles.push_back({a, d, c});
        }
    return mesh;
}

}  // namespace luxel::test
