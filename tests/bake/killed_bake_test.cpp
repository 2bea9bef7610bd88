// A bake that dies at any moment of evidence and pooling is continued by the next run: what was finished is not traced again,
// and the bytes are those of an undisturbed one.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "formats/base/file.h"
#include "formats/base/publisher.h"
#include "tests/bake/child_process.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

constexpr int kills = LUXEL_KILLS;

/// From when to when a stage ran, s after the start of the program.
struct Span {
    double begin = 0, end = 0;
};

/// What a published file is: which one on the disk, and when it was written.
struct Stamp {
    ino_t inode = 0;
    std::int64_t written_ns = 0;
    bool operator==(const Stamp&) const = default;
};
using Stamps = std::map<std::string, Stamp>;

/// Where a killed run was, by what it left.
enum class Moment { before, evidence, pooling, between };

class KilledBake : public testing::Test {
  protected:
    [[nodiscard]] std::vector<std::string> arguments(const std::string& name) const {
        return {"bake", sample("two_rooms").string(), "-o", (folder_ / name / "out/scene.glb").string(), "--work", work(name).string(),
                "--texels-per-metre", "12", "--atlas-size", "256", "--patch-texels", "2", "--chunk-patches", "128", "--rays", rays_,
                "--gather-rays", "0", "--threads", "2", "--store", store_};
    }
    [[nodiscard]] std::filesystem::path work(const std::string& name) const { return folder_ / name / "work"; }
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

    /// Runs undisturbed with a report; the spans of evidence and pooling, all rounds.
    std::vector<Span> measure(const std::string& name) const {
        auto with_report = arguments(name);
        with_report.insert(with_report.end(), {"--report", (folder_ / "report.json").string()});
        const ChildResult result = run_luxel(with_report, folder_ / "log");
        EXPECT_EQ(result.exit_code, 0) << log();
        const auto report = nlohmann::json::parse(std::ifstream(folder_ / "report.json"));
        double at = 0;
        for (const auto& stage : report["stages"]) at += stage["seconds"].get<double>();
        at = result.seconds - at;  // start of the program, and what lies between stages
        std::vector<Span> spans;
        for (const auto& stage : report["stages"]) {
            const double seconds = stage["seconds"].get<double>();
            if (stage["name"] == "evidence" || stage["name"] == "pooling") spans.push_back({at, at + seconds});
            at += seconds;
        }
        return spans;
    }

    [[nodiscard]] Stamps stamps(const std::string& name, const std::string& stage) const {
        Stamps found;
        if (!std::filesystem::exists(work(name))) return found;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(work(name))) {
            const std::string file = std::filesystem::relative(entry.path(), work(name)).string();
            if (!entry.is_regular_file() || !file.starts_with(stage) || is_temporary(entry.path())) continue;
            struct stat status {};
            if (::stat(entry.path().c_str(), &status) == 0)
                found[file] = {status.st_ino, status.st_mtim.tv_sec * 1000000000LL + status.st_mtim.tv_nsec};
        }
        return found;
    }
    [[nodiscard]] std::size_t temporaries(const std::string& name) const {
        std::size_t count = 0;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(work(name))) count += is_temporary(entry.path());
        return count;
    }

    /// Inode of the checkpoint in the folder of a run that may be going on; 0: none.
    [[nodiscard]] ino_t checkpoint(const std::string& name) const {
        std::error_code failed;
        for (std::filesystem::directory_iterator at(work(name), failed), end; !failed && at != end; at.increment(failed)) {
            struct stat status {};
            const std::string file = at->path().filename().string();
            if (file.starts_with("checkpoint-") && file.ends_with(".lxk") && ::stat(at->path().c_str(), &status) == 0) return status.st_ino;
        }
        return 0;
    }

    /// The last round's folders tell: strips that are not all there, or evidence without strips that is not all there.
    [[nodiscard]] Moment moment(const std::string& name, std::size_t chunks) const {
        const auto whole = [&](const std::string& stage) {
            std::map<std::string, std::size_t> files;
            if (std::filesystem::exists(work(name)))
                for (const auto& entry : std::filesystem::directory_iterator(work(name)))
                    if (entry.path().filename().string().starts_with(stage)) files[entry.path().string()] = 0;
            for (const auto& [file, stamp] : stamps(name, stage)) ++files[(work(name) / file).parent_path().string()];
            return std::pair(files.size(), std::all_of(files.begin(), files.end(), [&](const auto& f) { return f.second == chunks; }));
        };
        const auto [rounds, evidence_whole] = whole("evidence-");
        const bool strips_whole = whole("strips-").second;
        if (rounds == 0) return Moment::before;
        if (!evidence_whole) return Moment::evidence;
        return !strips_whole ? Moment::pooling : Moment::between;
    }

    const TemporaryFolder folder_;
    std::string store_ = "all", rays_ = "1024";
};

