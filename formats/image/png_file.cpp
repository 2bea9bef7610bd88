#include "formats/image/png_file.h"

#include <png.h>

#include <array>
#include <csetjmp>
#include <cstring>

#include "formats/image/codec.h"

namespace luxel {
namespace {

/// What libpng said last; it prints nothing.
struct PngMessage {
    std::array<char, 160> text{};
};

[[noreturn]] void on_error(png_structp png, png_const_charp words) {
    auto& message = *static_cast<PngMessage*>(png_get_error_ptr(png));
    std::strncpy(message.text.data(), words, message.text.size() - 1);
    png_longjmp(png, 1);
}

/// What is wrong with chunks that decoders may drop is only a warning. Transparency is among them, and that would change the picture.
void on_warning(png_structp png, png_const_charp words) {
    if (std::strncmp(words, "tRNS", 4) == 0) png_error(png, words);
}

/// Runs a step of libpng, which leaves it by a jump when it fails: false. No step has anything on its way that must be destroyed.
bool succeeds(png_structp png, png_infop info, void (*step)(png_structp, png_infop, void*), void* data) {
    if (setjmp(png_jmpbuf(png))) return false;
    step(png, info, data);
    return true;
}

struct PngSource {
    const std::uint8_t* data;
    std::size_t left;
};

void on_read(png_structp png, png_bytep to, std::size_t count) {
    auto& source = *static_cast<PngSource*>(png_get_io_ptr(png));
    if (count > source.left) png_error(png, "the file ends too early");
    std::memcpy(to, source.data, count);
    source.data += count;
    source.left -= count;
}

class PngReader {
  public:
    explicit PngReader(ByteView bytes) : source_{bytes.data(), bytes.size()} {
        png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &message_, on_error, on_warning);
        if (png_) info_ = png_create_info_struct(png_);
        if (!info_) {
            png_destroy_read_struct(&png_, nullptr, nullptr);
            throw std::bad_alloc();
        }
        png_set_read_fn(png_, &source_, on_read);
    }
    ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    bool run(void (*step)(png_structp, png_infop, void*), void* data = nullptr) { return succeeds(png_, info_, step, data); }
    [[nodiscard]] std::string message() const { return message_.text.data(); }
    [[nodiscard]] std::int64_t width() const { return png_get_image_width(png_, info_); }
    [[nodiscard]] std::int64_t height() const { return png_get_image_height(png_, info_); }
    [[nodiscard]] bool has_16_bits() const { return png_get_bit_depth(png_, info_) == 16; }

  private:
    PngSource source_;
    PngMessage message_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
};

void read_head(png_structp png, png_infop info, void*) {
    // Also of chunks that may be dropped: their very name may be what is damaged.
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    // Chunks that say nothing of the stored values are passed over: texts and profiles may be compressed, and large when they are not.
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_read_info(png, info);
}

/// `rows`: png_bytep of each row.
void read_rows(png_structp png, png_infop info, void* rows) {
    png_set_expand(png);
    png_set_gray_to_rgb(png);
    png_set_add_alpha(png, png_get_bit_depth(png, info) == 16 ? 0xffff : 0xff, PNG_FILLER_AFTER);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    const std::size_t sample = png_get_bit_depth(png, info) == 16 ? 2 : 1;
    if (png_get_rowbytes(png, info) != png_get_image_width(png, info) * 4 * sample) png_error(png, "its rows are not RGBA");
    png_read_image(png, static_cast<png_bytepp>(rows));
    png_read_end(png, nullptr);
}

std::string decode_body(ByteView bytes, const ImageLimits& limits, ImagePixels& out) {
    PngReader reader(bytes);
    if (!reader.run(read_head)) return reader.message();
    if (std::string why = size_trouble(reader.width(), reader.height(), limits); !why.empty()) return why;
    const bool has_16_bits = reader.has_16_bits();
    allocate_pixels(out, reader.width(), reader.height());
    std::vector<png_bytep> rows(out.height);
    for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = packed_row(out, y);
    if (!reader.run(read_rows, rows.data())) return reader.message();
    has_16_bits ? unpack_rows<2>(out) : unpack_rows<1>(out);
    return {};
}

class PngWriter {
  public:
    explicit PngWriter(Bytes& sink) {
        png_ = png_create_write_struct(PNG_LIBPNG_VER_STRING, &message_, on_error, on_warning);
        if (png_) info_ = png_create_info_struct(png_);
        if (!info_) {
            png_destroy_write_struct(&png_, nullptr);
            throw std::bad_alloc();
        }
        png_set_write_fn(png_, &sink, on_write, [](png_structp) {});
    }
    ~PngWriter() { png_destroy_write_struct(&png_, &info_); }
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;

    bool run(void (*step)(png_structp, png_infop, void*), void* data) { return succeeds(png_, info_, step, data); }
    [[nodiscard]] std::string message() const { return message_.text.data(); }

  private:
    static void on_write(png_structp png, png_bytep from, std::size_t count) {
        if (!append(*static_cast<Bytes*>(png_get_io_ptr(png)), from, count)) png_error(png, "not enough memory");
    }
    /// An exception must not pass through libpng, nor a jump leave its handler.
    static bool append(Bytes& sink, const std::uint8_t* from, std::size_t count) {
        try {
            sink.insert(sink.end(), from, from + count);
            return true;
        } catch (const std::bad_alloc&) {
            return false;
        }
    }

    PngMessage message_;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
};

struct PngContents {
    PngSamples samples;
    std::vector<png_text> texts;
};

void write_all(png_structp png, png_infop info, void* data) {
    const auto& contents = *static_cast<const PngContents*>(data);
    const PngSamples& samples = contents.samples;
    png_set_IHDR(png, info, samples.width, samples.height, samples.bits, samples.channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(png, 6);
    png_set_text(png, info, contents.texts.data(), static_cast<int>(contents.texts.size()));
    png_write_info(png, info);
    if (samples.bits == 16) png_set_swap(png);  // the file has the high byte first
    const std::size_t row_bytes = std::size_t{samples.width} * static_cast<std::size_t>(samples.channels * samples.bits / 8);
    for (std::uint32_t y = 0; y < samples.height; ++y) png_write_row(png, samples.first + y * row_bytes);
    png_write_end(png, info);
}

}  // namespace

std::string decode_png(ByteView bytes, const ImageLimits& limits, ImagePixels& out) {
    return guarded([&] { return decode_body(bytes, limits, out); });
}

std::string write_png(const PngSamples& samples, const std::vector<std::pair<std::string, std::string>>& texts, Bytes& out) {
    return guarded([&]() -> std::string {
        PngContents contents{samples, {}};
        for (const auto& [name, text] : texts) {
            png_text chunk{};
            chunk.compression = PNG_TEXT_COMPRESSION_NONE;
            chunk.key = const_cast<png_charp>(name.c_str());  // libpng copies both
            chunk.text = const_cast<png_charp>(text.c_str());
            chunk.text_length = text.size();
            contents.texts.push_back(chunk);
        }
        PngWriter writer(out);
        return writer.run(write_all, &contents) ? "" : writer.message();
    });
}

}  // namespace luxel
