#include "tools/luxel/printable.h"

#include <fmt/format.h>

namespace luxel {

std::string printable(const std::string& text) {
    constexpr std::size_t most = 1000;
    std::string out;
    for (std::size_t k = 0; k < text.size(); ++k) {
        if (text.size() > most && k == most / 2) {
            out += " ... ";
            k = text.size() - most / 2;
        }
        const auto byte = static_cast<unsigned char>(text[k]);
        const auto next = static_cast<unsigned char>(k + 1 < text.size() ? text[k + 1] : 0);
        const bool is_c1 = byte == 0xc2 && next >= 0x80 && next < 0xa0;  // control characters of two bytes in UTF-8
        if (byte < 0x20 || byte == 0x7f || is_c1) out += fmt::format("\\x{:02x}", byte);
        else out.push_back(text[k]);
    }
    return out;
}

}  // namespace luxel
