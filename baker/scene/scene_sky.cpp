#include "baker/scene/scene_sky.h"

#include <algorithm>
#include <cmath>

#include "baker/core/units.h"

namespace luxel {
namespace {

using Picture = std::vector<std::array<float, 4>>;

/// Pixels as light: times `scale`, within what light can be.
void set_nits(const Picture& pixels, double scale, const ValueCheck& check, SkyMap& sky) {
    std::array<double, 3> worst{0, 0, 0};
    sky.nits.reserve(pixels.size());
    for (const auto& pixel : pixels) {
        Rgb nits;
        for (std::size_t c = 0; c < 3; ++c) {
            const double value = static_cast<double>(pixel[c]) * scale;
            const bool fits = value >= 0 && value <= most_light;
            if (!fits) worst[c] = value;
            nits[static_cast<int>(c)] = static_cast<float>(fits ? value : value > most_light ? most_light : 0.0);
        }
        sky.nits.push_back(nits);
    }
    check.limit(worst, most_light, "sky-clamped", "pixels of the sky");
}

/// Mean over blocks of `step` x `step` pixels; what is left over at the right and lower edge goes to the last ones.
DecodedImage averaged(const DecodedImage& from, std::uint32_t step) {
    DecodedImage to;
    to.width = std::max(1u, from.width / step);
    to.height = std::max(1u, from.height / step);
    const auto end = [&](std::uint32_t k, std::uint32_t count, std::uint32_t all) { return k + 1 == count ? all : (k + 1) * step; };
    for (std::uint32_t y = 0; y < to.height; ++y)
        for (std::uint32_t x = 0; x < to.width; ++x) {
            std::array<double, 3> sum{};
            const std::uint32_t right = end(x, to.width, from.width), low = end(y, to.height, from.height);
            for (std::uint32_t row = y * step; row < low; ++row)
                for (std::uint32_t column = x * step; column < right; ++column)
                    for (std::size_t c = 0; c < 3; ++c)
                        sum[c] += static_cast<double>(from.rgba[std::size_t{row} * from.width + column][c]);
            const double count = static_cast<double>(right - x * step) * static_cast<double>(low - y * step);
            to.rgba.push_back({static_cast<float>(sum[0] / count), static_cast<float>(sum[1] / count),
                               static_cast<float>(sum[2] / count), 1.0f});
        }
    return to;
}

float linear(float encoded) {
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

/// RGBD and sRGB to light.
void expand(DecodedImage& face) {
    for (auto& pixel : face.rgba) {
        const float divisor = std::max(pixel[3], 1.0f / 255.0f);
        for (std::size_t c = 0; c < 3; ++c) pixel[c] = linear(pixel[c]) / divisor;
    }
}

struct FacePlace {
    std::size_t face;
    double u, v;  ///< 0..1, v down
};

/// Where a direction of the cubemap's own axes is. Each face is what is seen from the middle: u to the right.
FacePlace face_place(const Vec3d& d) {
    const double x = std::fabs(d.x), y = std::fabs(d.y), z = std::fabs(d.z);
    const auto at = [](std::size_t face, double right, double down, double depth) {
        return FacePlace{face, 0.5 * (right / depth + 1), 0.5 * (down / depth + 1)};
    };
    if (x >= y && x >= z) return d.x > 0 ? at(0, d.z, -d.y, x) : at(1, -d.z, -d.y, x);
    if (y >= z) return d.y > 0 ? at(2, -d.x, d.z, y) : at(3, -d.x, -d.z, y);
    return d.z > 0 ? at(4, -d.x, -d.y, z) : at(5, d.x, -d.y, z);
}

/// The opposite turn of a quaternion applied to a direction.
Vec3d turned_back(const std::array<double, 4>& q, const Vec3d& d) {
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 0) || !std::isfinite(length)) return d;
    const Vec3d axis(-q[0] / length, -q[1] / length, -q[2] / length);
    const Vec3d t = axis.cross(d) * 2.0;
    return d + t * (q[3] / length) + axis.cross(t);
}

bool decode_faces(const SkyRecord& record, const ImageDecoder& decode, std::array<DecodedImage, 6>& faces,
                  std::vector<Warning>& warnings) {
    for (std::size_t k = 0; k < faces.size(); ++k) {
        auto face = record.faces[k].bytes.empty() || !decode ? std::nullopt : decode(record.faces[k].bytes, record.faces[k].name);
        if (!face || face->rgba.empty()) {
            warnings.push_back({"sky-missing", record.where, "picture " + std::to_string(k) +
                                                                 " of the cubemap cannot be read: the scene is baked without sky"});
            return false;
        }
        faces[k] = std::move(*face);
        expand(faces[k]);
    }
    return true;
}

/// The cubemap by longitude and latitude: the mean of 4 x 4 points per pixel.
DecodedImage unrolled(const std::array<DecodedImage, 6>& faces, const std::array<double, 4>& rotation) {
    constexpr std::uint32_t points = 4;
    DecodedImage to;
    to.width = std::clamp(4 * faces[0].width, 4u, most_sky_columns);
    to.height = to.width / 2;
    for (std::uint32_t y = 0; y < to.height; ++y)
        for (std::uint32_t x = 0; x < to.width; ++x) {
            std::array<float, 4> sum{0, 0, 0, 1};
            for (std::uint32_t k = 0; k < points * points; ++k) {
                const double down = pi * (y + (k / points + 0.5) / points) / to.height;
                const double along = 2 * pi * ((x + (k % points + 0.5) / points) / to.width - 0.5);
                const Vec3d d(std::sin(down) * std::cos(along), std::cos(down), std::sin(down) * std::sin(along));
                const FacePlace place = face_place(turned_back(rotation, d));
                const DecodedImage& face = faces[place.face];
                const auto column = std::min(static_cast<std::uint32_t>(place.u * face.width), face.width - 1);
                const auto row = std::min(static_cast<std::uint32_t>(place.v * face.height), face.height - 1);
                for (std::size_t c = 0; c < 3; ++c)
                    sum[c] += face.rgba[std::size_t{row} * face.width + column][c] / (points * points);
            }
            to.rgba.push_back(sum);
        }
    return to;
}

SkyMap from_picture(const DecodedImage& picture, double scale, const ValueCheck& check) {
    const std::uint32_t step = (picture.width + most_sky_columns - 1) / most_sky_columns;
    const DecodedImage small = step > 1 ? averaged(picture, step) : DecodedImage{};
    const DecodedImage& used = step > 1 ? small : picture;
    SkyMap sky;
    sky.width = used.width, sky.height = used.height;
    set_nits(used.rgba, scale, check, sky);
    return sky;
}

}  // namespace

SkyMap build_sky(const SkyRecord& record, const ImageDecoder& decode, const BuildOptions& options,
                 std::vector<Warning>& warnings) {
    const SkyWish& wish = options.sky;
    SkyMap sky;
    if (wish.none) return sky;
    const ValueCheck check(options.bad_values, options.file, "the sky", warnings);
    if (wish.color) {
        const auto& nits = *wish.color;
        sky = from_picture({1, 1, {{static_cast<float>(nits[0]), static_cast<float>(nits[1]), static_cast<float>(nits[2]), 1.0f}}},
                           wish.scale, check);
    } else if (wish.picture) {
        const ValueCheck of_picture(options.bad_values, wish.picture_name, "the sky", warnings);
        sky = from_picture(*wish.picture, wish.scale, of_picture);
    } else if (record.is_there) {
        std::array<DecodedImage, 6> faces;
        if (!decode_faces(record, decode, faces, warnings)) return sky;
        sky = from_picture(unrolled(faces, record.rotation), record.intensity * wish.scale, check);
    }
    sky.turn = wish.turn_degrees * pi / 180;
    return sky;
}

}  // namespace luxel
