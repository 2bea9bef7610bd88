// A second run takes what the bake folder has; a damaged file is made again or named, and never gives another result.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

/// Stages whose results are stored, in their order, with the names of their files.
const std::vector<std::pair<std::string, std::string>> stored_stages{
    {"unwrap", "atlas-"},    {"evidence", "evidence-"}, {"importance", "plan-"},
    {"pooling", "strips-"},  {"closure", "closure-"},   {"solve", "solution-"},
    {"accuracy", "accuracy-"}, {"light", "lightmaps-"}};

void remove_stored(const std::filesystem::path& work, const std::string& stem) {
    std::vector<std::filesystem::path> found;
    for (const auto& entry : std::filesystem::directory_iterator(work))
        if (entry.path().filename().string().starts_with(stem)) found.push_back(entry.path());
    ASSERT_FALSE(found.empty()) << stem;
    for (const auto& path : found) std::filesystem::remove_all(path);
}

bool reused(const BakeReport& report, const std::string& stage) {
    for (const StageReport& entry : report.stages)
        if (entry.name == stage) return entry.reused;
    ADD_FAILURE() << "no stage " << stage;
    return false;
}

/// Everything that the stages say they keep.
std::map<std::string, std::uint64_t> kept(const BakeReport& report) {
    std::map<std::string, std::uint64_t> results;
    for (const StageReport& stage : report.stages)
        for (const KeptResult& result : stage.kept) results[result.name] = result.bytes;
    return results;
}

BakeOptions tiny_options(const TemporaryFolder& folder) {
    BakeOptions options = small_options(sample("cornell_box"), folder / "out/scene.glb");
    options.unwrap.texels_per_metre = 16;
    options.chunk_patches = 32;
    options.work = folder / "work";
    return options;
}

TEST(Reuse, SecondRunTakesEveryStoredStage) {
    const TemporaryFolder folder;
    const BakeOptions options = tiny_options(folder);
    const BakeReport first = bake(options);
    const FileBytes outputs = files_below(folder / "out"), stored = files_below(options.work);
    for (const auto& [stage, stem] : stored_stages) EXPECT_FALSE(reused(first, stage)) << stage;
    std::filesystem::remove_all(folder / "out");
    const BakeReport second = bake(options);
    for (const auto& [stage, stem] : stored_stages) EXPECT_TRUE(reused(second, stage)) << stage;
    EXPECT_EQ(differences(outputs, files_below(folder / "out")), "");
    EXPECT_EQ(differences(stored, files_below(options.work)), "");
    const auto kept_first = kept(first), kept_second = kept(second);
    for (const auto& [stage, stem] : stored_stages) EXPECT_TRUE(kept_second.lower_bound(stem)->first.starts_with(stem)) << stem;
    std::uint64_t listed = 0, there = 0;
    for (const auto& [name, bytes] : kept_second) {
        EXPECT_EQ(kept_first.at(name), bytes) << name;
        listed += bytes;
    }
    for (const auto& [name, bytes] : stored) there += bytes.size();
    EXPECT_EQ(listed, there) << "every byte of the folder belongs to a stage";
    EXPECT_EQ(first.pairs, second.pairs);
    EXPECT_EQ(first.error_bound, second.error_bound);
    EXPECT_EQ(first.emitted_lm, second.emitted_lm);
    EXPECT_EQ(first.absorbed_lm, second.absorbed_lm);
    EXPECT_EQ(first.evidence_rays, second.evidence_rays);
}

TEST(Reuse, OtherLightKeepsTheFactors) {
    const TemporaryFolder folder;
    BakeOptions options = tiny_options(folder);
    bake(options);
    options.input = edited_sample("cornell_box", folder / "scene", [](nlohmann::json& document) {
        for (auto& material : document["materials"])
            if (material["name"] == "lamp") material["emissiveFactor"] = {0.1, 0.2, 1.0};
    });
    const BakeReport relit = bake(options);
    for (const char* stage : {"unwrap", "evidence", "pooling", "closure"}) EXPECT_TRUE(reused(relit, stage)) << stage;
    for (const char* stage : {"solve", "accuracy", "light"}) EXPECT_FALSE(reused(relit, stage)) << stage;
    EXPECT_GT(relit.evidence_rounds, 1u) << "the plan of the first light serves the second";
}

