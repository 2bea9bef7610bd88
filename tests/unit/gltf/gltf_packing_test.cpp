// The command line's words for Draco's bits.
#include "formats/gltf/gltf_packing.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"

namespace luxel {
namespace {

std::string refusal(const std::string& list) {
    try {
        (void)parse_draco_bits(list, "--draco-bits");
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::usage);
        return error.what();
    }
    return "";
}

TEST(DracoBits, AnySubsetIsTaken) {
    const DracoBits bits = parse_draco_bits("TEXCOORD=24,POSITION=1,LIGHTMAP=17", "test");
    EXPECT_EQ(draco_bits_text(bits), "POSITION=1,NORMAL=10,TEXCOORD=24,COLOR=8,LIGHTMAP=17,OTHER=12");
    EXPECT_EQ(draco_bits_text(DracoBits{}), "POSITION=14,NORMAL=10,TEXCOORD=12,COLOR=8,LIGHTMAP=auto,OTHER=12");
    EXPECT_EQ(draco_bits_text(parse_draco_bits(draco_bits_text(bits), "test")), draco_bits_text(bits));
    EXPECT_EQ(parse_draco_bits("LIGHTMAP=auto", "test").lightmap, 0);
}

TEST(DracoBits, FaultsNameThePart) {
    for (const char* list : {"POSITION=0", "POSITION=25", "POSITION=", "POSITION=12x", "POSITION=auto", "NORMAL=1", "POSITION=-4"}) {
        const std::string part = std::string(list).substr(0, std::string(list).find('='));
        EXPECT_NE(refusal(list).find(part + ": expected"), std::string::npos) << list << ": " << refusal(list);
    }
    for (const char* list : {"", "HEIGHT=12", "POSITION", "POSITION=12,", "position=12"})
        EXPECT_NE(refusal(list).find("expected PART=BITS"), std::string::npos) << list << ": " << refusal(list);
}

TEST(DracoBits, LightmapsGetAThirtySecondOfATexel) {
    for (const std::uint32_t side : {16u, 1000u, 1024u, 1025u, 16384u}) {
        const double step = 1.0 / ((1u << lightmap_bits({}, side)) - 1);
        EXPECT_LT(step / 2 * side, 1.0 / 32) << side;
        EXPECT_GT(step * side, 1.0 / 256) << side << ": more bits than the promise needs";
    }
    EXPECT_EQ(lightmap_bits(parse_draco_bits("LIGHTMAP=9", "test"), 1024), 9);
}

}  // namespace
}  // namespace luxel
