#include "tests/support/exr_parts.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <stdexcept>

namespace luxel::test {

std::vector<ReadExrPart> read_exr_parts(const Bytes& file) {
    OIIO::Filesystem::IOMemReader source(const_cast<std::uint8_t*>(file.data()), file.size());
    const auto input = OIIO::ImageInput::open("memory.exr", nullptr, &source);
    if (!input) throw std::runtime_error("no OpenEXR file: " + OIIO::geterror());
    std::vector<ReadExrPart> parts;
    for (int number = 0; input->seek_subimage(number, 0); ++number) {
        const OIIO::ImageSpec spec = input->spec(number);
        ReadExrPart& part = parts.emplace_back();
        part.name = spec.get_string_attribute("oiio:subimagename");
        part.width = static_cast<std::uint32_t>(spec.width);
        part.height = static_cast<std::uint32_t>(spec.height);
        part.channels = spec.channelnames;
        for (const OIIO::ParamValue& attribute : spec.extra_attribs)
            if (attribute.type() == OIIO::TypeString) part.texts[attribute.name().string()] = attribute.get_string();
        const std::size_t count = std::size_t{part.width} * part.height * part.channels.size();
        const bool is_whole_number = spec.format == OIIO::TypeUInt32;
        part.sample = is_whole_number ? "uint" : spec.format == OIIO::TypeHalf ? "half" : "float";
        if (is_whole_number)
            part.numbers.resize(count);
        else
            part.floats.resize(count);
        void* to = is_whole_number ? static_cast<void*>(part.numbers.data()) : part.floats.data();
        if (!input->read_image(number, 0, 0, spec.nchannels, is_whole_number ? OIIO::TypeUInt32 : OIIO::TypeFloat, to))
            throw std::runtime_error("part " + part.name + ": " + input->geterror());
    }
    return parts;
}

}  // namespace luxel::test
