#include "formats/image/ktx2_file.h"

#include <algorithm>
#include <array>
#include <map>

#include "formats/base/compress.h"

namespace luxel {
namespace {

constexpr std::array<std::uint8_t, 12> identifier{0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb, '\r', '\n', 0x1a, '\n'};
constexpr std::uint32_t format_rgba_half = 97;  ///< VK_FORMAT_R16G16B16A16_SFLOAT
constexpr std::uint32_t scheme_zstd = 2;
constexpr std::uint32_t header_bytes = 80, level_index_bytes = 24;
constexpr int zstd_level = 12;  ///< halves of noise hardly get smaller with more, and slower they do

std::uint32_t padding(std::size_t size) { return static_cast<std::uint32_t>((4 - size % 4) % 4); }

/// One basic block for four channels of 16 bits.
Bytes format_descriptor() {
    constexpr std::uint32_t samples = 4, block_bytes = 24 + 16 * samples, total_bytes = 4 + block_bytes;
    constexpr std::uint32_t version = 2, model_rgbsda = 1, primaries_bt709 = 1, transfer_linear = 1;
    constexpr std::uint32_t texel_bytes = 8;
    ByteWriter out;
    out.put(total_bytes);
    out.put(std::uint32_t{0});  // vendor Khronos, type basic
    out.put(version | block_bytes << 16);
    out.put(model_rgbsda | primaries_bt709 << 8 | transfer_linear << 16);  // flags 0: alpha is straight
    out.put(std::uint32_t{0});  // a block is one texel
    out.put(texel_bytes);       // also where it is compressed: specification 2.0.4
    out.put(std::uint32_t{0});
    constexpr std::array<std::uint32_t, samples> channels{0, 1, 2, 15};  // R, G, B, A
    for (std::uint32_t k = 0; k < samples; ++k) {
        constexpr std::uint32_t bits = 16, is_signed = 0x40, is_float = 0x80;
        out.put(bits * k | (bits - 1) << 16 | (channels[k] | is_signed | is_float) << 24);
        out.put(std::uint32_t{0});  // at the place of the texel
        out.put(-1.0f);
        out.put(1.0f);
    }
    return out.take();
}

Bytes key_values(const std::vector<std::pair<std::string, std::string>>& texts) {
    std::map<std::string, std::string> entries;  // the specification wants them by key
    std::string writer = "luxel";
    for (const auto& [name, text] : texts) {
        if (name == "Software") writer = text;
        else entries[name] = text;
    }
    entries["KTXorientation"] = "rd";  // right, then down
    entries["KTXwriter"] = writer;
    ByteWriter out;
    for (const auto& [name, text] : entries) {
        std::string entry = name;
        entry += '\0';
        entry += text;
        entry += '\0';
        out.put(static_cast<std::uint32_t>(entry.size()));
        entry.append(padding(entry.size()), '\0');
        out.put_array(std::span<const char>(entry));
    }
    return out.take();
}

}  // namespace

Bytes write_ktx2(std::uint32_t width, std::uint32_t height, std::span<const std::uint16_t> rgba,
                 const std::vector<std::pair<std::string, std::string>>& texts) {
    const ByteView raw(reinterpret_cast<const std::uint8_t*>(rgba.data()), rgba.size_bytes());
    const Bytes descriptor = format_descriptor(), values = key_values(texts), level = compress(raw, zstd_level);
    const auto descriptor_at = header_bytes + level_index_bytes;
    const auto values_at = descriptor_at + static_cast<std::uint32_t>(descriptor.size());
    ByteWriter out;
    out.put_array(std::span<const std::uint8_t>(identifier));
    // Format, bytes of a sample, size, no depth, no array, one face, one level, scheme.
    for (const std::uint32_t number : {format_rgba_half, 2u, width, height, 0u, 0u, 1u, 1u, scheme_zstd}) out.put(number);
    for (const std::uint32_t number : {descriptor_at, static_cast<std::uint32_t>(descriptor.size()), values_at,
                                       static_cast<std::uint32_t>(values.size())})
        out.put(number);
    for (int k = 0; k < 2; ++k) out.put(std::uint64_t{0});  // no global data
    out.put(std::uint64_t{values_at + values.size()});
    out.put(std::uint64_t{level.size()});
    out.put(std::uint64_t{raw.size()});
    for (const Bytes* part : {&descriptor, &values, &level}) out.put_array(std::span<const std::uint8_t>(*part));
    return out.take();
}

}  // namespace luxel
