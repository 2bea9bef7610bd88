/// Small valid glTF files, as GLB, that together use everything that the reader knows.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "formats/base/bytes.h"

namespace luxel::fuzz {

/// Names and bytes.
std::vector<std::pair<std::string, Bytes>> gltf_seeds();

}  // namespace luxel::fuzz
