#include "baker/patches/texels.h"

namespace luxel {

std::uint64_t TexelSet::texel_count() const {
    std::uint64_t count = 0;
    for (const PageTexels& page : pages) count += page.texels.size();
    return count;
}

std::uint64_t TexelSet::resident_bytes() const {
    std::uint64_t bytes = pages.capacity() * sizeof(PageTexels);
    for (const PageTexels& page : pages)
        bytes += page.texels.capacity() * sizeof(Texel) + page.fragments.capacity() * sizeof(Fragment);
    return bytes;
}

}  // namespace luxel
