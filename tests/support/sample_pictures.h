/// Makes pictures of many kinds for tests and fuzzers, with the libraries themselves, not through the project's own code, which
/// writes few kinds. A failure ends the program.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/base/bytes.h"

namespace luxel::test {

enum class PngColour { grey, grey_alpha, palette, rgb, rgba };

struct PngSample {
    std::uint32_t width = 0, height = 0;
    PngColour colour = PngColour::rgb;
    int bits = 8;  ///< of a sample: 1, 2, 4, 8, 16
    bool is_interlaced = false;
    std::vector<std::uint16_t> samples{};                ///< interleaved, row 0 at the top; one a pixel where it is grey or a palette
    std::vector<std::array<std::uint8_t, 3>> palette{};  ///< of PngColour::palette
    std::vector<std::uint8_t> palette_alpha{};           ///< of its first colours; empty: all opaque
    std::vector<std::uint16_t> transparent{};            ///< of grey (one) and rgb (three): the colour that is not there; empty: none
};
Bytes make_png(const PngSample& sample);

enum class JpegColour { grey, full, halved, cmyk };  ///< full, halved: resolution of the colour

/// `samples`: 1, 3 or (CMYK) 4 a pixel.
Bytes make_jpeg(std::uint32_t width, std::uint32_t height, JpegColour colour, bool is_progressive,
                const std::vector<std::uint8_t>& samples);

enum class ExrKind { half_float, float_32, uint_32 };

struct ExrSamplePart {
    std::string name{};  ///< needed where there are several
    std::vector<std::pair<std::string, ExrKind>> channels{};
    std::int32_t left = 0, top = 0;                 ///< corner of the data window
    std::uint32_t tile_width = 0, tile_height = 0;  ///< 0: scan lines
    bool has_levels = false;                        ///< of tiles: smaller ones too, black
    std::vector<float> values{};                    ///< interleaved, row 0 at the top
};
Bytes make_exr(std::uint32_t width, std::uint32_t height, const std::vector<ExrSamplePart>& parts);

}  // namespace luxel::test
