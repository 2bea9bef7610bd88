#include "formats/image/exr_file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include "formats/image/codec.h"
#include "formats/image/exr_check.h"
#include "formats/image/exr_source.h"

namespace luxel {
namespace {

class MemorySink : public Imf::OStream {
  public:
    MemorySink() : OStream("memory") {}
    void write(const char from[], int count) override {
        const auto added = static_cast<std::size_t>(count);
        if (at_ + added > bytes_.size()) {
            // Twice as large whenever it is full: resize() alone may add no more than it is asked for.
            if (at_ + added > bytes_.capacity()) bytes_.reserve(std::max(at_ + added, 2 * bytes_.capacity()));
            bytes_.resize(at_ + added);
        }
        std::memcpy(bytes_.data() + at_, from, added);
        at_ += added;
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t at) override { at_ = at; }
    Bytes take() { return std::move(bytes_); }

  private:
    Bytes bytes_;
    std::size_t at_ = 0;
};

// --- reading -----------------------------------------------------------------------------------------------------

struct NamedChannel {
    std::string name;
    bool is_whole_number;
};

/// By layer, the part of the name before the last dot, and in it by use; the file has them in the order of the alphabet.
std::vector<NamedChannel> channels_in_order(const Imf::ChannelList& list) {
    std::vector<NamedChannel> channels;
    for (auto at = list.begin(); at != list.end(); ++at) channels.push_back({at.name(), at.channel().type == Imf::UINT});
    const auto place = [](const NamedChannel& channel) {
        const auto dot = channel.name.rfind('.');
        std::string layer = dot == std::string::npos ? "" : channel.name.substr(0, dot);
        std::string use = dot == std::string::npos ? channel.name : channel.name.substr(dot + 1);
        for (char& letter : use) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
        constexpr std::string_view uses[]{"R", "RED", "G", "GREEN", "B", "BLUE", "X", "Y"};
        const auto rank = std::find(std::begin(uses), std::end(uses), use) - std::begin(uses);
        return std::tuple(std::move(layer), rank, use == "A" || use == "ALPHA");
    };
    std::stable_sort(channels.begin(), channels.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
    return channels;
}

/// Which channel is red, green, blue, alpha: places in `channels`; alpha -1: none.
std::array<int, 4> choose(const std::vector<NamedChannel>& channels) {
    const auto find = [&](const char* name) {
        const auto at = std::find_if(channels.begin(), channels.end(), [&](const auto& channel) { return channel.name == name; });
        return at == channels.end() ? -1 : static_cast<int>(at - channels.begin());
    };
    const int red = find("R"), green = find("G"), blue = find("B"), alpha = find("A");
    if (channels.size() < 3) return {0, 0, 0, alpha};
    if (red >= 0 && green >= 0 && blue >= 0) return {red, green, blue, alpha};
    return {0, 1, 2, alpha};
}

std::optional<std::string> decode_body(ByteView bytes, const ImageLimits& limits, ImagePixels& out) {
    if (std::string why = exr_trouble(bytes, limits); !why.empty()) return why;
    MemorySource source(bytes);
    Imf::InputFile file(source, no_threads);
    const Imf::ChannelList& list = file.header().channels();
    for (auto at = list.begin(); at != list.end(); ++at)
        if (at.channel().xSampling != 1 || at.channel().ySampling != 1) return std::nullopt;
    const std::vector<NamedChannel> channels = channels_in_order(list);
    if (channels.empty()) return "it has no channels";
    const std::array<int, 4> chosen = choose(channels);

    const Imath::Box2i window = file.header().dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1, height = std::int64_t{window.max.y} - window.min.y + 1;
    if (std::string why = size_trouble(width, height, limits); !why.empty()) return why;
    allocate_pixels(out, width, height);
    out.is_float = std::any_of(channels.begin(), channels.end(), [](const auto& channel) { return !channel.is_whole_number; });
    // Straight into the result, each channel of the file once, whichever colours it is for.
    std::vector<int> read;
    Imf::FrameBuffer target;
    for (const int channel : chosen) {
        if (channel < 0 || std::find(read.begin(), read.end(), channel) != read.end()) continue;
        constexpr std::size_t pixel_bytes = sizeof out.pixels[0];
        target.insert(channels[static_cast<std::size_t>(channel)].name,
                      Imf::Slice::Make(Imf::FLOAT, &out.pixels[0][read.size()], window, pixel_bytes, pixel_bytes * out.width));
        read.push_back(channel);
    }
    file.setFrameBuffer(target);
    file.readPixels(window.min.y, window.max.y);

    std::array<std::size_t, 4> slot{};
    std::array<float, 4> scale{1, 1, 1, 1};
    for (std::size_t c = 0; c < 4; ++c) {
        if (chosen[c] < 0) continue;
        slot[c] = static_cast<std::size_t>(std::find(read.begin(), read.end(), chosen[c]) - read.begin());
        if (channels[static_cast<std::size_t>(chosen[c])].is_whole_number) scale[c] = 1.0f / 4294967295.0f;
    }
    for (auto& pixel : out.pixels) {
        const std::array<float, 4> found = pixel;
        for (std::size_t c = 0; c < 4; ++c) pixel[c] = chosen[c] < 0 ? 1.0f : found[slot[c]] * scale[c];
    }
    return "";
}

// --- writing -----------------------------------------------------------------------------------------------------

Imf::PixelType type_of(ExrSample sample) {
    if (sample == ExrSample::uint_32) return Imf::UINT;
    return sample == ExrSample::half_float ? Imf::HALF : Imf::FLOAT;
}

Imf::Header header_of(std::uint32_t width, std::uint32_t height, const ExrPart& part) {
    Imf::Header header(static_cast<int>(width), static_cast<int>(height));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const std::string& channel : part.channels) header.channels().insert(channel, Imf::Channel(type_of(part.sample)));
    const auto put = [&](const std::string& name, const std::string& text) { header.insert(name, Imf::StringAttribute(text)); };
    Imf::addCapDate(header, "1970:01:01 00:00:00");  // what programs show as DateTime
    put("quantity", part.metadata.quantity);
    put("unit", part.metadata.unit);
    put("encoding", part.metadata.encoding);
    put("Software", part.metadata.software);
    for (const auto& [name, text] : part.metadata.more) put(name, text);
    header.insert("intensity", Imf::FloatAttribute(static_cast<float>(part.metadata.intensity)));
    if (!part.name.empty()) header.setName(part.name);
    return header;
}

template <class Output>
void write_pixels(Output& file, std::uint32_t width, std::uint32_t height, const ExrPart& part, const void* samples) {
    const std::size_t channels = part.channels.size(), row_samples = channels * width;
    // The library takes samples of the kind that it stores. Halves are made a row at a time, all rows in the same place.
    const bool as_halves = part.sample == ExrSample::half_float;
    std::vector<Imath::half> row(as_halves ? row_samples : 0);
    const std::size_t sample_bytes = as_halves ? sizeof(Imath::half) : sizeof(float);
    char* base = as_halves ? reinterpret_cast<char*>(row.data()) : static_cast<char*>(const_cast<void*>(samples));
    Imf::FrameBuffer source;
    for (std::size_t c = 0; c < channels; ++c)
        source.insert(part.channels[c], Imf::Slice(type_of(part.sample), base + c * sample_bytes, channels * sample_bytes,
                                                   as_halves ? 0 : row_samples * sample_bytes));
    file.setFrameBuffer(source);
    if (!as_halves) {
        file.writePixels(static_cast<int>(height));
        return;
    }
    const auto* floats = static_cast<const float*>(samples);
    for (std::uint32_t y = 0; y < height; ++y) {
        std::transform(floats + y * row_samples, floats + (y + 1) * row_samples, row.begin(),
                       [](float value) { return Imath::half(value); });
        file.writePixels(1);
    }
}

}  // namespace

std::optional<std::string> decode_exr(ByteView bytes, const ImageLimits& limits, ImagePixels& out) {
    return guarded([&] { return decode_body(bytes, limits, out); });
}

struct ExrWriter::State {
    std::uint32_t width, height;
    std::vector<ExrPart> parts;
    MemorySink sink;
    std::unique_ptr<Imf::OutputFile> alone;  ///< of a file with one part, an ordinary one
    std::unique_ptr<Imf::MultiPartOutputFile> several;
};

ExrWriter::ExrWriter(std::uint32_t width, std::uint32_t height, std::span<const ExrPart> parts)
    : state_(new State{width, height, {parts.begin(), parts.end()}, {}, nullptr, nullptr}) {
    std::vector<Imf::Header> headers;
    for (const ExrPart& part : parts) headers.push_back(header_of(width, height, part));
    if (parts.size() == 1) {
        state_->alone = std::make_unique<Imf::OutputFile>(state_->sink, headers[0], no_threads);
        return;
    }
    for (Imf::Header& header : headers) header.setType("scanlineimage");
    constexpr bool replaces_shared_attributes = false;
    state_->several = std::make_unique<Imf::MultiPartOutputFile>(state_->sink, headers.data(), static_cast<int>(headers.size()),
                                                                 replaces_shared_attributes, no_threads);
}

ExrWriter::~ExrWriter() = default;

void ExrWriter::write(std::size_t number, const void* samples) {
    const ExrPart& part = state_->parts[number];
    if (state_->alone) {
        write_pixels(*state_->alone, state_->width, state_->height, part, samples);
        return;
    }
    Imf::OutputPart file(*state_->several, static_cast<int>(number));
    write_pixels(file, state_->width, state_->height, part, samples);
}

Bytes ExrWriter::finish() {
    // Their ends write the tables of offsets.
    state_->alone.reset();
    state_->several.reset();
    return state_->sink.take();
}

}  // namespace luxel