/// A strip that is damaged where only the solve looks: the message says where, and what it says to do mends it.
TEST(Reuse, ADamagedBlockIsNamedInTheSolveAndMended) {
    const TemporaryFolder folder;
    const BakeOptions options = tiny_options(folder);
    bake(options);
    const FileBytes outputs = files_below(folder / "out");
    for (const char* stem : {"solution-", "accuracy-", "lightmaps-"}) remove_stored(options.work, stem);
    const auto strip = stored_file(options.work, "strips-") / "strip-0.lxs";
    const BlockFileReader whole(strip, FileKind::strip, identify_block_file(strip).version);
    const std::size_t index = whole.blocks().size() - 1;
    const std::uint64_t at = whole.blocks()[index].offset;
    std::fstream file(strip, std::ios::in | std::ios::out | std::ios::binary);
    const int byte = file.seekg(static_cast<std::streamoff>(at)).get();
    file.seekp(static_cast<std::streamoff>(at)).put(static_cast<char>(byte ^ 1)).flush();
    try {
        bake(options);
        ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::damaged_store);
        EXPECT_EQ(error.where, strip.string() + ": block " + std::to_string(index) + " at byte " + std::to_string(at));
        EXPECT_EQ(error.what_text, "checksum mismatch");
        EXPECT_EQ(error.hint, "remove the file and run the same command again");
    }
    std::filesystem::remove(strip);
    bake(options);
    EXPECT_EQ(differences(outputs, files_below(folder / "out")), "");
}

struct Damage {
    const char* name;
    void (*apply)(const std::filesystem::path&);
};

void flip_byte(const std::filesystem::path& path, double place) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    const auto at = static_cast<std::streamoff>(place * static_cast<double>(std::filesystem::file_size(path) - 1));
    file.seekg(at);
    const char byte = static_cast<char>(file.get() ^ 0x10);
    file.seekp(at);
    file.put(byte);
}

const Damage damages[]{
    {"removed", [](const std::filesystem::path& path) { std::filesystem::remove(path); }},
    {"flipped at the start", [](const std::filesystem::path& path) { flip_byte(path, 0.0); }},
    {"flipped in the key", [](const std::filesystem::path& path) { flip_byte(path, 24.0 / static_cast<double>(std::filesystem::file_size(path) - 1)); }},
    {"flipped at a third", [](const std::filesystem::path& path) { flip_byte(path, 0.33); }},
    {"flipped at the end", [](const std::filesystem::path& path) { flip_byte(path, 1.0); }},
    {"cut in half", [](const std::filesystem::path& path) { std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2); }},
    {"emptied", [](const std::filesystem::path& path) { std::filesystem::resize_file(path, 0); }},
};

class DamagedFolder : public testing::Test {
  protected:
    void SetUp() override {
        bake(options_);
        outputs_ = files_below(folder_ / "out");
        std::filesystem::rename(options_.work, folder_ / "whole");
    }

    /// One stored file damaged; with `later` the results of all later stages are gone, so that it must be read.
    void damage_and_run(const std::string& file, std::size_t stage, const Damage& damage, bool later) {
        SCOPED_TRACE(file + " " + damage.name + (later ? ", later stages gone" : ""));
        std::filesystem::remove_all(options_.work);
        std::filesystem::remove_all(folder_ / "out");
        std::filesystem::copy(folder_ / "whole", options_.work, std::filesystem::copy_options::recursive);
        for (std::size_t s = stage + 1; later && s < stored_stages.size(); ++s)
            remove_stored(options_.work, stored_stages[s].second);
        damage.apply(options_.work / file);
        try {
            bake(options_);
            ++repaired_;
        } catch (const Error& error) {
            ++refused_;
            EXPECT_EQ(error.code, ErrorCode::damaged_store) << error.what();
            EXPECT_NE(error.where.find(std::filesystem::path(file).filename().string()), std::string::npos) << error.what();
            EXPECT_FALSE(error.hint.empty()) << error.what();
            EXPECT_EQ(files_below(folder_.path()).count("out/scene.glb"), 0u);
            return;
        }
        EXPECT_EQ(differences(outputs_, files_below(folder_ / "out")), "");
    }

    const TemporaryFolder folder_;
    const BakeOptions options_ = tiny_options(folder_);
    FileBytes outputs_;
    int repaired_ = 0, refused_ = 0;
};

TEST_F(DamagedFolder, IsMendedOrNamed) {
    const FileBytes whole = files_below(folder_ / "whole");
    for (std::size_t stage = 0; stage < stored_stages.size(); ++stage) {
        int tried = 0;
        for (const auto& [file, bytes] : whole) {
            // Two files of a folder stand for all of them.
            if (file.rfind(stored_stages[stage].second, 0) != 0 || ++tried > 2) continue;
            for (const Damage& damage : damages)
                for (const bool later : {false, true}) damage_and_run(file, stage, damage, later);
        }
        EXPECT_GT(tried, 0) << stored_stages[stage].first;
    }
    std::printf("%d repaired or untouched by the damage, %d refused\n", repaired_, refused_);
    EXPECT_GT(repaired_, 0);
}

}  // namespace
}  // namespace luxel::test
