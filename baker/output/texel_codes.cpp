#include "baker/output/texel_codes.h"

#include <algorithm>
#include <cmath>

#include "baker/output/fifth_root.h"
#include "formats/image/image_file.h"

namespace luxel {
namespace {

constexpr int rgbe_bias = 128, mantissa_bits = 8;

double largest_of(const TexelValues& values) { return std::max({values[0], values[1], values[2]}); }

std::uint8_t rounded(double value) { return static_cast<std::uint8_t>(std::min(255.0, std::floor(value + 0.5))); }

/// x^2.2 of every m: x = m / 255.
constexpr std::array<double, 256> make_powers() {
    std::array<double, 256> powers{};
    for (std::size_t m = 0; m < powers.size(); ++m) {
        const double x = static_cast<double>(m) / 255.0;
        powers[m] = x * x * fifth_root(x);
    }
    return powers;
}
constexpr std::array<double, 256> powers = make_powers();

/// The bytes of the multiplier among `lowest` to `highest` that errs least in the channel where it errs most; the largest of equals.
/// code(share, m) is the byte before it is rounded.
template <class Code>
TexelBytes best_bytes(const TexelValues& shares, int lowest, int highest, const Code& code, TexelValues (*decode)(const TexelBytes&)) {
    TexelBytes best{};
    double least = 2;
    for (int m = lowest; m <= highest; ++m) {
        TexelBytes bytes{};
        for (std::size_t c = 0; c < 3; ++c) bytes[c] = rounded(code(std::max(shares[c], 0.0), m));
        bytes[3] = static_cast<std::uint8_t>(m);
        const TexelValues decoded = decode(bytes);
        double error = 0;
        for (std::size_t c = 0; c < 3; ++c) error = std::max(error, std::abs(decoded[c] - shares[c]));
        if (error <= least) least = error, best = bytes;
    }
    return best;
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
    return best_bytes(shares, lowest, highest, [](double share, int m) { return share * 65025 / m; }, rgbm_shares);
}

TexelValues rgbm_shares(const TexelBytes& bytes) {
    TexelValues shares{};
    for (std::size_t c = 0; c < 3; ++c) shares[c] = static_cast<double>(bytes[c] * bytes[3]) / 65025;
    return shares;
}

TexelBytes rgbm_mx_of(const TexelValues& shares) {
    const double largest = std::min(largest_of(shares), 1.0);
    if (!(largest > 0)) return {};
    const int lowest = static_cast<int>(std::lower_bound(powers.begin() + 1, powers.end() - 1, largest) - powers.begin());
    const int highest = std::min(255, lowest + lowest / 28);
    return best_bytes(shares, lowest, highest, [](double share, int m) { return share / powers[static_cast<std::size_t>(m)] * 255; }, rgbm_mx_shares);
}

TexelValues rgbm_mx_shares(const TexelBytes& bytes) {
    TexelValues shares{};
    for (std::size_t c = 0; c < 3; ++c) shares[c] = static_cast<double>(bytes[c]) / 255 * powers[bytes[3]];
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
