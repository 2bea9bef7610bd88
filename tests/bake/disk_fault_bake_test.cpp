// The disk fails at any read, write, sync or rename of a whole bake: the error names the file (and byte), what is in
// the bake folder stays valid, and the next run goes on to the same bytes.
#include <gtest/gtest.h>

#include <cerrno>
#include <cstdio>
#include <set>

#include "baker/bake/folder_listing.h"
#include "formats/base/file.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/disk_faults.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

class DiskFaultBake : public testing::Test {
  protected:
    BakeOptions options() {
        BakeOptions options = small_options(sample("cornell_box"), folder_ / "out/scene.glb");
        options.unwrap.texels_per_metre = 16;
        options.chunk_patches = 32;
        options.work = folder_ / "work";
        options.progress = [this](const std::string& stage, std::uint64_t, std::uint64_t total, const char*) {
            stage_ = stage;
            if (counting_ && total == 0) begins_.push_back(counting_->calls());
        };
        return options;
    }
    void forget() {
        std::filesystem::remove_all(folder_ / "work");
        std::filesystem::remove_all(folder_ / "out");
        stage_.clear();
    }
    /// An undisturbed bake: its files are what all others must come to. Returns the first and the last call of each
    /// stage.
    std::set<std::uint64_t> places(DiskCall call) {
        forget();
        const DiskFault none(call, folder_.path().string(), ~std::uint64_t{0}, EIO);
        counting_ = &none;
        bake(options());
        counting_ = nullptr;
        outputs_ = files_below(folder_ / "out");
        stored_ = files_below(folder_ / "work");
        begins_.push_back(none.calls());
        std::set<std::uint64_t> places;
        for (std::size_t k = 0; k + 1 < begins_.size(); ++k)
            if (begins_[k] < begins_[k + 1]) places.insert({begins_[k], begins_[k + 1] - 1});
        return places;
    }
    void expect_valid_folder() {
        if (!std::filesystem::exists(folder_ / "work") || std::filesystem::is_empty(folder_ / "work")) return;
        for (const Finding& finding : verify_files(list_folder(folder_ / "work"), {}).findings)
            ADD_FAILURE() << finding.where << ": " << finding.what;
    }
    /// A bake whose calls fail from `first` on, then one on a disk that has recovered.
    void fail_and_go_on(DiskCall call, std::uint64_t first, int error, ErrorCode expected) {
        SCOPED_TRACE("call " + std::to_string(first));
        forget();
        {
            const DiskFault fault(call, folder_.path().string(), first, error);
            try {
                bake(options());
                EXPECT_TRUE(fault.struck().empty() || call == DiskCall::sync) << "nothing was thrown";
            } catch (const Error& thrown) {
                struck_in_.insert(stage_);
                EXPECT_EQ(thrown.code, expected) << thrown.what();
                EXPECT_NE(thrown.where.find(folder_.path().string()), std::string::npos) << thrown.what();
                EXPECT_TRUE(call == DiskCall::sync || call == DiskCall::rename ||
                            thrown.what_text.find("at byte ") != std::string::npos)
                    << thrown.what();
                EXPECT_FALSE(thrown.hint.empty()) << thrown.what();
            }
        }
        expect_valid_folder();
        for (const auto& [name, bytes] :
             files_below(folder_ / "work"))  // but for those of rounds that a whole bake discards
            EXPECT_TRUE(!stored_.contains(name) || bytes == stored_.at(name))
                << name << " is not as an undisturbed bake has it";
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
            EXPECT_FALSE(is_temporary(entry.path())) << entry.path();
        bake(options());
        EXPECT_EQ(differences(outputs_, files_below(folder_ / "out")), "");
        EXPECT_EQ(differences(stored_, files_below(folder_ / "work")), "");
    }
    void expect_faults_told_and_mended(DiskCall call, int error, ErrorCode expected, std::initializer_list<const char*> stages) {
        const std::set<std::uint64_t> all = places(call);
        for (const std::uint64_t first : all) fail_and_go_on(call, first, error, expected);
        std::printf("%zu places of %llu calls\n", all.size(), static_cast<unsigned long long>(begins_.back()));
        for (const char* stage : stages) EXPECT_TRUE(struck_in_.contains(stage)) << stage;
    }

    const TemporaryFolder folder_;
    FileBytes outputs_, stored_;
    const DiskFault* counting_ = nullptr;
    std::vector<std::uint64_t> begins_;  ///< per stage: calls before it; at last all of them
    std::string stage_;
    std::set<std::string> struck_in_;
};

TEST_F(DiskFaultBake, ReadErrors) {
    expect_faults_told_and_mended(DiskCall::read, EIO, ErrorCode::damaged_store, {"pooling", "closure", "solve"});
}

TEST_F(DiskFaultBake, AFullDisk) {
    expect_faults_told_and_mended(DiskCall::write, ENOSPC, ErrorCode::cannot_write, {"evidence", "pooling", "closure", "solve", "light"});
}

TEST_F(DiskFaultBake, SyncErrors) { expect_faults_told_and_mended(DiskCall::sync, EIO, ErrorCode::cannot_write, {"evidence", "pooling"}); }

TEST_F(DiskFaultBake, RenameErrors) {
    expect_faults_told_and_mended(DiskCall::rename, EACCES, ErrorCode::cannot_write, {"evidence", "pooling"});
}

/// What a thread of its own writes while the solve goes on fails aloud too.
TEST_F(DiskFaultBake, ACheckpointThatCannotBeWritten) {
    BakeOptions often = options();
    const auto stage_noted = often.progress;
    std::uint64_t writes = 0;
    {
        const DiskFault none(DiskCall::write, folder_.path().string(), ~std::uint64_t{0}, ENOSPC);
        often.checkpoint_s = 0;
        often.progress = [&](const std::string& stage, std::uint64_t done, std::uint64_t total, const char* unit) {
            if (stage == "solve" && !writes) writes = none.calls();
            stage_noted(stage, done, total, unit);
        };
        bake(often);
        outputs_ = files_below(folder_ / "out");
    }
    forget();
    {
        const DiskFault fault(DiskCall::write, folder_.path().string(), writes, ENOSPC);
        try {
            bake(often);
            ADD_FAILURE() << "nothing was thrown";
        } catch (const Error& thrown) {
            EXPECT_EQ(thrown.code, ErrorCode::cannot_write) << thrown.what();
            EXPECT_NE(thrown.where.find("checkpoint-"), std::string::npos) << thrown.what();
        }
        EXPECT_EQ(stage_, "solve");
    }
    expect_valid_folder();
    bake(often);
    EXPECT_EQ(differences(outputs_, files_below(folder_ / "out")), "");
}

TEST_F(DiskFaultBake, ShortReadsAndWritesChangeNothing) {
    places(DiskCall::read);
    for (const DiskCall call : {DiskCall::read, DiskCall::write}) {
        forget();
        {
            const DiskFault pieces(call, (folder_ / "work").string(), 0, 0);
            bake(options());
            EXPECT_GT(pieces.calls(), 1000u);
        }
        EXPECT_EQ(differences(outputs_, files_below(folder_ / "out")), "");
        EXPECT_EQ(differences(stored_, files_below(folder_ / "work")), "");
    }
}

}  // namespace
}  // namespace luxel::test
