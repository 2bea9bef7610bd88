// The bake folder that a sweep's bakes share: what it remembers, and when it is begun anew.
#include "baker/sweep/work_folder.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "formats/base/file.h"
#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

const BakeRun making{.stages = {{"unwrap", 2, 20, false, {{"atlas-1", 5}}}}};
const BakeRun reusing{.stages = {{"unwrap", 0.1, 3, true, {{"atlas-1", 5}}}}};

TEST(WorkFolder, KeepsStagesAndWhatTheyTook) {
    const test::TemporaryFolder folder;
    {
        WorkFolder work(folder / "all-0");
        publish_file(work.path() / "atlas-1", {});
        EXPECT_EQ(total_seconds(work.whole(making)), 2);
    }
    WorkFolder again(folder / "all-0");
    EXPECT_TRUE(std::filesystem::exists(again.path() / "atlas-1"));
    EXPECT_EQ(total_seconds(again.whole(reusing)), 2);
}

TEST(WorkFolder, IsBegunAnewWhereABakeDidNotEndWell) {
    const test::TemporaryFolder folder;
    { WorkFolder(folder / "all-0").whole(making); }
    {
        const WorkFolder work(folder / "all-0");
        publish_file(work.path() / "evidence-half", {});
    }
    WorkFolder again(folder / "all-0");
    EXPECT_TRUE(std::filesystem::is_empty(again.path()));
    EXPECT_THROW(again.whole(reusing), Error) << "what was made before is gone";
}

TEST(WorkFolder, IsBegunAnewWhereNobodyKnowsWhatItTook) {
    const test::TemporaryFolder folder;
    make_folder(folder / "all-0");
    publish_file(folder / "all-0/atlas-1", {});
    EXPECT_TRUE(std::filesystem::is_empty(WorkFolder(folder / "all-0").path()));
}

}  // namespace
}  // namespace luxel
