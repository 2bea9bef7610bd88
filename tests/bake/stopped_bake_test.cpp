// A bake that is asked to stop writes what it has; the next run ends in the same bytes as one that never stopped. So does one
// that shows itself on the way.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "baker/bake/bake_folder.h"
#include "baker/bake/stage_files.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/solver_kinds.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

/// What is the same whether a solve was stopped or not: which of its reads the disk had to serve is not.
FileBytes lasting(FileBytes stored) {
    std::erase_if(stored, [](const auto& file) { return file.first.starts_with("solution-"); });
    return stored;
}

bool has(const FileBytes& files, const std::string& stem) {
    const auto at = files.lower_bound(stem);
    return at != files.end() && at->first.starts_with(stem);
}

class StoppedBake : public testing::Test {
  protected:
    static BakeOptions options() {
        BakeOptions options = small_options(sample("corridor_4"), "");
        options.unwrap.texels_per_metre = 3;
        options.rays = 64;
        options.tolerance = 1e-9;
        return options;
    }
    /// Asks to stop at the `count`-th report of progress in `unit` of stage `stage`.
    FinishedBake stopped(const std::string& name, BakeOptions options, const std::string& stage, const std::string& unit, int count) {
        StopRequest stop;
        int seen = 0;
        options.stop = &stop;
        options.progress = [&](const std::string& now, std::uint64_t, std::uint64_t, const char* in) {
            if (now == stage && unit == in && ++seen == count) stop.ask();
        };
        return bake_in(folder_ / name, options);
    }
    /// Steps of all solves of a bake.
    int steps(const std::string& name, BakeOptions options) {
        int steps = 0;
        options.progress = [&](const std::string& stage, std::uint64_t, std::uint64_t, const char* unit) {
            steps += stage == "solve" && std::string(unit) == "pages read";
        };
        whole_ = bake_in(folder_ / name, options);
        EXPECT_FALSE(whole_.report.stopped);
        EXPECT_FALSE(whole_.report.checkpoint_resumed);
        return steps;
    }
    void expect_goes_on(const std::string& name, const BakeOptions& options) {
        const FinishedBake next = bake_in(folder_ / name, options);
        EXPECT_FALSE(next.report.stopped);
        EXPECT_TRUE(next.report.converged);
        EXPECT_EQ(differences(whole_.outputs, next.outputs), "");
        EXPECT_EQ(differences(lasting(whole_.stored), lasting(next.stored)), "");
        const std::size_t patches = whole_.report.patches;
        EXPECT_EQ(stored_solution(folder_ / name / "work", patches).radiosity, radiosity_of_whole(patches));
    }
    [[nodiscard]] std::vector<Channels> radiosity_of_whole(std::size_t patches) const {
        return stored_solution(folder_ / "whole" / "work", patches).radiosity;
    }
    void forget(const std::string& name) { std::filesystem::remove_all(folder_ / name); }

    const TemporaryFolder folder_;
    FinishedBake whole_;
};

class StoppedSolve : public StoppedBake, public testing::WithParamInterface<SolverKind> {};

TEST_P(StoppedSolve, GoesOnFromAnyStep) {
    BakeOptions one = options();
    one.solver = GetParam();
    one.importance = false;
    const int all = steps("whole", one);
    ASSERT_GT(all, 2);
    int resumed = 0;
    for (int step = 2; step < all; step += std::max(1, all / 3)) {
        SCOPED_TRACE("step " + std::to_string(step) + " of " + std::to_string(all));
        const FinishedBake early = stopped("early", one, "solve", "pages read", step);
        ASSERT_TRUE(early.report.stopped);
        EXPECT_EQ(early.report.stopped->where, "solve");
        EXPECT_EQ(early.report.warnings.back().code, "stopped");
        EXPECT_TRUE(has(early.stored, "checkpoint-"));
        EXPECT_FALSE(has(early.stored, "solution-"));
        EXPECT_FALSE(has(early.stored, "accuracy-"));
        EXPECT_FALSE(has(early.stored, "lightmaps-"));
        EXPECT_TRUE(has(early.outputs, "scene.glb"));
        EXPECT_NE(early.outputs.at("scene.glb.lightmaps.json").find("\"state\": \"stopped\""), std::string::npos);
        expect_goes_on("early", one);
        ++resumed;
        forget("early");
    }
    EXPECT_GT(resumed, 0);
    std::printf("%s: stopped and continued at %d of %d steps\n", std::string(solver_names()[static_cast<std::size_t>(one.solver)]).c_str(), resumed, all);
}

