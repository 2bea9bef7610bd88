#include "baker/scene/texture_sample.h"

#include <algorithm>
#include <cmath>

namespace luxel {

namespace {

constexpr int most_samples = 8;  ///< along each side of a footprint

/// A coordinate inside its period, so that integers of any texture size hold it: [0, 1), [0, 2) for mirror, [0, 1].
double folded(double value, WrapMode mode) {
    switch (mode) {
        case WrapMode::repeat: return value - std::floor(value);
        case WrapMode::mirror: return value - 2.0 * std::floor(0.5 * value);
        case WrapMode::clamp: return std::clamp(value, 0.0, 1.0);
    }
    return 0;
}

std::uint32_t wrapped(std::int64_t index, std::uint32_t size, WrapMode mode) {
    const std::int64_t n = size;
    switch (mode) {
        case WrapMode::repeat: index = (index % n + n) % n; break;
        case WrapMode::mirror:
            index = (index % (2 * n) + 2 * n) % (2 * n);
            if (index >= n) index = 2 * n - 1 - index;
            break;
        case WrapMode::clamp: index = std::clamp<std::int64_t>(index, 0, n - 1); break;
    }
    return static_cast<std::uint32_t>(index);
}

/// The two pixels along one axis that a coordinate lies between.
struct Neighbours {
    std::uint32_t first = 0, second = 0;
    float weight = 0;  ///< of the second
};

Neighbours neighbours(double coordinate, std::uint32_t size, WrapMode mode, bool nearest) {
    const double pixel = folded(coordinate, mode) * size;
    if (nearest) {
        const std::uint32_t only = wrapped(static_cast<std::int64_t>(std::floor(pixel)), size, mode);
        return {only, only, 0.0f};
    }
    const double from_center = pixel - 0.5, base = std::floor(from_center);
    const auto index = static_cast<std::int64_t>(base);
    return {wrapped(index, size, mode), wrapped(index + 1, size, mode), static_cast<float>(from_center - base)};
}

int sample_count(Vec2f side, const Texture& texture) {
    const double x = static_cast<double>(side.x) * texture.width, y = static_cast<double>(side.y) * texture.height;
    const double pixels = std::sqrt(x * x + y * y);
    return pixels > 1 ? static_cast<int>(std::ceil(std::min<double>(pixels, most_samples))) : 1;  // NaN: 1
}

Vec2f transformed(Vec2f uv, const std::array<float, 6>& m) {
    return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
}
Vec2f transformed_side(Vec2f side, const std::array<float, 6>& m) {
    return {m[0] * side.x + m[1] * side.y, m[3] * side.x + m[4] * side.y};
}

Rgba product(const Rgba& a, const Rgba& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]}; }

/// Colour between the vertices of a triangle that is painted. Footprints may reach a little beyond it.
Rgba vertex_color(const Scene& scene, std::uint32_t triangle, float b1, float b2) {
    const Object& object = scene.object_of(triangle);
    const auto& corners = scene.triangles[triangle];
    const auto corner = [&](std::size_t k) -> const Rgba& { return scene.colors[object.first_color + corners[k] - object.first_vertex]; };
    const Rgba &a = corner(0), &b = corner(1), &c = corner(2);
    Rgba color;
    for (std::size_t i = 0; i < 4; ++i) color[i] = std::clamp(a[i] + (b[i] - a[i]) * b1 + (c[i] - a[i]) * b2, 0.0f, 1.0f);
    return color;
}

Rgb times(const Rgb& factor, const Rgba& texture) {
    return {factor.x * texture[0], factor.y * texture[1], factor.z * texture[2]};
}

/// Change of uv for a change of (b1, b2).
Vec2f uv_side(const Scene& scene, std::uint32_t triangle, int uv_set, Vec2f side) {
    const Vec2f corner = surface_uv(scene, triangle, uv_set, 0, 0);
    return (surface_uv(scene, triangle, uv_set, 1, 0) - corner) * side.x +
           (surface_uv(scene, triangle, uv_set, 0, 1) - corner) * side.y;
}

/// Mean over a grid of samples; at(s, t) with s and t in [-1/2, 1/2].
template <class At>
Rgba grid_mean(int s_count, int t_count, const At& at) {
    Rgba sum{};
    for (int t = 0; t < t_count; ++t)
        for (int s = 0; s < s_count; ++s) {
            const Rgba value = at((static_cast<float>(s) + 0.5f) / static_cast<float>(s_count) - 0.5f,
                                  (static_cast<float>(t) + 0.5f) / static_cast<float>(t_count) - 0.5f);
            for (std::size_t i = 0; i < 4; ++i) sum[i] += value[i];
        }
    for (float& channel : sum) channel /= static_cast<float>(s_count * t_count);
    return sum;
}

/// A footprint on a texture.
struct TextureFootprint {
    Vec2f uv, du, dv;

    TextureFootprint(const Scene& scene, int uv_set, const std::array<float, 6>& transform, std::uint32_t triangle, const SurfaceFootprint& on)
        : uv(transformed(surface_uv(scene, triangle, uv_set, on.b1, on.b2), transform)),
          du(transformed_side(uv_side(scene, triangle, uv_set, on.side_s), transform)),
          dv(transformed_side(uv_side(scene, triangle, uv_set, on.side_t), transform)) {}
};

