#include "tests/support/sample_pictures.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <png.h>
#include <turbojpeg.h>

#include <cstdlib>

namespace luxel::test {
namespace {

void require(bool holds) {
    if (!holds) std::abort();
}

[[noreturn]] void on_error(png_structp, png_const_charp) { std::abort(); }

void on_write(png_structp png, png_bytep from, std::size_t count) {
    auto& bytes = *static_cast<Bytes*>(png_get_io_ptr(png));
    bytes.insert(bytes.end(), from, from + count);
}

int type_of(PngColour colour) {
    switch (colour) {
        case PngColour::grey:
            return PNG_COLOR_TYPE_GRAY;
        case PngColour::grey_alpha:
            return PNG_COLOR_TYPE_GRAY_ALPHA;
        case PngColour::palette:
            return PNG_COLOR_TYPE_PALETTE;
        case PngColour::rgb:
            return PNG_COLOR_TYPE_RGB;
        case PngColour::rgba:
            return PNG_COLOR_TYPE_RGB_ALPHA;
    }
    std::abort();
}

void set_transparency(png_structp png, png_infop info, const PngSample& sample) {
    png_color_16 colour{};
    if (sample.colour == PngColour::palette) {
        if (!sample.palette_alpha.empty())
            png_set_tRNS(png, info, sample.palette_alpha.data(), static_cast<int>(sample.palette_alpha.size()), nullptr);
        return;
    }
    if (sample.transparent.empty()) return;
    if (sample.colour == PngColour::grey) colour.gray = sample.transparent.at(0);
    if (sample.colour == PngColour::rgb)
        colour.red = sample.transparent.at(0), colour.green = sample.transparent.at(1), colour.blue = sample.transparent.at(2);
    png_set_tRNS(png, info, nullptr, 0, &colour);
}

Imf::PixelType type_of(ExrKind kind) {
    if (kind == ExrKind::uint_32) return Imf::UINT;
    return kind == ExrKind::half_float ? Imf::HALF : Imf::FLOAT;
}

Imf::Header header_of(std::uint32_t width, std::uint32_t height, const ExrSamplePart& part) {
    const Imath::Box2i window({part.left, part.top}, {part.left + static_cast<int>(width) - 1, part.top + static_cast<int>(height) - 1});
    Imf::Header header(Imath::Box2i({0, 0}, {63, 63}), window);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [name, kind] : part.channels) header.channels().insert(name, Imf::Channel(type_of(kind)));
    if (part.tile_width > 0)
        header.setTileDescription({part.tile_width, part.tile_height, part.has_levels ? Imf::MIPMAP_LEVELS : Imf::ONE_LEVEL});
    if (!part.name.empty()) header.setName(part.name);
    return header;
}

/// The values as the library wants them: each channel for itself, in its own type.
class Planes {
  public:
    Planes(std::uint32_t width, std::uint32_t height, const ExrSamplePart& part) {
        const std::size_t pixels = std::size_t{width} * height, channels = part.channels.size();
        require(part.values.size() == pixels * channels);
        for (std::size_t c = 0; c < channels; ++c) {
            const auto& [name, kind] = part.channels[c];
            const std::size_t bytes = kind == ExrKind::half_float ? 2 : 4;
            Bytes& plane = planes_.emplace_back(pixels * bytes);
            for (std::size_t k = 0; k < pixels; ++k) {
                const float value = part.values[k * channels + c];
                if (kind == ExrKind::half_float) reinterpret_cast<Imath::half*>(plane.data())[k] = Imath::half(value);
                if (kind == ExrKind::float_32) reinterpret_cast<float*>(plane.data())[k] = value;
                if (kind == ExrKind::uint_32) reinterpret_cast<std::uint32_t*>(plane.data())[k] = static_cast<std::uint32_t>(value);
            }
            frame_.insert(name, Imf::Slice::Make(type_of(kind), plane.data(), {part.left, part.top}, width, height, bytes, bytes * width));
        }
    }
    [[nodiscard]] const Imf::FrameBuffer& frame() const { return frame_; }

  private:
    std::vector<Bytes> planes_;
    Imf::FrameBuffer frame_;
};

template <class File>
void write_tiles(File& file) {
    for (int level = 0; level < file.numLevels(); ++level)
        file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
}

}  // namespace

Bytes make_png(const PngSample& sample) {
    Bytes bytes;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, on_error, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(png, &bytes, on_write, [](png_structp) {});
    png_set_IHDR(png, info, sample.width, sample.height, sample.bits, type_of(sample.colour),
                 sample.is_interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    std::vector<png_color> palette;
    for (const auto& colour : sample.palette) palette.push_back({colour[0], colour[1], colour[2]});
    if (!palette.empty()) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
    set_transparency(png, info, sample);
    png_write_info(png, info);
    png_set_packing(png);
    Bytes packed;
    for (const std::uint16_t value : sample.samples) {
        if (sample.bits == 16) packed.push_back(static_cast<std::uint8_t>(value >> 8));
        packed.push_back(static_cast<std::uint8_t>(value));
    }
    const std::size_t row_bytes = packed.size() / sample.height;
    require(row_bytes * sample.height == packed.size() && row_bytes % sample.width == 0);
    std::vector<png_bytep> rows;
    for (std::size_t y = 0; y < sample.height; ++y) rows.push_back(packed.data() + y * row_bytes);
    png_write_image(png, rows.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return bytes;
}

Bytes make_jpeg(std::uint32_t width, std::uint32_t height, JpegColour colour, bool is_progressive,
                const std::vector<std::uint8_t>& samples) {
    const int format = colour == JpegColour::grey ? TJPF_GRAY : colour == JpegColour::cmyk ? TJPF_CMYK : TJPF_RGB;
    const int subsampling = colour == JpegColour::grey ? TJSAMP_GRAY : colour == JpegColour::halved ? TJSAMP_420 : TJSAMP_444;
    require(samples.size() == std::size_t{width} * height * static_cast<std::size_t>(tjPixelSize[format]));
    tjhandle encoder = tjInitCompress();
    unsigned char* encoded = nullptr;
    unsigned long size = 0;
    constexpr int quality = 90;
    require(tjCompress2(encoder, samples.data(), static_cast<int>(width), 0, static_cast<int>(height), format, &encoded, &size, subsampling,
                        quality, is_progressive ? TJFLAG_PROGRESSIVE : 0) == 0);
    Bytes bytes(encoded, encoded + size);
    tjFree(encoded);
    tjDestroy(encoder);
    return bytes;
}

Bytes make_exr(std::uint32_t width, std::uint32_t height, const std::vector<ExrSamplePart>& parts) {
    Imf::StdOSStream out;
    std::vector<Imf::Header> headers;
    std::vector<Planes> planes;
    for (const ExrSamplePart& part : parts) {
        headers.push_back(header_of(width, height, part));
        headers.back().setType(part.tile_width > 0 ? "tiledimage" : "scanlineimage");
        planes.emplace_back(width, height, part);
    }
    {
        Imf::MultiPartOutputFile file(out, headers.data(), static_cast<int>(headers.size()));
        for (std::size_t k = 0; k < parts.size(); ++k) {
            if (parts[k].tile_width > 0) {
                Imf::TiledOutputPart part(file, static_cast<int>(k));
                part.setFrameBuffer(planes[k].frame());
                write_tiles(part);
            } else {
                Imf::OutputPart part(file, static_cast<int>(k));
                part.setFrameBuffer(planes[k].frame());
                part.writePixels(static_cast<int>(height));
            }
        }
    }
    const std::string text = out.str();
    return {text.begin(), text.end()};
}

}  // namespace luxel::test
