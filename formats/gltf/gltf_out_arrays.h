/// Adds arrays to the model: accessor and buffer view, equal ones only once. Private to the gltf_out files.
#pragma once
#include <map>
#include <span>
#include <utility>

#include "formats/base/hash.h"
#include "formats/gltf/gltf_accessor.h"
#include "formats/gltf/gltf_out_model.h"

namespace luxel {

enum class ArrayUse { vertices, indices, other };

class ArrayStore {
  public:
    explicit ArrayStore(OutputModel& model) : model_(model) {}

    /// Index of an accessor with these elements. `like` (or null) is the accessor they came from: its name, extras and
    /// extensions are kept, and its bounds are computed anew; `bounds` asks for them in any case.
    /// Vertex arrays are laid out with elements at multiples of 4 bytes.
    std::uint64_t add(const AccessorBytes& elements, ArrayUse use, const nlohmann::json* like, bool bounds);

    /// 16 bits where they reach, else 32.
    std::uint64_t add_indices(std::span<const std::uint32_t> indices, std::size_t vertex_count,
                              const nlohmann::json* like);

  private:
    OutputModel& model_;
    std::map<std::pair<std::uint64_t, std::uint64_t>, std::uint64_t> views_, accessors_;  ///< by Key
};

/// Sets min and max of an accessor; numbers that are not finite do not count.
void set_bounds(const AccessorBytes& elements, nlohmann::json& accessor);

/// Elements `chosen` of an array, in that order.
AccessorBytes gather_elements(const AccessorBytes& elements, std::span<const std::uint32_t> chosen);

}  // namespace luxel
