/// Any bytes as a buffer view compressed with meshopt: the first four say mode, filter, stride and count, the rest is the stream. The decoded view
/// has the size that was promised, or it is refused as bad input.
#include <array>
#include <cstddef>
#include <cstdlib>

#include "formats/gltf/gltf_compression.h"

namespace {

void require(bool holds) {
    if (!holds) std::abort();
}

constexpr std::array<const char*, 4> modes{"ATTRIBUTES", "TRIANGLES", "INDICES", "OTHER"};
constexpr std::array<const char*, 5> filters{"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "OTHER"};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace luxel;
    if (size < 4) return 0;
    GltfDocument document;
    document.name = "fuzz";
    document.buffers.emplace_back(data + 4, data + size);
    const std::uint64_t stride = data[1], count = data[2] + std::uint64_t{256} * data[3];
    const nlohmann::json extension = {{"buffer", 0}, {"byteLength", size - 4}, {"byteStride", stride}, {"count", count},
                                      {"mode", modes[data[0] % 4]}, {"filter", filters[data[0] / 4 % 5]}};
    try {
        require(decode_meshopt_view(document, extension, "fuzz").size() == stride * count);
    } catch (const Error& error) {
        require(error.code == ErrorCode::bad_input);
    }
    return 0;
}
