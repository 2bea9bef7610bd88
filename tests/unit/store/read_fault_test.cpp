/// Strips and evidence that can no longer be read: the message has file and byte, and once the file is gone the same call makes
/// the same bytes again.
#include <gtest/gtest.h>

#include "baker/formfactors/closure.h"
#include "tests/support/file_limit.h"
#include "tests/unit/store/made_evidence.h"

namespace luxel {
namespace {

using test::MadeEvidence;
using test::TemporaryFolder;

template <class Body>
Error failure(const Body& body) {
    try {
        body();
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "nothing was thrown";
    return Error(ErrorCode::internal, "", "");
}

void close(const StripStore& strips) {
    const RayTallies& t = strips.tallies();
    const std::vector<double> area(t.rays.size(), 1);
    const std::vector<std::uint64_t> rays(t.rays.begin(), t.rays.end()), self(t.self.begin(), t.self.end()), open(t.open.begin(), t.open.end());
    (void)close_rows(strips, {area, rays, self, open});
}

TEST(ReadFault, AStripCutWhileItIsInUse) {
    const TemporaryFolder folder;
    const MadeEvidence made = test::random_evidence({40, 30, 20}, 12, 2, 5);
    const auto files = test::write_evidence(folder.path(), made.records, 60, 16);
    const auto strips = pool(folder, made, files, "strips");
    const auto path = strip_path(strips, 1);
    const Bytes whole = read_file(path);
    {
        const StripStore store(strips, test::strip_key, made.layout);
        close(store);
        std::filesystem::resize_file(path, 60);
        const Error error = failure([&] { close(store); });
        EXPECT_EQ(error.code, ErrorCode::damaged_store);
        EXPECT_NE(error.where.find(path.string()), std::string::npos) << error.where;
        EXPECT_NE(error.what_text.find("ends at byte 60"), std::string::npos) << error.what_text;
        EXPECT_FALSE(error.hint.empty());
    }
    std::filesystem::remove(path);
    pool_evidence(made.layout, made.ids, test::keyed(files), strips, test::strip_key, {1 << 30, folder.path()}, {});
    EXPECT_EQ(read_file(path), whole);
}

TEST(ReadFault, EvidenceThatIsCut) {
    const TemporaryFolder folder;
    const MadeEvidence made = test::random_evidence({40, 30}, 12, 2, 6);
    const auto files = test::write_evidence(folder.path(), made.records, 100, 16);
    const Bytes whole = read_file(files[1]);
    std::filesystem::resize_file(files[1], whole.size() - 1);
    const Error error = failure([&] { pool(folder, made, files, "strips"); });
    EXPECT_EQ(error.code, ErrorCode::damaged_store);
    EXPECT_NE(error.where.find(files[1].string()), std::string::npos) << error.where;
    EXPECT_TRUE(std::filesystem::is_empty(folder / "strips"));
    publish_file(files[1], whole);
    std::filesystem::remove(folder / "strips");
    (void)pool(folder, made, files, "strips");
}

/// At every size of a full disk: strips are whole or absent, and pooling goes on with what is there.
TEST(ReadFault, AFullDiskWhilePooling) {
    const TemporaryFolder folder;
    const MadeEvidence made = test::random_evidence({60, 25, 40}, 12, 2, 7);
    const auto files = test::write_evidence(folder.path(), made.records, 60, 16);
    const auto whole = pool(folder, made, files, "whole");
    for (ChunkNumber full = 0; full < made.layout.chunk_count(); ++full) {
        const auto strips = folder / ("strips" + std::to_string(full));
        std::filesystem::create_directory(strips);
        const auto again = [&] {
            pool_evidence(made.layout, made.ids, test::keyed(files), strips, test::strip_key, {1 << 30, folder.path()}, {});
        };
        {
            const std::uint64_t bytes = std::filesystem::file_size(strip_path(whole, full)) - 1;
            const test::FileLimit limit(bytes);
            const Error error = failure(again);
            EXPECT_EQ(error.code, ErrorCode::cannot_write);
            EXPECT_NE(error.where.find("strip-"), std::string::npos) << error.where;
            EXPECT_NE(error.what_text.find("at byte " + std::to_string(bytes)), std::string::npos) << error.what_text;
        }
        for (const auto& entry : std::filesystem::directory_iterator(strips))
            EXPECT_EQ(read_file(entry.path()), read_file(whole / entry.path().filename()));
        again();
        for (ChunkNumber a = 0; a < made.layout.chunk_count(); ++a)
            EXPECT_EQ(read_file(strip_path(strips, a)), read_file(strip_path(whole, a)));
    }
}

}  // namespace
}  // namespace luxel
