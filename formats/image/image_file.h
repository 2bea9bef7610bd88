/// Pictures: decode what scenes bring (PNG, JPEG, WebP, Radiance HDR, OpenEXR) and encode what a bake publishes
/// (OpenEXR, PNG, Radiance HDR, KTX 2.0).
///
/// PNG, JPEG and OpenEXR are read and written with their own small libraries. The rest, WebP, Radiance HDR, JPEG in CMYK and OpenEXR
/// in luminance and chroma, is read by OpenImageIO, which costs 0.17 s and 130 MB per process: it lives in a module
/// (luxel_image_plugin.so) that is loaded by the first such picture. Writing never needs it. The module is looked for in the folder
/// LUXEL_PLUGIN_DIR, beside the running program, in ../lib/luxel from there, and where it was built.
///
/// Errors   Error{bad_input}: not a picture of these kinds, damaged, or too large. Error{not_in_build}: the module is
///          missing or of another version. Error{cannot_write}: a picture could not be encoded.
/// Threads  all functions are reentrant. The bytes written do not depend on the thread count.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "formats/base/bytes.h"

namespace luxel {

/// RGBA as stored in the file: integers divided by their largest value, floats as they are; no colour conversion, alpha
/// not multiplied in (WebP: recovered, so black where alpha is 0). Grey is repeated in all three channels; alpha is 1
/// where the file has none. Row 0 is the top.
struct ImagePixels {
    std::uint32_t width = 0, height = 0;
    bool is_float = false;                     ///< half or float samples (HDR, EXR): linear already
    std::vector<std::array<float, 4>> pixels;  ///< width * height
};

/// What is refused before anything is allocated for it.
struct ImageLimits {
    std::uint32_t max_side = 32768;
    std::uint64_t max_pixels = std::uint64_t{1} << 30;
};

/// `where` names the picture in messages.
ImagePixels decode_image(ByteView bytes, const std::string& where, const ImageLimits& limits = {});

/// What the numbers of a written picture mean; all of it is stored in the file.
struct ImageMetadata {
    std::string quantity;                                   ///< "irradiance"
    std::string unit;                                       ///< "lux"
    std::string encoding;                                   ///< "linear", or a name of baker/output/lightmap_encode.h
    double intensity = 1;                                   ///< value = decoded sample * intensity
    std::string software = "luxel";                         ///< name and version of the writer
    std::vector<std::pair<std::string, std::string>> more;  ///< further attributes, in this order
};

enum class ExrSample {
    half_float,
    float_32,
    uint_32  ///< only of encode_exr_parts()
};

/// Interleaved float channels, row 0 at the top. `values` has width * height * channels.size() elements.
struct ImageView {
    std::uint32_t width = 0, height = 0;
    std::vector<std::string> channels;  ///< "R", "G", "B", then any others
    std::span<const float> values;
};

/// An OpenEXR file: lossless ZIP compression, the metadata as attributes `quantity`, `unit`, `encoding`, `intensity`
/// and `Software`, and a fixed DateTime, so that the same values give the same bytes. Values beyond 65504 become
/// infinite as half_float: ask exr_sample_for() first.
Bytes encode_exr(const ImageView& image, ExrSample sample, const ImageMetadata& metadata);

/// One part of an OpenEXR file that has several, each with a name, channels and samples of its own.
struct ExrPart {
    std::string name;  ///< unique in the file, not empty
    std::vector<std::string> channels;
    ExrSample sample = ExrSample::float_32;
    ImageMetadata metadata;
};

/// Interleaved, row 0 at the top, width * height * channels.size(); whole numbers for uint_32, else floats.
using ExrPartValues = std::variant<std::vector<float>, std::vector<std::uint32_t>>;

/// A multi-part OpenEXR file (one part: an ordinary one), all parts width x height, written as encode_exr() does. `values` is
/// called once per part, in order, so that only one is held at a time. What it throws is passed on.
Bytes encode_exr_parts(std::uint32_t width, std::uint32_t height, std::span<const ExrPart> parts,
                       const std::function<ExrPartValues(std::size_t part)>& values);

/// half_float where every value survives it with at most 2^-11 relative error (0, or 2^-14 <= |v| <= 65504), else
/// float_32. Values below 2^-24 of the largest one do not count: beside it they are nothing.
ExrSample exr_sample_for(std::span<const float> values);

/// An 8-bit RGB PNG without colour chunks (glTF gives the colour space), metadata as text chunks of the same names.
/// `rgb` has width * height * 3 bytes, row 0 at the top.
Bytes encode_png(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgb,
                 const ImageMetadata& metadata);
/// The same with alpha (width * height * 4 bytes), and with 16 bits a sample (width * height * 3 samples).
Bytes encode_png_rgba(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgba, const ImageMetadata& metadata);
Bytes encode_png_16(std::uint32_t width, std::uint32_t height, std::span<const std::uint16_t> rgb, const ImageMetadata& metadata);

/// Radiance HDR, run-length coded: `rgbe` has 4 bytes a pixel, three mantissas and their exponent, row 0 at the top; a channel
/// is mantissa * 2^(exponent - 136), and 0 where the exponent is 0. Metadata as comments of the header.
/// Source: G. Ward, Real Pixels, Graphics Gems II (1991); the file format as the Radiance project documents it.
Bytes encode_hdr(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgbe, const ImageMetadata& metadata);

/// KTX 2.0 with one level of half floats, as ktx2_file.md says. `rgba` has width * height * 4 halves, row 0 at the top.
Bytes encode_ktx2(std::uint32_t width, std::uint32_t height, std::span<const std::uint16_t> rgba, const ImageMetadata& metadata);

/// Has the module been loaded by this process? (For tests of the promise above.)
bool image_library_is_loaded();

}  // namespace luxel
