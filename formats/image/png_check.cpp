#include "formats/image/png_check.h"

#include <array>

namespace luxel {
namespace {

constexpr std::array<std::uint32_t, 256> crc_table = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t n = 0; n < 256; ++n) {
        std::uint32_t c = n;
        for (int bit = 0; bit < 8; ++bit) c = (c & 1) ? 0xedb88320u ^ (c >> 1) : c >> 1;
        table[n] = c;
    }
    return table;
}();

std::uint32_t crc(ByteView bytes) {
    std::uint32_t c = 0xffffffffu;
    for (const std::uint8_t byte : bytes) c = crc_table[(c ^ byte) & 0xff] ^ (c >> 8);
    return ~c;
}

std::uint32_t big_endian(ByteView bytes, std::size_t at) {
    return (std::uint32_t{bytes[at]} << 24) | (std::uint32_t{bytes[at + 1]} << 16) |
           (std::uint32_t{bytes[at + 2]} << 8) | bytes[at + 3];
}

bool is_letter(std::uint8_t c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

}  // namespace

std::string png_damage(ByteView bytes) {
    constexpr std::size_t signature_bytes = 8, frame_bytes = 12, header_bytes = 13;  // frame: length, type, CRC
    bool has_header = false, has_pixels = false;
    for (std::size_t at = signature_bytes; at < bytes.size();) {
        const std::string here = " at byte " + std::to_string(at);
        if (bytes.size() - at < frame_bytes) return "the file ends inside a chunk" + here;
        const std::size_t length = big_endian(bytes, at);
        for (std::size_t k = 4; k < 8; ++k)
            if (!is_letter(bytes[at + k])) return "expected a chunk name" + here;
        const std::string type(bytes.begin() + static_cast<std::ptrdiff_t>(at + 4),
                               bytes.begin() + static_cast<std::ptrdiff_t>(at + 8));
        if (length > bytes.size() - at - frame_bytes) return "the file ends inside chunk " + type + here;
        // Small letter first: an ancillary chunk, which decoders may drop. Its damage costs no pixel.
        const bool is_critical = type[0] < 'a';
        if (is_critical && crc(bytes.subspan(at + 4, length + 4)) != big_endian(bytes, at + 8 + length))
            return "checksum mismatch in chunk " + type + here;
        if (!has_header && (type != "IHDR" || length != header_bytes)) return "expected chunk IHDR" + here;
        has_header = true;
        if (type == "IDAT") has_pixels = true;
        if (type == "IEND") return has_pixels ? "" : "it has no pixels";
        at += frame_bytes + length;
    }
    return "the file ends before chunk IEND";
}

}  // namespace luxel
