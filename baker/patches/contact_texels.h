/// Texels that something stands beside or on: parted from a neighbour (trace/texel_joints.h). Within one the light changes from one
/// side of what stands there to the other, and rays see more of the brighter side, because they come from where its light does. So
/// one value for all of it, though right for the lightmap, is not what a ray should read there.
///
/// Stored   one bit per texel of every page, if there are any at all.
/// Threads  const and reentrant once made. Errors: none.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/patches/texels.h"

namespace luxel {

class ContactTexels {
  public:
    ContactTexels() = default;
    /// Of texels whose joints are known.
    explicit ContactTexels(const TexelSet& texels);

    /// `place`: y * page size + x.
    [[nodiscard]] bool holds(std::uint32_t page, std::size_t place) const { return !pages_.empty() && pages_[page][place]; }
    [[nodiscard]] std::uint64_t resident_bytes() const;

  private:
    std::vector<std::vector<bool>> pages_;
};

}  // namespace luxel
