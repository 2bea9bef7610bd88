/// OpenEXR, with its own library. Private to this folder.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/image/image_file.h"

namespace luxel {

/// The first part, scan lines or tiles (the largest level), wherever its data window lies. Channels R, G and B by name, else the
/// first three, those called R, G, B in their layer first; of fewer than three the first one; alpha is A. Nothing: channels of fewer
/// pixels than the picture (luminance and chroma), a matter for the module.
std::optional<std::string> decode_exr(ByteView bytes, const ImageLimits& limits, ImagePixels& out);

/// encode_exr_parts() of image_file.h, part by part: construct, write() once for each in order, finish(). The calls throw whatever
/// the library throws, never luxel::Error.
class ExrWriter {
  public:
    ExrWriter(std::uint32_t width, std::uint32_t height, std::span<const ExrPart> parts);
    ~ExrWriter();
    ExrWriter(const ExrWriter&) = delete;
    ExrWriter& operator=(const ExrWriter&) = delete;

    /// `samples`: interleaved float, or std::uint32_t where the part is uint_32.
    void write(std::size_t part, const void* samples);
    Bytes finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace luxel
