// Child processes: their exit codes, signals and messages; and that they end when they are told to.
#include "baker/sweep/bake_child.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

ChildResult shell(const test::TemporaryFolder& folder, const std::string& script, const StopRequest* stop = nullptr) {
    return run_child("/bin/sh", {"-c", script}, folder / "log", stop);
}

TEST(BakeChild, SaysHowItEnded) {
    const test::TemporaryFolder folder;
    EXPECT_EQ(shell(folder, "exit 0").exit_code, 0);
    EXPECT_EQ(shell(folder, "echo before; echo 'luxel: error: hall.glb: no light' >&2; echo '       switch it on' >&2; exit 2").message, "hall.glb: no light; switch it on");
    const ChildResult plain = shell(folder, "echo one; echo two; exit 7");
    EXPECT_EQ(plain.exit_code, 7);
    EXPECT_EQ(plain.message, "two");
    const ChildResult crash = shell(folder, "echo so far; kill -SEGV $$");
    EXPECT_EQ(crash.exit_code, 128 + 11);
    EXPECT_EQ(crash.message, "ended by signal 11: so far");
    const ChildResult missing = run_child(folder / "gone", {}, folder / "log", nullptr);
    EXPECT_NE(missing.exit_code, 0);
    EXPECT_NE(missing.message.find("cannot be started"), std::string::npos);
}

TEST(BakeChild, EndsWhenItIsAskedTo) {
    const test::TemporaryFolder folder;
    StopRequest stop;
    stop.ask();
    EXPECT_TRUE(shell(folder, "sleep 100", &stop).interrupted);
}

}  // namespace
}  // namespace luxel
