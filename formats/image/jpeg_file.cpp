#include "formats/image/jpeg_file.h"

#include <turbojpeg.h>

#include <memory>

#include "formats/image/codec.h"

namespace luxel {
namespace {

struct Destroy {
    void operator()(void* decoder) const { tjDestroy(decoder); }
};
using Decoder = std::unique_ptr<void, Destroy>;

std::string words_of(const Decoder& decoder) {
    const std::string words = tjGetErrorStr2(decoder.get());
    return words.empty() ? "it is damaged" : words;
}

/// Bytes between the parts of a file, as careless programs leave them, hurt no pixel; every other warning does.
bool is_harmless(const Decoder& decoder) {
    return tjGetErrorCode(decoder.get()) == TJERR_WARNING && words_of(decoder).find("extraneous bytes before marker") != std::string::npos;
}

std::optional<std::string> decode_body(ByteView bytes, const ImageLimits& limits, ImagePixels& out) {
    const Decoder decoder(tjInitDecompress());
    if (!decoder) throw std::bad_alloc();
    int width = 0, height = 0, subsampling = -1, colours = -1;
    const int head = tjDecompressHeader3(decoder.get(), bytes.data(), bytes.size(), &width, &height, &subsampling, &colours);
    if (colours == TJCS_CMYK || colours == TJCS_YCCK) return std::nullopt;
    // It also fails at subsampling that has no name there, which hinders nobody from decoding.
    const bool has_rare_subsampling = width > 0 && height > 0 && subsampling < 0 && colours >= 0;
    if (head != 0 && !has_rare_subsampling && !is_harmless(decoder)) return words_of(decoder);
    if (std::string why = size_trouble(width, height, limits); !why.empty()) return why;

    allocate_pixels(out, width, height);
    const auto row_bytes = static_cast<int>(out.width * sizeof(out.pixels[0]));
    // Limited scans: a progressive file of a few bytes could otherwise keep the decoder busy for hours.
    if (tjDecompress2(decoder.get(), bytes.data(), bytes.size(), packed_row(out, 0), width, row_bytes, height, TJPF_RGBA,
                      TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS) != 0 &&
        !is_harmless(decoder))
        return words_of(decoder);
    unpack_rows<1>(out);
    return "";
}

}  // namespace

std::optional<std::string> decode_jpeg(ByteView bytes, const ImageLimits& limits, ImagePixels& out) {
    return guarded([&] { return decode_body(bytes, limits, out); });
}

}  // namespace luxel