TEST_F(KilledBake, IsContinuedByTheNextRun) {
    const std::vector<Span> spans = measure("whole");
    const FileBytes outputs = files_below(folder_ / "whole/out"), stored = files_below(work("whole"));
    const std::size_t chunks = stamps("whole", "strips-").size();
    ASSERT_GT(chunks, 4u) << "else there is nothing to lose";
    double total_s = 0;
    for (const Span& span : spans) total_s += span.end - span.begin;

    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(0, total_s);
    std::map<Moment, int> moments;
    int killed = 0, kept = 0;
    for (int run = 0; killed < kills; ++run) {
        ASSERT_LT(run, 4 * kills);
        double at = place(random);
        std::size_t span = 0;
        for (; span + 1 < spans.size() && at > spans[span].end - spans[span].begin; ++span) at -= spans[span].end - spans[span].begin;
        const double after_s = spans[span].begin + at;
        SCOPED_TRACE("killed after " + std::to_string(after_s) + " s");
        const std::string name = "run" + std::to_string(run);
        const bool was_killed = run_luxel(arguments(name), folder_ / "log", after_s).killed;
        killed += was_killed;
        if (was_killed) ++moments[moment(name, chunks)];
        expect_only_whole_outputs(name, outputs);
        const Stamps evidence = stamps(name, "evidence-");
        if (was_killed && std::filesystem::exists(work(name))) {
            // One job per thread is in flight, and what is complete waits to be published.
            ASSERT_LE(temporaries(name), std::max(1u, std::thread::hardware_concurrency()) + Publisher::most_waiting);
            for (const auto& [file, stamp] : evidence) {
                std::ifstream bytes(work(name) / file, std::ios::binary);
                ASSERT_EQ(std::string(std::istreambuf_iterator<char>(bytes), {}), stored.at(file)) << file << " is there but not whole";
            }
        }
        ASSERT_EQ(run_luxel(arguments(name), folder_ / "log").exit_code, 0) << log();
        const Stamps after = stamps(name, "evidence-");
        for (const auto& [file, stamp] : evidence) {
            ASSERT_TRUE(after.contains(file)) << file;
            ASSERT_EQ(after.at(file), stamp) << file << " was finished, and traced again";
            ++kept;
        }
        EXPECT_EQ(temporaries(name), 0u) << "of the killed run";
        ASSERT_EQ(differences(outputs, files_below(folder_ / name / "out")), "");
        ASSERT_EQ(differences(stored, files_below(work(name))), "");
        std::filesystem::remove_all(folder_ / name);
    }
    std::printf("%d kills: %d in evidence, %d in pooling, %d between stages, %d before; %d finished files were used again\n", killed,
                moments[Moment::evidence], moments[Moment::pooling], moments[Moment::between], moments[Moment::before], kept);
    EXPECT_GT(kept, 0);
    if (kills < 50) return;  // so few may all miss the short stages on a busy machine
    EXPECT_GT(moments[Moment::evidence], 0);
    EXPECT_GT(moments[Moment::pooling], 0);
}

