// A bake that dies at any moment is continued by the next run, with the same bytes as an undisturbed one.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <sstream>

#include "tests/bake/child_process.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

constexpr int kills = LUXEL_KILLS;
constexpr int kills_in_a_row = 3;

class KilledBake : public testing::Test {
  protected:
    [[nodiscard]] std::vector<std::string> arguments(const std::string& name) const {
        return {"bake", sample("two_rooms").string(), "-o", (folder_ / name / "out/scene.glb").string(), "--work",
                (folder_ / name / "work").string(), "--texels-per-metre", "6", "--atlas-size", "128", "--patch-texels", "2",
                "--chunk-patches", "128", "--rays", "512", "--gather-rays", "16", "--threads", "2"};
    }
    [[nodiscard]] std::string log() const {
        std::stringstream text;
        text << std::ifstream(folder_ / "log").rdbuf();
        return text.str();
    }
    /// Names that an output may have without being whole: temporaries only.
    void expect_only_whole_outputs(const std::string& name, const FileBytes& whole) const {
        if (!std::filesystem::exists(folder_ / name / "out")) return;
        for (const auto& [file, bytes] : files_below(folder_ / name / "out"))
            EXPECT_EQ(bytes, whole.at(file)) << file << " is there but not whole";
    }

    const TemporaryFolder folder_;
};

TEST_F(KilledBake, IsContinuedByTheNextRun) {
    const ChildResult undisturbed = run_luxel(arguments("whole"), folder_ / "log");
    ASSERT_EQ(undisturbed.exit_code, 0) << log();
    const FileBytes outputs = files_below(folder_ / "whole/out"), stored = files_below(folder_ / "whole/work");

    std::mt19937 random(7);
    std::uniform_real_distribution<double> moment(0, undisturbed.seconds);
    int killed = 0;
    for (int run = 0; killed < kills; ++run) {
        ASSERT_LT(run, 4 * kills);
        const std::string name = "run" + std::to_string(run);
        std::ostringstream moments;
        for (int k = 0; k < kills_in_a_row; ++k) {
            const double after_s = moment(random);
            moments << after_s << " s ";
            killed += run_luxel(arguments(name), folder_ / "log", after_s).killed;
            expect_only_whole_outputs(name, outputs);
        }
        SCOPED_TRACE("killed after " + moments.str());
        ASSERT_EQ(run_luxel(arguments(name), folder_ / "log").exit_code, 0) << log();
        ASSERT_EQ(differences(outputs, files_below(folder_ / name / "out")), "");
        ASSERT_EQ(differences(stored, files_below(folder_ / name / "work")), "");
        std::filesystem::remove_all(folder_ / name);
    }
}

}  // namespace
}  // namespace luxel::test
