/// Changes to glTF files that keep their form: a tree of JSON stays one, and a GLB container keeps its lengths right.
/// Bytes that are changed at random hardly ever get past the parser.
#pragma once
#include <cstddef>
#include <cstdint>

#include "formats/base/bytes.h"

namespace luxel::fuzz {

/// Changes bytes in place, not beyond `room`; returns the new size.
using ByteMutator = std::size_t (*)(std::uint8_t* data, std::size_t size, std::size_t room);

/// A changed file of at most `room` bytes; empty if `input` is no glTF file of either form. Pure but for `mutate`.
Bytes mutate_gltf(ByteView input, std::size_t room, std::uint32_t seed, ByteMutator mutate);

}  // namespace luxel::fuzz