INSTANTIATE_TEST_SUITE_P(AllSolvers, StoppedSolve, test::all_solvers(), test::solver_test_name);

TEST_F(StoppedBake, OneStepARunComesToTheSameEnd) {
    BakeOptions few = options();
    few.tolerance = 0.5;
    few.importance = false;
    const int all = steps("whole", few);
    int resumed = 0;
    for (int run = 0; run <= 2 * all; ++run) {
        const FinishedBake early = stopped("often", few, "solve", "pages read", 1);
        resumed += early.report.checkpoint_resumed;
        if (!early.report.stopped || early.report.stopped->where != "solve") break;
        ASSERT_LT(run, 2 * all) << "no run comes any further";
    }
    EXPECT_GT(resumed, 2);
    std::printf("%d steps, %d runs that went on\n", all, resumed);
    expect_goes_on("often", few);
}

TEST_F(StoppedBake, InTheFirstRaysThereIsNothingToWrite) {
    steps("whole", options());
    try {
        stopped("early", options(), "evidence", "rays", 1);
        ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::stopped_early);
        EXPECT_NE(error.hint.find("--work"), std::string::npos) << error.hint;
    }
    EXPECT_TRUE(files_below(folder_ / "early/out").empty());
    EXPECT_TRUE(has(files_below(folder_ / "early/work"), "evidence-")) << "what was traced stays";
    expect_goes_on("early", options());
}

TEST_F(StoppedBake, InALaterRoundTheLastOneServes) {
    BakeOptions more = options();
    more.rays = 256;
    steps("whole", more);
    ASSERT_EQ(whole_.report.evidence_rounds, 2u);
    const int first = static_cast<int>(whole_.report.chunks);
    StopRequest stop;
    int evidence = 0;
    BakeOptions early = more;
    early.stop = &stop;
    early.progress = [&](const std::string& stage, std::uint64_t done, std::uint64_t, const char*) {
        if (stage == "evidence" && done == 0) ++evidence;  // a stage begins
        if (stage == "evidence" && done > 0 && evidence == 2) stop.ask();
    };
    const FinishedBake ended = bake_in(folder_ / "early", early);
    ASSERT_TRUE(ended.report.stopped) << first;
    EXPECT_EQ(ended.report.stopped->where, "evidence");
    EXPECT_EQ(ended.report.evidence_rounds, 1u);
    EXPECT_TRUE(ended.report.converged) << "the solution of the round before";
    EXPECT_TRUE(has(ended.outputs, "scene.glb"));
    expect_goes_on("early", more);
}

TEST_F(StoppedBake, ASolveThatHasHardlyBegunGivesWayToTheRoundBefore) {
    BakeOptions more = options();
    more.rays = 256;
    steps("whole", more);
    StopRequest stop;
    int solves = 0;
    BakeOptions early = more;
    early.stop = &stop;
    early.progress = [&](const std::string& stage, std::uint64_t, std::uint64_t, const char* unit) {
        solves += stage == "solve" && std::string(unit).empty();  // a stage begins
        if (solves == 2) stop.ask();
    };
    const FinishedBake ended = bake_in(folder_ / "early", early);
    ASSERT_TRUE(ended.report.stopped);
    EXPECT_EQ(ended.report.stopped->where, "solve");
    EXPECT_GE(ended.report.error_bound, 1);
    EXPECT_NE(ended.report.stopped->what.find("the light is that of the round before"), std::string::npos) << ended.report.stopped->what;
    const auto mean = [](const FinishedBake& bake) {
        double sum = 0;
        for (const PagePixels& page : lightmap_pages(bake.report))
            for (const auto& pixel : page.pixels) sum += static_cast<double>(pixel[1]);
        return sum;
    };
    EXPECT_NEAR(mean(ended) / mean(whole_), 1, 0.1) << "and not dark";
    expect_goes_on("early", more);
}

TEST_F(StoppedBake, PagesThatAreNotGatheredAreNotKept) {
    BakeOptions many = options();
    many.gather_rays = 256;
    steps("whole", many);
    const FinishedBake early = stopped("early", many, "light", "texels", 1);
    ASSERT_TRUE(early.report.stopped);
    EXPECT_EQ(early.report.stopped->where, "light");
    EXPECT_NE(early.report.warnings.back().text.find("interpolated"), std::string::npos);
    EXPECT_EQ(early.stored.size() + early.report.pages, whole_.stored.size());
    EXPECT_TRUE(has(early.stored, "solution-"));
    expect_goes_on("early", many);
}