/// Killed in its solve, a bake goes on from the checkpoint that it has published, to the same light.
TEST_F(KilledBake, GoesOnFromItsCheckpoint) {
    rays_ = "64";
    const auto with_checkpoints = [&](const std::string& name) {
        auto list = arguments(name);
        list.insert(list.end(), {"--importance", "off", "--tolerance", "1e-4", "--checkpoint-every", "0", "--report", (folder_ / "report.json").string()});
        return list;
    };
    ASSERT_EQ(run_luxel(with_checkpoints("whole"), folder_ / "log").exit_code, 0) << log();
    const FileBytes outputs = files_below(folder_ / "whole/out");
    FileBytes stored = files_below(work("whole"));
    const auto is_named = [](const std::string& file, const char* stage) { return file.starts_with(stage); };
    int resumed = 0, steps = 0;
    constexpr int runs = std::min(kills, 10);
    for (int run = 0; run < runs; ++run) {
        const std::string name = "run" + std::to_string(run);
        const std::vector<std::string> command = with_checkpoints(name);
        // When the first checkpoint is there, the second, ...
        ino_t seen = 0;
        int checkpoints = 0;
        const bool was_killed = run_luxel_until(command, folder_ / "log", [&] {
            const ino_t now = checkpoint(name);
            if (now && now != seen) seen = now, ++checkpoints;
            return checkpoints > run;
        }).killed;
        ASSERT_EQ(run_luxel(command, folder_ / "log").exit_code, 0) << log();
        const auto report = nlohmann::json::parse(std::ifstream(folder_ / "report.json"));
        steps = static_cast<int>(report["solve"]["history"].size());
        resumed += was_killed && report["solve"]["checkpoint_resumed"].get<bool>();
        ASSERT_EQ(differences(outputs, files_below(folder_ / name / "out")), "");
        FileBytes found = files_below(work(name));
        // Which reads the disk had to serve is another matter after a new start.
        std::erase_if(found, [&](const auto& file) { return is_named(file.first, "solution-"); });
        std::erase_if(stored, [&](const auto& file) { return is_named(file.first, "solution-"); });
        ASSERT_EQ(differences(stored, found), "");
    }
    std::printf("%d kills in a solve of %d steps, %d of them resumed\n", runs, steps, resumed);
    EXPECT_GT(resumed, 0);
}

/// Without evidence on the disk a killed run has lost the rays since the last directory or kept strip, and nothing else.
TEST_F(KilledBake, OfAStoreThatIsNotAllIsContinuedToo) {
    int killed = 0, kept = 0;
    rays_ = "256";
    for (const char* store : {"none", "hot"}) {
        store_ = store;
        const std::string undisturbed = std::string("whole-") + store;
        const std::vector<Span> spans = measure(undisturbed);
        const FileBytes outputs = files_below(folder_ / undisturbed / "out"), stored = files_below(work(undisturbed));
        std::mt19937 random(11);
        std::uniform_real_distribution<double> place(spans.front().begin, 1.3 * spans.back().end);  // closure and solve too
        for (int run = 0; run < kills / 2; ++run) {
            const double after_s = place(random);
            SCOPED_TRACE(std::string(store) + " killed after " + std::to_string(after_s) + " s");
            const std::string name = store + std::to_string(run);
            const bool was_killed = run_luxel(arguments(name), folder_ / "log", after_s).killed;
            killed += was_killed;
            expect_only_whole_outputs(name, outputs);
            Stamps published;  // of the last matrix: those of the rounds before are removed
            for (const char* stage : {"hot-", "closure-"})
                for (const auto& [file, stamp] : stamps(name, stage))
                    if (stored.contains(file)) published[file] = stamp;
            ASSERT_EQ(run_luxel(arguments(name), folder_ / "log").exit_code, 0) << log();
            for (const char* stage : {"hot-", "closure-"})
                for (const auto& [file, stamp] : stamps(name, stage))
                    if (published.contains(file)) {
                        ASSERT_EQ(stamp, published.at(file)) << file << " was finished, and made again";
                        ++kept;
                    }
            EXPECT_EQ(temporaries(name), 0u) << "of the killed run";
            ASSERT_EQ(differences(outputs, files_below(folder_ / name / "out")), "");
            ASSERT_EQ(differences(stored, files_below(work(name))), "");
            std::filesystem::remove_all(folder_ / name);
        }
    }
    std::printf("%d kills; %d finished files were used again\n", killed, kept);
    EXPECT_GT(killed, 0);
    EXPECT_TRUE(kills < 50 || kept > 0);
}

}  // namespace
}  // namespace luxel::test
