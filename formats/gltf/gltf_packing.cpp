#include "formats/gltf/gltf_packing.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <string_view>

#include "formats/base/error.h"
#include "formats/gltf/gltf_encode.h"

namespace luxel {

namespace {

struct BitsPart {
    const char* name;
    int DracoBits::*bits;
    int least;  ///< an octahedron needs 2
    bool may_be_auto;
};
constexpr std::array<BitsPart, 6> parts{{{"POSITION", &DracoBits::position, 1, false},
                                         {"NORMAL", &DracoBits::normal, 2, false},
                                         {"TEXCOORD", &DracoBits::texcoord, 1, false},
                                         {"COLOR", &DracoBits::color, 1, false},
                                         {"LIGHTMAP", &DracoBits::lightmap, 1, true},
                                         {"OTHER", &DracoBits::other, 1, false}}};

int parse_bits(std::string_view value, const BitsPart& part, const std::string& where) {
    if (part.may_be_auto && value == "auto") return 0;
    int bits = 0;
    const auto [end, problem] = std::from_chars(value.data(), value.data() + value.size(), bits);
    const bool is_number = problem == std::errc() && end == value.data() + value.size();
    if (!is_number || bits < part.least || bits > most_draco_bits)
        throw Error(ErrorCode::usage, where,
                    std::string(part.name) + ": expected " + std::to_string(part.least) + " to " + std::to_string(most_draco_bits) +
                        (part.may_be_auto ? " or auto" : "") + ", found \"" + std::string(value) + "\"",
                    "more bits are more exact, and larger");
    return bits;
}

}  // namespace

DracoBits parse_draco_bits(const std::string& list, const std::string& where) {
    DracoBits found;
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        const std::string part = list.substr(begin, end - begin);
        const std::size_t equals = std::min(part.find('='), part.size());
        const std::string name = part.substr(0, equals);
        const auto* known = std::find_if(parts.begin(), parts.end(), [&](const BitsPart& one) { return one.name == name; });
        if (known == parts.end() || equals == part.size())
            throw Error(ErrorCode::usage, where,
                        "expected PART=BITS with POSITION, NORMAL, TEXCOORD, COLOR, LIGHTMAP or OTHER, found \"" + part + "\"",
                        "for example POSITION=12,TEXCOORD=11");
        found.*(known->bits) = parse_bits(std::string_view(part).substr(equals + 1), *known, where);
        begin = end + 1;
    }
    return found;
}

std::string draco_bits_text(const DracoBits& bits) {
    std::string text;
    for (const BitsPart& part : parts) {
        const int value = bits.*(part.bits);
        text += std::string(text.empty() ? "" : ",") + part.name + "=" + (value ? std::to_string(value) : "auto");
    }
    return text;
}

int lightmap_bits(const DracoBits& bits, std::uint32_t page_size) {
    constexpr int subtexel_bits = 5;
    if (bits.lightmap) return bits.lightmap;
    return std::min(most_draco_bits, static_cast<int>(std::bit_width(std::max(page_size, 1u) - 1)) + subtexel_bits);
}

}  // namespace luxel
