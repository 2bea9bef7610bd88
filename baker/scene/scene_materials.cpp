#include "baker/scene/scene_materials.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "baker/core/parallel.h"
#include "baker/core/units.h"

namespace luxel {

namespace {

/// Source: IEC 61966-2-1.
double srgb_to_linear(double value) {
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

/// Values that 8 bits can hold come from a table: nearly all images, and much faster than pow.
float linear_of(float stored) {
    static const auto table = [] {
        std::array<float, 256> values{};
        for (std::size_t i = 0; i < 256; ++i) values[i] = static_cast<float>(srgb_to_linear(static_cast<double>(i) / 255.0));
        return values;
    }();
    if (!(stored > 0)) return 0;
    if (stored >= 1) return 1;
    const float level = stored * 255.0f;
    const float nearest = std::nearbyint(level);
    if (std::abs(level - nearest) < 1e-4f) return table[static_cast<std::size_t>(nearest)];
    return static_cast<float>(srgb_to_linear(static_cast<double>(stored)));
}

std::vector<std::array<float, 4>> linear_pixels(std::vector<std::array<float, 4>> pixels) {
    parallel_for(pixels.size(), 65536, [&](std::size_t i) {
        for (std::size_t c = 0; c < 3; ++c) pixels[i][c] = linear_of(pixels[i][c]);
        pixels[i][3] = pixels[i][3] > 0 ? std::min(pixels[i][3], 1.0f) : 0.0f;
    });
    return pixels;
}

std::vector<std::array<float, 4>> limited_pixels(std::vector<std::array<float, 4>> pixels) {
    for (auto& pixel : pixels)
        for (float& number : pixel) number = number > 0 ? std::min(number, 1.0f) : 0.0f;
    return pixels;
}

/// Decodes each image once and keeps each combination of image and sampler once.
class TextureSet {
  public:
    TextureSet(const SceneRecord& record, const ImageDecoder& decode, Scene& scene, std::vector<Warning>& warnings)
        : record_(record), decode_(decode), scene_(scene), warnings_(warnings) {}

    /// Index into scene.textures, or none. `is_colour`: sRGB; else the pixels are linear numbers.
    std::uint32_t add(const TextureUse& use, const std::string& where, bool is_colour = true) {
        if (use.texture < 0) return none;
        if (use.uv_set > 1) {
            warnings_.push_back({"uv-set", where, "a texture uses TEXCOORD_" + std::to_string(use.uv_set) +
                                                      "; only 0 and 1 are read, so it counts as white"});
            return none;
        }
        const TextureRecord& texture = record_.textures[static_cast<std::size_t>(use.texture)];
        if (texture.image < 0) return none;
        const auto key = std::tuple(texture.image, texture.other, texture.wrap_s, texture.wrap_t, texture.nearest, is_colour);
        if (const auto known = textures_.find(key); known != textures_.end()) return known->second;
        const std::uint32_t index = make(texture, is_colour);
        textures_.emplace(key, index);
        return index;
    }

  private:
    std::uint32_t make(const TextureRecord& record, bool is_colour) {
        const bool has_other = record.other >= 0;
        const std::uint32_t made = make(record, record.image, is_colour, has_other ? "the picture beside it is taken" : "the texture counts as white");
        return made == none && has_other ? make(record, record.other, is_colour, "the texture counts as white") : made;
    }

    std::uint32_t make(const TextureRecord& record, int image_index, bool is_colour, const char* instead) {
        Texture made;
        const std::pair image(image_index, is_colour);
        if (const auto twin = first_of_image_.find(image); twin != first_of_image_.end()) {
            if (twin->second == none) return none;
            made = scene_.textures[twin->second];
        } else if (!load(image_index, is_colour, instead, made)) {
            first_of_image_.emplace(image, none);
            return none;
        }
        made.wrap_s = record.wrap_s;
        made.wrap_t = record.wrap_t;
        made.nearest = record.nearest;
        const auto index = static_cast<std::uint32_t>(scene_.textures.size());
        scene_.textures.push_back(std::move(made));
        first_of_image_.emplace(image, index);
        return index;
    }

    bool load(int image_index, bool is_colour, const char* instead, Texture& into) {
        const ImageRecord& image = record_.images[static_cast<std::size_t>(image_index)];
        if (image.bytes.empty()) return false;  // the reader has said why
        std::optional<DecodedImage> decoded = decode_ ? decode_(image.bytes, image.name) : std::nullopt;
        const bool fits = decoded && decoded->width > 0 && decoded->height > 0 &&
                          decoded->rgba.size() == std::size_t{decoded->width} * decoded->height;
        if (!fits) {
            warnings_.push_back({"image-undecoded", image.name, std::string("the image cannot be decoded; ") + instead});
            return false;
        }
        into.width = decoded->width;
        into.height = decoded->height;
        into.pixels = is_colour ? linear_pixels(std::move(decoded->rgba)) : limited_pixels(std::move(decoded->rgba));
        return true;
    }

    const SceneRecord& record_;
    const ImageDecoder& decode_;
    Scene& scene_;
    std::vector<Warning>& warnings_;
    std::map<std::tuple<int, int, WrapMode, WrapMode, bool, bool>, std::uint32_t> textures_;
    std::map<std::pair<int, bool>, std::uint32_t> first_of_image_;
};

std::array<float, 6> finite_transform(const std::array<double, 6>& transform, const char* texture, const ValueCheck& check) {
    std::array<float, 6> out{};
    for (std::size_t i = 0; i < 6; ++i) {
        out[i] = static_cast<float>(transform[i]);
        if (!std::isfinite(out[i])) {
            check.fault("material-clamped", std::string("the transform of ") + texture + " is not finite", "none");
            return {1, 0, 0, 0, 1, 0};
        }
    }
    return out;
}

double limited(double value, const ValueCheck& check, const char* property) {
    check.limit({&value, 1}, 1.0, "material-clamped", property);
    return value;
}

Material convert_material(const MaterialRecord& record, const ValueCheck& check) {
    Material material;
    material.name = record.name;
    std::array<double, 3> colour{record.base_color[0], record.base_color[1], record.base_color[2]};
    check.limit(colour, 1.0, "reflectance-clamped", "baseColorFactor");
    std::array<double, 3> nits = record.emission;
    check.limit(nits, most_light, "emission-clamped", "emissiveFactor times emissiveStrength");
    // What mirrors is not diffuse: base colour * (1 - metallic) as glTF's appendix B.3.5 has it. Of what passes through, the rest
    // is the surface that light meets (see_through.h), unless it emits: then that all of it sends light must stay true.
    const double transmission = limited(record.transmission, check, "transmissionFactor");
    const bool emits = std::ranges::any_of(nits, [](double n) { return n > 0; });
    const double kept = (emits ? 1.0 - transmission : 1.0) * (1.0 - limited(record.metallic, check, "metallicFactor"));
    material.transmission = emits ? 0.0f : static_cast<float>(transmission);
    for (int c = 0; c < 3; ++c) {
        material.pane_colour[c] = static_cast<float>(colour[static_cast<std::size_t>(c)]);
        material.reflectance[c] = material.pane_colour[c] * static_cast<float>(kept);
        material.emission[c] = static_cast<float>(pi * nits[static_cast<std::size_t>(c)]);
    }
    material.alpha = static_cast<float>(limited(record.base_color[3], check, "the alpha of baseColorFactor"));
    material.base_uv_set = record.base_color_texture.uv_set;
    material.base_transform = finite_transform(record.base_color_texture.transform, "baseColorTexture", check);
    material.emissive_uv_set = record.emissive_texture.uv_set;
    material.emissive_transform = finite_transform(record.emissive_texture.transform, "emissiveTexture", check);
    material.transmission_uv_set = record.transmission_texture.uv_set;
    material.transmission_transform =
        finite_transform(record.transmission_texture.transform, "transmissionTexture", check);
    material.alpha_mode = record.alpha_mode;
    material.alpha_cutoff = std::isfinite(record.alpha_cutoff) ? static_cast<float>(record.alpha_cutoff) : 0.5f;
    return material;
}

void note_kinds(const MaterialRecord& record, const std::string& where, std::vector<Warning>& warnings) {
    if (record.has_metallic_texture)
        warnings.push_back({"metal-as-diffuse", where, "its metallic texture is not read: all of the surface counts as not metallic"});
    else if (record.metallic > 0)
        warnings.push_back({"metal-mirrors", where, "the metallic share reflects like a mirror: it takes no part in diffuse light"});
    const bool emits = std::ranges::any_of(record.emission, [](double nits) { return nits > 0; });
    if (record.transmission > 0 && emits)
        warnings.push_back({"transmission-blocked", where,
                            "it emits: transmission takes light from its diffuse part, but lets none through"});
}

/// Exporters mark as MASK or BLEND much that covers everywhere: such surfaces are opaque, and cost rays nothing.
void settle_alpha(const Scene& scene, float least_of_vertices, Material& material) {
    if (material.alpha_mode == AlphaMode::opaque) return;
    const float alpha = material.alpha * least_of_vertices;
    float least = alpha;
    if (material.base_texture != none)
        for (const auto& pixel : scene.textures[material.base_texture].pixels) least = std::min(least, alpha * pixel[3]);
    if (least >= (material.alpha_mode == AlphaMode::mask ? material.alpha_cutoff : 1.0f)) material.alpha_mode = AlphaMode::opaque;
}

/// The one colour of a texture, if it has only one. Samples of it are that colour, up to rounding of means.
std::optional<Rgba> only_colour(const Texture& texture) {
    if (texture.pixels.empty() || std::ranges::any_of(texture.pixels, [&](const Rgba& pixel) { return pixel != texture.pixels[0]; })) return {};
    return texture.pixels[0];
}

/// Puts textures of one colour into the factors that they multiply.
void fold_even_textures(Scene& scene, Material& material) {
    const auto fold = [&](std::uint32_t& use, const auto& multiply) {
        if (use == none) return;
        const auto colour = only_colour(scene.textures[use]);
        if (!colour) return;
        multiply(Rgb((*colour)[0], (*colour)[1], (*colour)[2]), (*colour)[3]);
        use = none;
        ++scene.even_textures;
    };
    fold(material.base_texture, [&](const Rgb& colour, float alpha) {
        material.reflectance = material.reflectance * colour;
        material.pane_colour = material.pane_colour * colour;
        material.alpha *= alpha;
    });
    fold(material.emissive_texture, [&](const Rgb& colour, float) { material.emission = material.emission * colour; });
    fold(material.transmission_texture, [&](const Rgb& colour, float) { material.transmission *= colour.x; });
}

/// Pixels that no material looks up any more.
void forget_folded_pixels(Scene& scene) {
    std::vector<bool> is_used(scene.textures.size());
    for (const Material& material : scene.materials)
        for (const std::uint32_t use : {material.base_texture, material.emissive_texture, material.transmission_texture})
            if (use != none) is_used[use] = true;
    for (std::size_t t = 0; t < is_used.size(); ++t)
        if (!is_used[t]) scene.textures[t].pixels = {};
}

Vec3d direction_of(const Matrix44d& world) { return {-world[2][0], -world[2][1], -world[2][2]}; }

bool usable(const Vec3d& v) {
    const double length = v.length();
    return length > 0 && std::isfinite(length);
}

void set_cone(const LampRecord& record, Lamp& lamp, const std::string& where, std::vector<Warning>& warnings) {
    const bool fits = record.inner_cone >= 0 && record.inner_cone <= record.outer_cone && record.outer_cone > 0 &&
                      record.outer_cone <= 0.5 * pi + 1e-6;
    const double outer = record.outer_cone > 0 ? std::min(record.outer_cone, 0.5 * pi) : 0.25 * pi;
    const double inner = record.inner_cone > 0 ? std::min(record.inner_cone, outer) : 0.0;
    if (!fits) warnings.push_back({"lamp-cone", where, "spot cone angles were not 0 <= inner <= outer, 0 < outer <= pi/2: limited"});
    lamp.cos_inner = static_cast<float>(std::cos(inner));
    lamp.cos_outer = static_cast<float>(std::cos(outer));
}

/// Apparent diameters of lamps at infinity end short of half the sky: half of it would be more than a lamp.
constexpr double widest_lamp_degrees = 170;

void set_size(const LampRecord& record, const BuildOptions& options, Lamp& lamp, const std::string& where,
              std::vector<Warning>& warnings) {
    if (record.kind == LampKind::directional) {
        const double wanted = record.angle_degrees >= 0 ? record.angle_degrees : options.sun_angle_degrees;
        const double angle = std::min(wanted, widest_lamp_degrees);
        if (angle < wanted)
            warnings.push_back({"lamp-size", where, "angle: expected at most 170 degrees, found " + std::to_string(wanted) + ": 170 is used"});
        lamp.sin_radius = static_cast<float>(std::sin(angle * pi / 360));
    } else {
        const double radius = record.radius >= 0 ? record.radius : options.lamp_radius;
        lamp.radius = std::isfinite(radius) && radius < 1e18 ? static_cast<float>(radius) : 0.0f;
    }
}

}  // namespace

void build_materials(const SceneRecord& record, const std::vector<std::optional<float>>& least_alpha, const ImageDecoder& decode,
                     const BuildOptions& options, Scene& scene, std::vector<Warning>& warnings) {
    TextureSet textures(record, decode, scene, warnings);
    for (std::size_t m = 0; m < record.materials.size(); ++m) {
        const MaterialRecord& from = record.materials[m];
        const std::string where = "material " + (from.name.empty() ? std::to_string(m) : "\"" + from.name + "\"");
        const bool is_used = least_alpha[m].has_value();
        std::vector<Warning> unheard;
        std::vector<Warning>& findings = is_used ? warnings : unheard;
        // What nothing shows may hold what it likes.
        const BadValues bad_values = is_used ? options.bad_values : BadValues::clamp;
        Material material = convert_material(from, ValueCheck(bad_values, options.file, where, findings));
        note_kinds(from, where, findings);
        if (is_used && options.textures) {
            material.base_texture = textures.add(from.base_color_texture, where);
            // A texture of something that does not emit is never looked at.
            if (material.emission != Rgb(0, 0, 0)) material.emissive_texture = textures.add(from.emissive_texture, where);
            if (material.transmission > 0)
                material.transmission_texture = textures.add(from.transmission_texture, where, false);
        }
        material.blend_colours = options.blend_colours;
        if (!options.keep_even_textures) fold_even_textures(scene, material);
        settle_alpha(scene, least_alpha[m].value_or(1), material);
        scene.materials.push_back(std::move(material));
    }
    forget_folded_pixels(scene);
    Material default_material;
    default_material.name = "(none)";
    default_material.reflectance = Rgb(0, 0, 0);  // the default metallicFactor is 1: it mirrors
    scene.materials.push_back(std::move(default_material));
}

void build_lamps(const SceneRecord& record, const BuildOptions& options, Scene& scene, std::vector<Warning>& warnings) {
    for (const LampRecord& from : record.lamps) {
        Lamp lamp;
        lamp.kind = from.kind;
        lamp.name = from.node_path;
        const std::string where = "lamp " + lamp.name;
        const Vec3d place = Vec3d(from.world[3][0], from.world[3][1], from.world[3][2]) - scene.origin;
        lamp.position = to_float(place);
        const Vec3d direction = direction_of(from.world);
        const bool has_place = from.kind == LampKind::directional || std::isfinite(lamp.position.length());
        if (!has_place || (from.kind != LampKind::point && !usable(direction))) {
            warnings.push_back({"lamp-skipped", where, "the node's matrix gives the lamp no place or direction"});
            continue;
        }
        lamp.direction = usable(direction) ? to_float(direction.normalized()) : Vec3f(0, 0, -1);
        std::array<double, 3> intensity = from.intensity;
        ValueCheck(options.bad_values, options.file, where, warnings)
            .limit(intensity, most_light, "lamp-clamped", "color times intensity");
        lamp.intensity = {static_cast<float>(intensity[0]), static_cast<float>(intensity[1]), static_cast<float>(intensity[2])};
        lamp.range = from.range > 0 && std::isfinite(from.range) ? static_cast<float>(from.range) : 0.0f;
        if (from.kind == LampKind::spot) set_cone(from, lamp, where, warnings);
        set_size(from, options, lamp, where, warnings);
        const bool is_dark = lamp.intensity == Rgb(0, 0, 0);
        if (is_dark) scene.dark_lamps.push_back(lamp.name);
        if (!is_dark || options.keep_dark_lamps) scene.lamps.push_back(std::move(lamp));
    }
}

}  // namespace luxel
