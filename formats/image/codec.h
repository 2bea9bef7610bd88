/// What the readers and writers of all kinds of pictures share. Private to this folder.
///
/// A reader returns an empty text, or why it failed; some return nothing where the picture is of a sort that only the module
/// reads. Exceptions of libraries end inside.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "formats/image/image_file.h"

namespace luxel {

/// Runs `body`, and turns whatever it throws into text.
template <class Body>
auto guarded(const Body& body) -> decltype(body()) {
    try {
        return body();
    } catch (const std::bad_alloc&) {
        return "not enough memory";
    } catch (const std::exception& error) {
        return error.what();
    } catch (...) {
        return "unknown failure of the library";
    }
}

/// Empty text, or why a picture of this size is refused. Asked before anything is allocated for it.
inline std::string size_trouble(std::int64_t width, std::int64_t height, const ImageLimits& limits) {
    if (width < 1 || height < 1) return "it has no pixels";
    const auto columns = static_cast<std::uint64_t>(width), rows = static_cast<std::uint64_t>(height);
    // Sides of 2^32 and more are gone before they are multiplied.
    if (columns > limits.max_side || rows > limits.max_side || columns * rows > limits.max_pixels)
        return "expected at most " + std::to_string(limits.max_side) + " pixels a side and " + std::to_string(limits.max_pixels) +
               " in all, found " + std::to_string(width) + " x " + std::to_string(height);
    return {};
}

inline void allocate_pixels(ImagePixels& image, std::int64_t width, std::int64_t height) {
    image.width = static_cast<std::uint32_t>(width);
    image.height = static_cast<std::uint32_t>(height);
    image.pixels.resize(std::size_t{image.width} * image.height);
}

/// Where a decoder of integers puts row `y`, as RGBA of 1 or 2 bytes each, high byte first: into the memory of the result, so
/// that no second copy of the picture is held.
inline std::uint8_t* packed_row(ImagePixels& image, std::size_t y) {
    return reinterpret_cast<std::uint8_t*>(image.pixels.data() + y * image.width);
}

/// Spreads the packed rows to floats where they are, each by way of a copy.
template <std::size_t bytes_per_sample>
void unpack_rows(ImagePixels& image) {
    constexpr float scale = bytes_per_sample == 1 ? 1.0f / 255.0f : 1.0f / 65535.0f;
    std::vector<std::uint8_t> packed(std::size_t{image.width} * 4 * bytes_per_sample);
    for (std::size_t y = 0; y < image.height; ++y) {
        std::memcpy(packed.data(), packed_row(image, y), packed.size());
        const std::uint8_t* from = packed.data();
        for (std::size_t x = 0; x < image.width; ++x)
            for (float& sample : image.pixels[y * image.width + x]) {
                const unsigned value = bytes_per_sample == 1 ? from[0] : unsigned{from[0]} << 8 | from[bytes_per_sample - 1];
                sample = static_cast<float>(value) * scale;
                from += bytes_per_sample;
            }
    }
}

}  // namespace luxel