/// Of texture times vertex colours, which vary together: a footprint may hold many pixels and all of a triangle's colours.
Rgba mean_base(const Scene& scene, const Material& material, std::uint32_t triangle, const SurfaceFootprint& footprint) {
    // Linear, so its mean over a part of the triangle is its value in that part's middle.
    if (material.base_texture == none) return vertex_color(scene, triangle, footprint.b1, footprint.b2);
    const Texture& texture = scene.textures[material.base_texture];
    const TextureFootprint on(scene, material.base_uv_set, material.base_transform, triangle, footprint);
    if (!scene.object_of(triangle).is_painted()) return sample_texture_mean(texture, on.uv, on.du, on.dv);
    return grid_mean(sample_count(on.du, texture), sample_count(on.dv, texture), [&](float s, float t) {
        const Vec2f b = Vec2f(footprint.b1, footprint.b2) + footprint.side_s * s + footprint.side_t * t;
        return product(sample_texture(texture, on.uv + on.du * s + on.dv * t), vertex_color(scene, triangle, b.x, b.y));
    });
}

}  // namespace

Rgba sample_texture(const Texture& texture, Vec2f uv) {
    if (texture.pixels.empty() || !std::isfinite(uv.x) || !std::isfinite(uv.y)) return {1, 1, 1, 1};
    const Neighbours x = neighbours(static_cast<double>(uv.x), texture.width, texture.wrap_s, texture.nearest);
    const Neighbours y = neighbours(static_cast<double>(uv.y), texture.height, texture.wrap_t, texture.nearest);
    const auto pixel = [&](std::uint32_t px, std::uint32_t py) -> const Rgba& {
        return texture.pixels[std::size_t{py} * texture.width + px];
    };
    const Rgba &a = pixel(x.first, y.first), &b = pixel(x.second, y.first);
    const Rgba &c = pixel(x.first, y.second), &d = pixel(x.second, y.second);
    Rgba out{};
    for (std::size_t i = 0; i < 4; ++i) {
        const float top = a[i] + (b[i] - a[i]) * x.weight, bottom = c[i] + (d[i] - c[i]) * x.weight;
        out[i] = top + (bottom - top) * y.weight;
    }
    return out;
}

Rgba sample_texture_mean(const Texture& texture, Vec2f uv, Vec2f du, Vec2f dv) {
    return grid_mean(sample_count(du, texture), sample_count(dv, texture),
                     [&](float s, float t) { return sample_texture(texture, uv + du * s + dv * t); });
}

Vec2f surface_uv(const Scene& scene, std::uint32_t triangle, int uv_set, float b1, float b2) {
    if (uv_set < 0 || uv_set > 1) return Vec2f(0, 0);
    const auto& uv = scene.uv[static_cast<std::size_t>(uv_set)];
    const auto& corners = scene.triangles[triangle];
    const Vec2f a = uv[corners[0]];
    return a + (uv[corners[1]] - a) * b1 + (uv[corners[2]] - a) * b2;
}

Rgba surface_texture(const Scene& scene, std::uint32_t texture, int uv_set, const std::array<float, 6>& transform,
                     std::uint32_t triangle, float b1, float b2) {
    if (texture == none) return {1, 1, 1, 1};
    return sample_texture(scene.textures[texture], transformed(surface_uv(scene, triangle, uv_set, b1, b2), transform));
}

Rgba surface_base(const Scene& scene, std::uint32_t triangle, float b1, float b2) {
    const Material& material = scene.material_of(triangle);
    const Rgba texture = surface_texture(scene, material.base_texture, material.base_uv_set, material.base_transform, triangle, b1, b2);
    return scene.object_of(triangle).is_painted() ? product(texture, vertex_color(scene, triangle, b1, b2)) : texture;
}

bool has_varied_base(const Scene& scene, std::uint32_t triangle) {
    return scene.material_of(triangle).base_texture != none || scene.object_of(triangle).is_painted();
}

Rgb surface_reflectance(const Scene& scene, std::uint32_t triangle, float b1, float b2) {
    const Material& material = scene.material_of(triangle);
    if (!scene.object_of(triangle).receives) return Rgb(0, 0, 0);
    if (!has_varied_base(scene, triangle)) return material.reflectance;
    return times(material.reflectance, surface_base(scene, triangle, b1, b2));
}

Rgb surface_emission(const Scene& scene, std::uint32_t triangle, float b1, float b2) {
    const Material& material = scene.material_of(triangle);
    if (material.emissive_texture == none) return material.emission;
    return times(material.emission, surface_texture(scene, material.emissive_texture, material.emissive_uv_set,
                                                    material.emissive_transform, triangle, b1, b2));
}

float surface_alpha(const Scene& scene, std::uint32_t triangle, float b1, float b2) {
    const Material& material = scene.material_of(triangle);
    if (material.alpha_mode == AlphaMode::opaque) return 1;
    const float alpha = has_varied_base(scene, triangle) ? material.alpha * surface_base(scene, triangle, b1, b2)[3] : material.alpha;
    if (material.alpha_mode == AlphaMode::mask) return alpha >= material.alpha_cutoff ? 1.0f : 0.0f;
    return alpha;
}

Rgb mean_reflectance(const Scene& scene, std::uint32_t triangle, const SurfaceFootprint& footprint) {
    const Material& material = scene.material_of(triangle);
    if (!scene.object_of(triangle).receives) return Rgb(0, 0, 0);
    if (!has_varied_base(scene, triangle)) return material.reflectance;
    return times(material.reflectance, mean_base(scene, material, triangle, footprint));
}

Rgb mean_emission(const Scene& scene, std::uint32_t triangle, const SurfaceFootprint& footprint) {
    const Material& material = scene.material_of(triangle);
    if (material.emissive_texture == none) return material.emission;
    const TextureFootprint on(scene, material.emissive_uv_set, material.emissive_transform, triangle, footprint);
    return times(material.emission, sample_texture_mean(scene.textures[material.emissive_texture], on.uv, on.du, on.dv));
}

}  // namespace luxel
