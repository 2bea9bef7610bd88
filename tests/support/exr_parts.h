/// Reads OpenEXR files with several parts, for tests of what luxel writes: with OpenImageIO, not through
/// the project's own wrapper, which reads pictures of scenes only.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "formats/base/bytes.h"

namespace luxel::test {

struct ReadExrPart {
    std::string name;
    std::uint32_t width = 0, height = 0;
    std::vector<std::string> channels;
    std::string sample;                        ///< "float", "half" or "uint"
    std::map<std::string, std::string> texts;  ///< text attributes
    std::vector<float> floats;                 ///< interleaved, row 0 at the top; empty for uint
    std::vector<std::uint32_t> numbers;        ///< the same of uint
};

/// In the order of the file. Throws std::runtime_error.
std::vector<ReadExrPart> read_exr_parts(const Bytes& file);

}  // namespace luxel::test
