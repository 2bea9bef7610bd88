#include "baker/output/page_picture.h"

#include <half.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "baker/core/parallel.h"
#include "baker/output/texel_codes.h"
#include "formats/image/image_file.h"

namespace luxel {
namespace {

constexpr std::size_t grain = 4096;  ///< texels of one task

float half_value(std::uint16_t bits) {
    Imath::half value;
    value.setBits(bits);
    return value;
}
/// The shortest text that is this number: "8", "34.49".
std::string number_text(double value) {
    std::array<char, 32> text{};
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::uint16_t half_bits(float value) { return Imath::half(value).bits(); }

class Encoder {
  public:
    Encoder(std::span<const Rgb> irradiance, std::span<const std::uint8_t> mask, std::uint32_t width, std::uint32_t height,
            const PagePictureOptions& options)
        : light_(irradiance), mask_(mask), width_(width), height_(height), options_(options) {
        if (light_.size() != std::uint64_t{width} * height)
            throw Error(ErrorCode::internal, "lightmap page", "expected " + std::to_string(std::uint64_t{width} * height) + " texels, found " + std::to_string(light_.size()));
        largest_ = largest_light(light_, mask_);
        const std::vector<float> values = flat_values();
        truth_is_half_ = exr_sample_for(values) == ExrSample::half_float;
        half_intensity_ = half_intensity(values);
    }

    PagePicture encode() {
        switch (options_.format) {
            case LightmapFormat::png8:
                return png8();
            case LightmapFormat::png16:
                return png16();
            case LightmapFormat::rgbm:
                return rgbm(rgbm_range, rgbm_of, rgbm_shares);
            case LightmapFormat::rgbm_mx:
                return rgbm(rgbm_mx_range, rgbm_mx_of, rgbm_mx_shares);
            case LightmapFormat::rgbe:
                return rgbe();
            case LightmapFormat::exr:
                return exr();
            case LightmapFormat::ktx2:
                return ktx2();
        }
        return {};
    }

  private:
    [[nodiscard]] std::vector<float> flat_values() const {
        std::vector<float> values(light_.size() * 3, 0.0f);
        for (std::size_t texel = 0; texel < light_.size(); ++texel)
            if (mask_[texel])
                for (int c = 0; c < 3; ++c) values[3 * texel + static_cast<std::size_t>(c)] = std::max(0.0f, light_[texel][c]);
        return values;
    }

    /// Channels over `intensity`, none below 0.
    [[nodiscard]] TexelValues scaled(std::size_t texel, double intensity) const {
        TexelValues values{};
        for (int c = 0; c < 3; ++c) values[static_cast<std::size_t>(c)] = std::max(0.0, static_cast<double>(light_[texel][c]) / intensity);
        return values;
    }

    template <class Body>
    void for_texels(const Body& body) const {
        parallel_for(light_.size(), grain, [&](std::size_t texel) {
            if (mask_[texel]) body(texel);
        });
    }

    /// decode(texel): TexelValues before the intensity.
    template <class Decode>
    [[nodiscard]] PictureError error_of(double intensity, const Decode& decode) const {
        PictureErrorSum sum(light_.size());
        for (std::size_t texel = 0; texel < light_.size(); ++texel) {
            if (!mask_[texel]) continue;
            const TexelValues values = decode(texel);
            double decoded[3], truth[3];
            for (int c = 0; c < 3; ++c) {
                decoded[c] = values[static_cast<std::size_t>(c)] * intensity;
                truth[c] = static_cast<double>(truth_is_half_ ? half_value(half_bits(light_[texel][c])) : light_[texel][c]);
            }
            sum.add(decoded, truth);
        }
        return sum.result();
    }

    [[nodiscard]] ImageMetadata metadata(double intensity, double range = 0) const {
        ImageMetadata metadata{"irradiance", "lux", encoding_of(options_.format, options_.encoding), intensity, options_.software, {}};
        metadata.more.emplace_back("format", lightmap_format_info(options_.format).name);
        if (range > 0) metadata.more.emplace_back("range", number_text(range));
        return metadata;
    }

    PagePicture png8() {
        const EncodedPage page = encode_lightmap(light_, mask_, options_.encoding, options_.dither ? width_ : 0);
        PagePicture picture{lightmap_png(page, options_.encoding, width_, height_, options_.software), page.intensity, 0, {}};
        picture.error = error_of(page.intensity, [&](std::size_t texel) {
            TexelValues values{};
            for (std::size_t c = 0; c < 3; ++c) values[c] = decode_lightmap_byte(page.rgb[3 * texel + c], options_.encoding);
            return values;
        });
        return picture;
    }

    PagePicture png16() {
        std::vector<std::uint16_t> codes(light_.size() * 3, 0);
        for_texels([&](std::size_t texel) {
            const TexelValues shares = scaled(texel, largest_);
            for (std::size_t c = 0; c < 3; ++c) codes[3 * texel + c] = static_cast<std::uint16_t>(std::floor(shares[c] * 65535 + 0.5));
        });
        const PictureError error = error_of(largest_, [&](std::size_t texel) {
            return TexelValues{codes[3 * texel] / 65535.0, codes[3 * texel + 1] / 65535.0, codes[3 * texel + 2] / 65535.0};
        });
        return {encode_png_16(width_, height_, codes, metadata(largest_)), largest_, 0, error};
    }

    /// Four bytes a texel; `of` makes them.
    template <class Of>
    [[nodiscard]] std::vector<std::uint8_t> four_bytes(const TexelBytes& elsewhere, const Of& of) const {
        std::vector<std::uint8_t> bytes(light_.size() * 4);
        parallel_for(light_.size(), grain, [&](std::size_t texel) {
            const TexelBytes code = mask_[texel] ? of(texel) : elsewhere;
            std::copy(code.begin(), code.end(), bytes.begin() + static_cast<std::ptrdiff_t>(4 * texel));
        });
        return bytes;
    }
    static TexelBytes at(const std::vector<std::uint8_t>& bytes, std::size_t texel) {
        return {bytes[4 * texel], bytes[4 * texel + 1], bytes[4 * texel + 2], bytes[4 * texel + 3]};
    }

    PagePicture rgbm(double range, TexelBytes (*code_of)(const TexelValues&), TexelValues (*shares_of)(const TexelBytes&)) {
        const double intensity = largest_ / range;
        const auto bytes = four_bytes(code_of({}), [&](std::size_t texel) { return code_of(scaled(texel, largest_)); });
        const PictureError error = error_of(largest_, [&](std::size_t texel) { return shares_of(at(bytes, texel)); });
        return {encode_png_rgba(width_, height_, bytes, metadata(intensity, range)), intensity, range, error};
    }

    PagePicture rgbe() {
        const double intensity = half_intensity_;
        const auto bytes = four_bytes(rgbe_of({}), [&](std::size_t texel) { return rgbe_of(scaled(texel, intensity)); });
        const PictureError error = error_of(intensity, [&](std::size_t texel) { return rgbe_values(at(bytes, texel)); });
        return {encode_hdr(width_, height_, bytes, metadata(intensity)), intensity, 0, error};
    }

    PagePicture exr() {
        std::vector<float> values(light_.size() * 3, 0.0f);
        for_texels([&](std::size_t texel) {
            const TexelValues scaled_values = scaled(texel, half_intensity_);
            for (std::size_t c = 0; c < 3; ++c) values[3 * texel + c] = half_value(half_bits(static_cast<float>(scaled_values[c])));
        });
        const PictureError error = error_of(half_intensity_, [&](std::size_t texel) {
            return TexelValues{static_cast<double>(values[3 * texel]), static_cast<double>(values[3 * texel + 1]), static_cast<double>(values[3 * texel + 2])};
        });
        return {encode_exr({width_, height_, {"R", "G", "B"}, values}, ExrSample::half_float, metadata(half_intensity_)), half_intensity_, 0, error};
    }

    PagePicture ktx2() {
        std::vector<std::uint16_t> halves(light_.size() * 4, 0);
        const std::uint16_t one = half_bits(1);
        for (std::size_t texel = 0; texel < light_.size(); ++texel) halves[4 * texel + 3] = one;
        for_texels([&](std::size_t texel) {
            const TexelValues values = scaled(texel, half_intensity_);
            for (std::size_t c = 0; c < 3; ++c) halves[4 * texel + c] = half_bits(static_cast<float>(values[c]));
        });
        const PictureError error = error_of(half_intensity_, [&](std::size_t texel) {
            TexelValues values{};
            for (std::size_t c = 0; c < 3; ++c) values[c] = static_cast<double>(half_value(halves[4 * texel + c]));
            return values;
        });
        return {encode_ktx2(width_, height_, halves, metadata(half_intensity_)), half_intensity_, 0, error};
    }

    std::span<const Rgb> light_;
    std::span<const std::uint8_t> mask_;
    std::uint32_t width_, height_;
    const PagePictureOptions& options_;
    double largest_ = 1, half_intensity_ = 1;
    bool truth_is_half_ = false;
};

}  // namespace

PagePicture page_picture(std::span<const Rgb> irradiance, std::span<const std::uint8_t> mask, std::uint32_t width, std::uint32_t height,
                         const PagePictureOptions& options) {
    return Encoder(irradiance, mask, width, height, options).encode();
}

}  // namespace luxel
