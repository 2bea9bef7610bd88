#include "tools/luxel/size_option.h"

#include "formats/base/error.h"

namespace luxel {

std::uint64_t parse_bytes(const std::string& text, const std::string& option) {
    const auto refuse = [&] {
        return Error(ErrorCode::usage, option, "expected a size such as 512M or 4G, found \"" + text + "\"");
    };
    std::size_t digits = 0;
    while (digits < text.size() && text[digits] >= '0' && text[digits] <= '9') ++digits;
    if (digits == 0 || digits > 12 || text.size() > digits + 1) throw refuse();
    const std::uint64_t bytes = std::stoull(text.substr(0, digits));
    int shift = 0;
    if (text.size() == digits + 1) switch (text[digits]) {
            case 'K': case 'k': shift = 10; break;
            case 'M': case 'm': shift = 20; break;
            case 'G': case 'g': shift = 30; break;
            default: throw refuse();
        }
    if (bytes >> (63 - shift)) throw refuse();
    return bytes << shift;
}

}  // namespace luxel
