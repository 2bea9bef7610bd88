#include "baker/sweep/base64.h"

#include <cstdint>

namespace luxel {
namespace {

constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

std::string base64(std::string_view bytes) {
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t at = 0; at < bytes.size(); at += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (at + k < bytes.size() ? static_cast<std::uint8_t>(bytes[at + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += at + k <= bytes.size() ? digits[group >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::optional<std::string> from_base64(std::string_view text) {
    if (text.size() % 4 != 0) return {};
    std::string bytes;
    for (std::size_t at = 0; at < text.size(); at += 4) {
        std::string_view four = text.substr(at, 4);
        if (at + 4 == text.size())
            while (four.size() > 2 && four.ends_with('=')) four.remove_suffix(1);
        std::uint32_t group = 0;
        for (const char letter : four) {
            const auto digit = digits.find(letter);
            if (digit == std::string_view::npos) return {};
            group = group << 6 | static_cast<std::uint32_t>(digit);
        }
        group <<= 6 * (4 - four.size());
        for (std::size_t k = 0; k + 1 < four.size(); ++k) bytes += static_cast<char>(group >> (16 - 8 * k) & 255);
    }
    if (base64(bytes) != text) return {};  // bits that nothing stands for
    return bytes;
}

}  // namespace luxel
