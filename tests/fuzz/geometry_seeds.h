/// Valid inputs of draco_fuzz and meshopt_fuzz: a bent grid in every mode of the two codecs.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "formats/base/bytes.h"

namespace luxel::fuzz {

/// Names and bytes, as the targets take them.
std::vector<std::pair<std::string, Bytes>> draco_seeds();
std::vector<std::pair<std::string, Bytes>> meshopt_seeds();

}  // namespace luxel::fuzz
