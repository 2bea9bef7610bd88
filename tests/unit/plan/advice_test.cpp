/// What is advised holds: the change brings the floor under the budget, and none is named where none does.
#include "baker/plan/advice.h"

#include <gtest/gtest.h>

#include <charconv>

namespace luxel {
namespace {

constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20;

const MemoryDemand hall{.fixed_bytes = 20 * mebibyte, .patch_count = 50000, .chunk_patches = 2048, .page_size = 1024, .page_count = 2, .threads = 2, .gathers = true};

/// The number after `option` in `text`; 0: it is not there.
std::uint32_t value_of(const std::string& text, const std::string& option) {
    const std::size_t at = text.find(option + ' ');
    if (at == std::string::npos) return 0;
    std::uint32_t value = 0;
    std::from_chars(text.data() + at + option.size() + 1, text.data() + text.size(), value);
    return value;
}

MemoryDemand changed(MemoryDemand demand, const std::string& change) {
    if (const std::uint32_t patches = value_of(change, "--chunk-patches")) demand.chunk_patches = patches;
    if (const std::uint32_t side = value_of(change, "--atlas-size")) {
        demand.page_count *= (demand.page_size / side) * (demand.page_size / side);
        demand.page_size = side;
    }
    if (change.find("--gather off") != std::string::npos) demand.gathers = false;
    return demand;
}

TEST(AdviceOfMemory, IsNotGivenWhereItHolds) { EXPECT_TRUE(advise_memory(memory_floor(hall), hall).empty()); }

TEST(AdviceOfMemory, NamesTheLeastThatHolds) {
    std::string last;
    int different = 0;
    for (std::uint64_t budget = memory_floor(hall) - 1; budget > 90 * mebibyte; budget -= 5 * mebibyte) {
        const std::vector<Advice> advice = advise_memory(budget, hall);
        ASSERT_EQ(advice.size(), 1U);
        if (advice[0].change.empty()) break;
        EXPECT_LE(memory_floor(changed(hall, advice[0].change)), budget) << advice[0].change;
        different += advice[0].change != last;
        // What was enough for less is not named for more: the harmless comes first.
        if (advice[0].change != last && !last.empty()) {
            EXPECT_GT(memory_floor(changed(hall, last)), budget) << last;
        }
        last = advice[0].change;
    }
    EXPECT_GE(different, 3);
    EXPECT_EQ(advise_memory(10 * mebibyte, hall).at(0).change, "");
}

TEST(AdviceOfDisk, KeepsWhatThereIsRoomFor) {
    Forecast f;
    f.matrix_bytes = 8 * mebibyte;
    EXPECT_TRUE(advise_disk(0, f).empty());
    EXPECT_TRUE(advise_disk(8 * mebibyte, f).empty());
    const std::vector<Advice> advice = advise_disk(2 * mebibyte, f);
    ASSERT_EQ(advice.size(), 1U);
    EXPECT_EQ(advice[0].change, "--store hot --store-bytes 2097152");
    EXPECT_NE(advice[0].effect.find("75 %"), std::string::npos) << advice[0].effect;
}

TEST(AdviceOfTime, GoesByTheSquareOfTheDensity) {
    Forecast f;
    f.name = "draft";
    f.seconds = {.geometry = 10, .matrix = 20, .light = 5, .write = 5};
    EXPECT_TRUE(advise_time(0, f, 16).empty());
    EXPECT_TRUE(advise_time(40, f, 16).empty());
    const std::vector<Advice> advice = advise_time(10, f, 16);
    ASSERT_EQ(advice.size(), 1U);
    EXPECT_EQ(advice[0].change, "--texels-per-metre 8");
}

}  // namespace
}  // namespace luxel
