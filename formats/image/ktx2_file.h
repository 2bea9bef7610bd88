/// Writes KTX 2.0 (.ktx2) with one picture of half floats. Private to this folder; ktx2_file.md is the format.
///
/// Threads  pure. The same input and version of zstd give the same bytes.
/// Source   Khronos, KTX File Format Specification, version 2.0; Khronos Data Format Specification 1.3, section 5.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "formats/base/bytes.h"

namespace luxel {

/// encode_ktx2() of image_file.h; `texts` become entries of the key/value data.
Bytes write_ktx2(std::uint32_t width, std::uint32_t height, std::span<const std::uint16_t> rgba,
                 const std::vector<std::pair<std::string, std::string>>& texts);

}  // namespace luxel
