#include "baker/output/texel_codes.h"

#include <algorithm>
#include <cmath>

#include "formats/image/image_file.h"

namespace luxel {
namespace {

constexpr int rgbe_bias = 128, mantissa_bits = 8;

double largest_of(const TexelValues& values) { return std::max({values[0], values[1], values[2]}); }

std::uint8_t rounded(double value) { return static_cast<std::uint8_t>(std::min(255.0, std::floor(value + 0.5))); }

double largest_error(const TexelValues& shares, const TexelBytes& bytes) {
    const TexelValues decoded = rgbm_shares(bytes);
    double error = 0;
    for (std::size_t c = 0; c < 3; ++c) error = std::max(error, std::abs(decoded[c] - shares[c]));
    return error;
}

}  // namespace

TexelBytes rgbe_of(const TexelValues& values) {
    const double largest = largest_of(values);
    if (!(largest > 0)) return {};
    int exponent = 0;
    std::frexp(largest, &exponent);
    // A mantissa of 255.5 and more becomes 256, which needs the next exponent.
    if (std::ldexp(largest, mantissa_bits - exponent) >= 255.5) ++exponent;
    if (exponent + rgbe_bias < 1) return {};
    TexelBytes bytes{};
    for (std::size_t c = 0; c < 3; ++c) bytes[c] = rounded(std::ldexp(std::max(values[c], 0.0), mantissa_bits - exponent));
    bytes[3] = static_cast<std::uint8_t>(std::min(exponent + rgbe_bias, 255));
    return bytes;
}

TexelValues rgbe_values(const TexelBytes& bytes) {
    TexelValues values{};
    if (bytes[3])
        for (std::size_t c = 0; c < 3; ++c) values[c] = std::ldexp(static_cast<double>(bytes[c]), bytes[3] - rgbe_bias - mantissa_bits);
    return values;
}

TexelBytes rgbm_of(const TexelValues& shares) {
    const double largest = std::min(largest_of(shares), 1.0);
    if (!(largest > 0)) return {0, 0, 0, 255};
    const int lowest = std::max(1, static_cast<int>(std::ceil(255 * largest)));
    const int highest = std::min(255, lowest + lowest / 16);
    TexelBytes best{};
    double least = 2;
    for (int m = lowest; m <= highest; ++m) {
        TexelBytes bytes{};
        for (std::size_t c = 0; c < 3; ++c) bytes[c] = rounded(std::max(shares[c], 0.0) * 65025 / m);
        bytes[3] = static_cast<std::uint8_t>(m);
        const double error = largest_error(shares, bytes);
        if (error <= least) least = error, best = bytes;
    }
    return best;
}

TexelValues rgbm_shares(const TexelBytes& bytes) {
    TexelValues shares{};
    for (std::size_t c = 0; c < 3; ++c) shares[c] = static_cast<double>(bytes[c] * bytes[3]) / 65025;
    return shares;
}

double half_intensity(std::span<const float> values) {
    if (exr_sample_for(values) == ExrSample::half_float) return 1;
    float largest = 0;
    for (const float value : values) largest = std::max(largest, std::abs(value));
    int exponent = 0;
    std::frexp(largest, &exponent);
    return std::ldexp(1.0, exponent - 15);
}

}  // namespace luxel
