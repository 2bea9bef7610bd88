/// Groups things by a fixed grid of halvings of space: the lines are multiples of powers of two in metres around the
/// scene's origin, so what moves changes the groups that it leaves and enters, and no others. Pure and deterministic.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "baker/core/vec.h"

namespace luxel {

/// `places` in m and `sizes` (> 0) of all things; `members` are the ones to group. A box is halved across its longest
/// edge while its members' sizes sum to more than `limit`. Returns groups of at most `limit`, low half before high
/// half, members in the order given; a single thing larger than `limit` is a group of its own. Things that no halving
/// tells apart are grouped in their order.
std::vector<std::vector<std::uint32_t>> halve_space(std::span<const Vec3d> places, std::span<const std::uint32_t> sizes,
                                                    std::vector<std::uint32_t> members, std::uint32_t limit);

}  // namespace luxel
