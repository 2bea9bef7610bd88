#include "baker/patches/contact_texels.h"

namespace luxel {

ContactTexels::ContactTexels(const TexelSet& texels) {
    const std::size_t size = texels.page_size;
    for (std::size_t number = 0; number < texels.pages.size(); ++number)
        for (const Texel& texel : texels.pages[number].texels) {
            if (texel.joined_right && texel.joined_down) continue;
            if (pages_.empty()) pages_.assign(texels.pages.size(), std::vector<bool>(size * size));
            std::vector<bool>& page = pages_[number];
            const std::size_t place = texel.y * size + texel.x;
            // What is parted from something lies on the page, and so does that.
            page[place] = true;
            if (!texel.joined_right) page[place + 1] = true;
            if (!texel.joined_down) page[place + size] = true;
        }
}

std::uint64_t ContactTexels::resident_bytes() const {
    std::uint64_t bytes = 0;
    for (const std::vector<bool>& page : pages_) bytes += page.capacity() / 8;
    return bytes;
}

}  // namespace luxel
