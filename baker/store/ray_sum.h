/// Sums of rays as strips hold them: 32 bits, never wrapped around.
#pragma once
#include <cstdint>
#include <string>

#include "formats/base/error.h"

namespace luxel {

/// Adds; throws Error{damaged_store} naming `where` when the sum no longer fits.
inline void add_rays(std::uint32_t& sum, std::uint64_t rays, const std::string& where) {
    if (rays > 0xffffffffu - sum)
        throw Error(ErrorCode::damaged_store, where, "a patch or a pair has 2^32 rays or more, which strips cannot hold",
                    "bake with fewer --rays in a fresh bake folder");
    sum += static_cast<std::uint32_t>(rays);
}

}  // namespace luxel
