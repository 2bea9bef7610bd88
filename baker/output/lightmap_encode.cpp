#include "baker/output/lightmap_encode.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "baker/output/fifth_root.h"
#include "baker/output/ordered_dither.h"

namespace luxel {
namespace {

constexpr double srgb_to_linear(double c) {
    if (c <= 0.04045) return c / 12.92;
    const double base = (c + 0.055) / 1.055;
    const double square = base * base;
    return square * fifth_root(square);  // base^2.4 = base^2 * (base^2)^(1/5)
}

/// What each byte stands for, and the value above which the next byte is nearer.
struct ByteTable {
    std::array<double, 256> value{};
    std::array<double, 255> upper{};
};

constexpr ByteTable make_table(LightmapEncoding encoding) {
    ByteTable table;
    for (std::size_t k = 0; k < 256; ++k) {
        const double share = static_cast<double>(k) / 255.0;
        table.value[k] = encoding == LightmapEncoding::srgb8 ? srgb_to_linear(share) : share;
    }
    for (std::size_t k = 0; k < 255; ++k) table.upper[k] = (table.value[k] + table.value[k + 1]) / 2.0;
    return table;
}

constexpr ByteTable srgb_table = make_table(LightmapEncoding::srgb8);
constexpr ByteTable linear_table = make_table(LightmapEncoding::linear8);

const ByteTable& table_of(LightmapEncoding encoding) {
    return encoding == LightmapEncoding::srgb8 ? srgb_table : linear_table;
}

std::uint8_t nearest_byte(double share, const ByteTable& table) {
    return static_cast<std::uint8_t>(std::lower_bound(table.upper.begin(), table.upper.end(), share) -
                                     table.upper.begin());
}

/// The byte below or above: the one above in the share of places that makes the mean right.
std::uint8_t dithered_byte(double share, double threshold, const ByteTable& table) {
    const auto above = std::upper_bound(table.value.begin(), table.value.end(), share);
    if (above == table.value.end()) return 255;
    if (above == table.value.begin()) return 0;
    const double low = above[-1], high = *above;
    const auto byte = static_cast<std::uint8_t>(above - table.value.begin() - 1);
    return share - low > threshold * (high - low) ? static_cast<std::uint8_t>(byte + 1) : byte;
}

ImageMetadata metadata_of(const std::string& encoding, double intensity, const std::string& software) {
    ImageMetadata metadata;
    metadata.quantity = "irradiance";
    metadata.unit = "lux";
    metadata.encoding = encoding;
    metadata.intensity = intensity;
    metadata.software = software;
    return metadata;
}

void check_sizes(std::size_t values, std::size_t mask, std::uint64_t texels) {
    if (values != texels || mask != texels)
        throw Error(ErrorCode::internal, "lightmap page",
                    "expected " + std::to_string(texels) + " texels, found " + std::to_string(values) +
                        " values and a mask of " + std::to_string(mask));
}

float largest_channel(std::span<const Rgb> irradiance, std::span<const std::uint8_t> mask) {
    float largest = 0;
    for (std::size_t texel = 0; texel < irradiance.size(); ++texel) {
        if (!mask[texel]) continue;
        const Rgb& value = irradiance[texel];
        if (!std::isfinite(value.x) || !std::isfinite(value.y) || !std::isfinite(value.z))
            throw Error(ErrorCode::internal, "lightmap texel " + std::to_string(texel),
                        "expected a finite irradiance, found NaN or infinity");
        largest = std::max({largest, value.x, value.y, value.z});
    }
    return largest;
}

}  // namespace

const char* encoding_name(LightmapEncoding encoding) {
    return encoding == LightmapEncoding::srgb8 ? "srgb8" : "linear8";
}

LightmapEncoding parse_encoding(const std::string& name) {
    for (const LightmapEncoding encoding : {LightmapEncoding::srgb8, LightmapEncoding::linear8})
        if (name == encoding_name(encoding)) return encoding;
    throw Error(ErrorCode::usage, "lightmap encoding", "expected srgb8 or linear8, found \"" + name + "\"");
}

double largest_light(std::span<const Rgb> irradiance, std::span<const std::uint8_t> mask) {
    check_sizes(irradiance.size(), mask.size(), irradiance.size());
    const float largest = largest_channel(irradiance, mask);
    return largest > 0 ? static_cast<double>(largest) : 1.0;
}

namespace {

EncodedPage encode_scaled(std::span<const Rgb> values, std::span<const std::uint8_t> mask, double intensity, LightmapEncoding encoding,
                          std::uint32_t dither_width) {
    EncodedPage page;
    page.intensity = intensity;
    page.rgb.assign(values.size() * 3, 0);
    const ByteTable& table = table_of(encoding);
    for (std::size_t texel = 0; texel < values.size(); ++texel) {
        if (!mask[texel]) continue;
        const double threshold =
            dither_width ? dither_threshold(static_cast<std::uint32_t>(texel % dither_width), static_cast<std::uint32_t>(texel / dither_width)) : 0;
        for (int channel = 0; channel < 3; ++channel) {
            const double share = static_cast<double>(values[texel][channel]) / intensity;
            page.rgb[3 * texel + static_cast<std::size_t>(channel)] =
                dither_width ? dithered_byte(share, threshold, table) : nearest_byte(share, table);
        }
    }
    return page;
}

}  // namespace

EncodedPage encode_lightmap(std::span<const Rgb> irradiance, std::span<const std::uint8_t> mask,
                            LightmapEncoding encoding, std::uint32_t dither_width) {
    return encode_scaled(irradiance, mask, largest_light(irradiance, mask), encoding, dither_width);
}

EncodedPage encode_shares(std::span<const Rgb> shares, std::span<const std::uint8_t> mask, LightmapEncoding encoding,
                          std::uint32_t dither_width) {
    check_sizes(shares.size(), mask.size(), shares.size());
    return encode_scaled(shares, mask, 1, encoding, dither_width);
}

double decode_lightmap_byte(std::uint8_t byte, LightmapEncoding encoding) { return table_of(encoding).value[byte]; }

Bytes lightmap_png(const EncodedPage& page, LightmapEncoding encoding, std::uint32_t width, std::uint32_t height,
                   const std::string& software) {
    return encode_png(width, height, page.rgb, metadata_of(encoding_name(encoding), page.intensity, software));
}

Bytes lightmap_exr(std::span<const Rgb> irradiance, std::span<const std::uint8_t> mask, std::uint32_t width,
                   std::uint32_t height, const std::string& software) {
    check_sizes(irradiance.size(), mask.size(), std::uint64_t{width} * height);
    std::vector<float> values(irradiance.size() * 3, 0.0f);
    for (std::size_t texel = 0; texel < irradiance.size(); ++texel)
        if (mask[texel])
            for (int channel = 0; channel < 3; ++channel)
                values[3 * texel + static_cast<std::size_t>(channel)] = irradiance[texel][channel];
    return encode_exr({width, height, {"R", "G", "B"}, values}, exr_sample_for(values),
                      metadata_of("linear", 1.0, software));
}

}  // namespace luxel
