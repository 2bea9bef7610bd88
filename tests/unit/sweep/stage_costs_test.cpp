// What a bake would have taken from nothing, found from runs that shared their stages.
#include "baker/sweep/stage_costs.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/base/file.h"
#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

RunStage made(const char* name, double seconds, std::uint64_t peak, std::map<std::string, std::uint64_t> kept = {}) { return {name, seconds, peak, false, std::move(kept)}; }
RunStage reused(const char* name, std::map<std::string, std::uint64_t> kept, double seconds = 0.001) { return {name, seconds, 1, true, std::move(kept)}; }

BakeRun run_of(std::vector<RunStage> stages) {
    BakeRun run;
    run.stages = std::move(stages);
    return run;
}

/// Two rounds of rays with a solve between them that chooses where the second goes.
const BakeRun first = run_of({made("read", 1, 10), made("unwrap", 2, 20, {{"atlas-1", 5}}), made("evidence", 4, 30, {{"evidence-1", 7}}), made("pooling", 8, 40, {{"patches-1", 0}, {"strips-1", 0}}),
                              made("solve", 16, 50, {{"solution-1", 0}}), made("importance", 32, 60, {{"plan-1", 1}}), made("evidence", 64, 70, {{"evidence-2", 9}}),
                              made("pooling", 128, 80, {{"strips-2", 11}}), made("solve", 256, 90, {{"solution-2", 3}}), made("light", 512, 95, {{"lightmaps-1", 13}})});

TEST(StageCosts, OfARunFromNothingAreItsOwn) {
    StageCosts costs;
    const auto whole = costs.whole(first);
    EXPECT_EQ(total_seconds(whole), 1023);
    EXPECT_EQ(highest_peak(whole), 95u);
    EXPECT_EQ(disk_bytes(first), 5u + 7 + 1 + 9 + 11 + 3 + 13);
}

TEST(StageCosts, WhatWasReusedIsChargedAsItWasMade) {
    StageCosts costs;
    costs.whole(first);
    // Another light: the choice is known, so that nothing happens between the rounds; the last solve and the light are new.
    const BakeRun second = run_of({made("read", 1, 10), reused("unwrap", {{"atlas-1", 5}}), reused("evidence", {{"evidence-1", 7}}), reused("importance", {{"plan-1", 1}}),
                                   reused("evidence", {{"evidence-2", 9}}), reused("pooling", {{"patches-2", 0}, {"strips-2", 11}}), made("solve", 3, 33, {{"solution-3", 3}}), made("light", 5, 35, {{"lightmaps-2", 4}})});
    const auto whole = costs.whole(second);
    EXPECT_EQ(total_seconds(whole), 1 + 2 + 4 + (8 + 16 + 32) + 64 + 128 + 3 + 5);
    EXPECT_EQ(highest_peak(whole), 80u) << "of pooling, when it was done";
    // A third finds both.
    const BakeRun third = run_of({made("read", 1, 10), reused("unwrap", {{"atlas-1", 5}}), reused("evidence", {{"evidence-1", 7}}), reused("importance", {{"plan-1", 1}}),
                                  reused("evidence", {{"evidence-2", 9}}), reused("solve", {{"solution-3", 3}}), reused("light", {{"lightmaps-1", 13}})});
    EXPECT_EQ(total_seconds(costs.whole(third)), 1 + 2 + 4 + (8 + 16 + 32) + 64 + 3 + 512);
}

TEST(StageCosts, WhatTheSameRunMadeIsReadOnly) {
    StageCosts costs;
    const auto whole = costs.whole(run_of({made("solve", 16, 50, {{"solution-1", 3}}), reused("solve", {{"solution-1", 3}}, 0.5)}));
    EXPECT_EQ(total_seconds(whole), 16.5) << "a run from nothing would do that too";
}

TEST(StageCosts, TheLastOneThatMadeItCounts) {
    StageCosts costs;
    costs.whole(run_of({made("pooling", 8, 40, {{"strips-1", 0}})}));
    costs.whole(run_of({made("pooling", 9, 40, {{"strips-1", 11}})}));  // it was taken away between them
    EXPECT_EQ(total_seconds(costs.whole(run_of({reused("pooling", {{"strips-1", 11}})}))), 9);
}

TEST(StageCosts, WhatNobodyMadeIsRefused) {
    StageCosts costs;
    EXPECT_THROW(costs.whole(run_of({reused("unwrap", {{"atlas-9", 5}})})), Error);
    EXPECT_THROW(costs.whole(run_of({reused("unwrap", {})})), Error);
}

TEST(StageCosts, AreRememberedInAFile) {
    const test::TemporaryFolder folder;
    StageCosts costs;
    costs.whole(first);
    costs.save(folder / "costs.json");
    StageCosts again = StageCosts::load(folder / "costs.json");
    const BakeRun later = run_of({reused("unwrap", {{"atlas-1", 5}}), reused("evidence", {{"evidence-1", 7}}), reused("importance", {{"plan-1", 1}})});
    EXPECT_EQ(again.whole(later), costs.whole(later));
    publish_file(folder / "costs.json", std::vector<std::uint8_t>{'{', '"', 'a', '"', ':', '[', '1', ']', '}'});
    EXPECT_THROW(StageCosts::load(folder / "costs.json"), Error);
}

}  // namespace
}  // namespace luxel