TEST_F(StoppedBake, AFinishedFolderGivesItsResultAtOnce) {
    steps("whole", options());
    StopRequest stop;
    stop.ask();
    BakeOptions at_once = options();
    at_once.stop = &stop;
    const FinishedBake again = bake_in(folder_ / "whole", at_once);
    EXPECT_FALSE(again.report.stopped);
    EXPECT_EQ(differences(whole_.outputs, again.outputs), "");
    EXPECT_EQ(differences(whole_.stored, again.stored), "");
}

TEST_F(StoppedBake, CheckpointsAreCheckedAndThoseOfOthersIgnored) {
    BakeOptions one = options();
    one.importance = false;
    const int all = steps("whole", one);
    stopped("early", one, "solve", "pages read", all / 2);
    const auto path = stored_file(folder_ / "early/work", "checkpoint-");
    const Key key = key_in_name(path.filename().string());
    const SolveState state = *load_checkpoint(path, key);
    // Damaged.
    const auto middle = static_cast<std::streamoff>(std::filesystem::file_size(path) / 2);
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    const int byte = file.seekg(middle).get();
    file.seekp(middle).put(static_cast<char>(byte ^ 1)).flush();
    try {
        bake_in(folder_ / "early", one);
        ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::damaged_store);
        EXPECT_NE(error.where.find(path.string()), std::string::npos) << error.what();
        EXPECT_NE(error.hint.find("remove the file"), std::string::npos) << error.what();
    }
    // Of a solver that kept other vectors, of another version.
    SolveState other = state;
    other.numbers.back().push_back(0);
    save_checkpoint(path, key, other);
    expect_goes_on("early", one);
    std::filesystem::remove(stored_file(folder_ / "early/work", "solution-"));
    BlockFileWriter(path, FileKind::checkpoint, 99, key).publish();
    EXPECT_FALSE(bake_in(folder_ / "early", one).report.checkpoint_resumed);
    expect_goes_on("early", one);
}

TEST_F(StoppedBake, PreviewsAndCheckpointsChangeNothing) {
    BakeOptions shown = options();
    shown.rays = 256;
    steps("whole", shown);
    shown.preview_s = 1e-9;
    shown.checkpoint_s = 0;
    FileBytes preview;
    shown.progress = [&](const std::string& stage, std::uint64_t, std::uint64_t, const char*) {
        if (stage == "closure" && std::filesystem::exists(folder_ / "shown/out")) preview = files_below(folder_ / "shown/out");
    };
    const FinishedBake ended = bake_in(folder_ / "shown", shown);
    EXPECT_GT(ended.report.previews, 0u);
    EXPECT_GT(ended.report.preview_seconds, 0);
    EXPECT_EQ(differences(whole_.outputs, ended.outputs), "");
    EXPECT_EQ(differences(whole_.stored, ended.stored), "");
    const std::string sidecar = "scene.glb.lightmaps.json";
    EXPECT_EQ(ended.outputs.at(sidecar).find("\"state\""), std::string::npos);
    EXPECT_EQ(ended.report.outputs.size(), whole_.report.outputs.size());
    ASSERT_TRUE(preview.contains(sidecar)) << "of the first round";
    EXPECT_NE(preview.at(sidecar).find("\"state\": \"preview\""), std::string::npos);
    EXPECT_TRUE(preview.contains("scene.glb"));
    EXPECT_TRUE(preview.contains("scene.lightmap0.exr"));
    EXPECT_NE(preview.at("scene.lightmap0.exr"), ended.outputs.at("scene.lightmap0.exr"));
}

TEST_F(StoppedBake, TheReportSaysWhichWayTheSolveTook) {
    BakeOptions small = options();
    EXPECT_EQ(bake_in(folder_ / "a", small).report.solve_path, "in memory");
    small.output = folder_ / "b/out/scene.glb";
    small.rays = 256;
    small.unwrap.texels_per_metre = 8;
    small.store = StoreKind::no_blocks;
    small.unwrap.page_size = 256;
    small.gather_rays = 0;
    small.tolerance = 0.1;
    small.memory_bytes = smallest_memory(small);
    const FinishedBake narrow = bake_in(folder_ / "b", small);
    EXPECT_EQ(narrow.report.solve_path, "out of core");
    EXPECT_NE(narrow.report.solve_path_why.find(" MB, the cache may hold "), std::string::npos) << narrow.report.solve_path_why;
    std::printf("%s: %s\n", narrow.report.solve_path.c_str(), narrow.report.solve_path_why.c_str());
}

}  // namespace
}  // namespace luxel::test
