/// Surfaces that let light through, for tests: materials and pictures on the records that SceneMaker collects.
#pragma once
#include <functional>
#include <string>

#include "tests/support/scenes.h"

namespace luxel::test {

/// The material of the object that was added last.
inline MaterialRecord& last_material(SceneMaker& maker) { return maker.record().materials.back(); }

inline SceneMaker& blend(SceneMaker& maker, double alpha, std::array<double, 3> colour = {0, 0, 0}) {
    MaterialRecord& material = last_material(maker);
    material.alpha_mode = AlphaMode::blend;
    material.base_color = {colour[0], colour[1], colour[2], alpha};
    return maker;
}

inline SceneMaker& glass(SceneMaker& maker, std::array<double, 3> tint, double transmission = 1) {
    MaterialRecord& material = last_material(maker);
    material.base_color = {tint[0], tint[1], tint[2], 1};
    material.transmission = transmission;
    return maker;
}

/// A picture of bytes, and a nearest-filtered texture of it. rgba(x, y) gives the pixels. Returns its use.
inline TextureUse add_picture(SceneMaker& maker, int width, int height,
                              const std::function<std::array<std::uint8_t, 4>(int, int)>& rgba) {
    SceneRecord& record = maker.record();
    ImageRecord image;
    image.name = "picture " + std::to_string(record.images.size());
    image.bytes = {static_cast<std::uint8_t>(width), static_cast<std::uint8_t>(height)};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto pixel = rgba(x, y);
            image.bytes.insert(image.bytes.end(), pixel.begin(), pixel.end());
        }
    record.images.push_back(image);
    TextureRecord texture;
    texture.image = static_cast<int>(record.images.size()) - 1;
    texture.nearest = true;
    record.textures.push_back(texture);
    TextureUse use;
    use.texture = static_cast<int>(record.textures.size()) - 1;
    return use;
}

/// Masks the object that was added last by a checker of 2 x 2 pixels: solid where (column + row) is even, counted from its
/// corner 0 in squares of `square_m` along its first and last side (it must be one quad).
inline SceneMaker& checker_mask(SceneMaker& maker, float square_m) {
    const TextureUse use = add_picture(maker, 2, 2, [](int x, int y) {
        return std::array<std::uint8_t, 4>{255, 255, 255, static_cast<std::uint8_t>((x + y) % 2 ? 100 : 200)};
    });
    MaterialRecord& material = last_material(maker);
    material.alpha_mode = AlphaMode::mask;
    material.base_color_texture = use;
    material.alpha_cutoff = 0.5;
    PrimitiveRecord& primitive = maker.record().meshes.back().primitives[0];
    const auto& p = primitive.positions;
    const float period = 2 * square_m, u = (p[1] - p[0]).length() / period, v = (p[3] - p[0]).length() / period;
    primitive.uv[0] = {{0, 0}, {u, 0}, {u, v}, {0, v}};
    return maker;
}

inline Scene build_with_pictures(SceneMaker& maker, const BuildOptions& options = {}) {
    std::vector<Warning> warnings;
    const auto decode = [](ByteView bytes, const std::string&) {
        DecodedImage image{bytes[0], bytes[1], {}};
        for (std::size_t k = 2; k < bytes.size(); k += 4) {
            auto& pixel = image.rgba.emplace_back();
            for (std::size_t c = 0; c < 4; ++c) pixel[c] = static_cast<float>(bytes[k + c]) / 255;
        }
        return std::optional<DecodedImage>(image);
    };
    return build_scene(maker.record(), decode, options, warnings);
}

}  // namespace luxel::test
