#include "formats/image/exr_part.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>

#include "formats/base/error.h"
#include "formats/image/codec.h"
#include "formats/image/exr_check.h"
#include "formats/image/exr_source.h"

namespace luxel {
namespace {

/// What a layer may have: memory is asked for by size of the picture and channels.
constexpr std::size_t most_channels = 16;

/// The number of the part `name`; throws what there is instead.
int find_part(const Imf::MultiPartInputFile& file, const std::string& name) {
    std::string known;
    for (int part = 0; part < file.parts(); ++part) {
        const std::string found = file.header(part).hasName() ? file.header(part).name() : "";
        if (found == name) return part;
        known += (known.empty() ? "" : ", ") + (found.empty() ? "one without a name" : found);
    }
    throw std::runtime_error("expected a part \"" + name + "\", found " + known);
}

template <class Sample>
std::vector<Sample> read_samples(Imf::InputPart& part, Imf::PixelType type, const Imath::Box2i& window, const DecodedExrPart& head) {
    const std::size_t pixel_bytes = head.channels.size() * sizeof(Sample);
    std::vector<Sample> samples(std::size_t{head.width} * head.height * head.channels.size());
    Imf::FrameBuffer target;
    for (std::size_t c = 0; c < head.channels.size(); ++c)
        target.insert(head.channels[c], Imf::Slice::Make(type, &samples[c], window, pixel_bytes, pixel_bytes * head.width));
    part.setFrameBuffer(target);
    part.readPixels(window.min.y, window.max.y);
    return samples;
}

/// Empty text, or why not.
std::string decode_body(ByteView bytes, const std::string& name, const ImageLimits& limits, DecodedExrPart& out) {
    if (std::string why = exr_trouble(bytes, limits); !why.empty()) return why;
    MemorySource source(bytes);
    Imf::MultiPartInputFile file(source, no_threads);
    const int number = find_part(file, name);
    const Imf::Header& header = file.header(number);
    const Imath::Box2i window = header.dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1, height = std::int64_t{window.max.y} - window.min.y + 1;
    if (std::string why = size_trouble(width, height, limits); !why.empty()) return why;
    bool whole_numbers = true;
    const Imf::ChannelList& list = header.channels();
    for (auto at = list.begin(); at != list.end(); ++at) {
        if (at.channel().xSampling != 1 || at.channel().ySampling != 1) return "a channel has fewer pixels than the picture";
        whole_numbers &= at.channel().type == Imf::UINT;
        out.channels.emplace_back(at.name());
    }
    if (out.channels.empty() || out.channels.size() > most_channels)
        return "expected 1 to " + std::to_string(most_channels) + " channels, found " + std::to_string(out.channels.size());
    out.width = static_cast<std::uint32_t>(width);
    out.height = static_cast<std::uint32_t>(height);
    Imf::InputPart part(file, number);
    if (whole_numbers) out.values = read_samples<std::uint32_t>(part, Imf::UINT, window, out);
    else out.values = read_samples<float>(part, Imf::FLOAT, window, out);
    return "";
}

}  // namespace

DecodedExrPart decode_exr_part(ByteView bytes, const std::string& name, const std::string& where, const ImageLimits& limits) {
    DecodedExrPart part;
    const std::string why = guarded([&] { return decode_body(bytes, name, limits, part); });
    if (!why.empty())
        throw Error(ErrorCode::bad_input, where, "cannot decode as OpenEXR: " + why, "write the file again");
    return part;
}

}  // namespace luxel
