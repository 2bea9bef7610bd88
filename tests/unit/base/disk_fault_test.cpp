/// What the disk does to files: it is full, it cannot read, a file is cut behind the reader's back. Every message has the file
/// and the byte, and nothing half-written stays.
#include <gtest/gtest.h>

#include "formats/base/block_file.h"
#include "formats/base/file.h"
#include "tests/support/file_limit.h"
#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

template <class Body>
std::string failure(ErrorCode code, const std::filesystem::path& file, const Body& body) {
    try {
        body();
    } catch (const Error& error) {
        EXPECT_EQ(error.code, code);
        EXPECT_NE(error.where.find(file.string()), std::string::npos) << error.where;
        EXPECT_FALSE(error.hint.empty());
        return error.what_text;
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

TEST(DiskFault, FullWhileAFileIsWritten) {
    const test::TemporaryFolder folder;
    publish_file(folder / "f", Bytes{1, 2, 3});
    {
        const test::FileLimit limit(1000);
        const std::string what = failure(ErrorCode::cannot_write, folder / "f", [&] {
            PublishedFile file(folder / "f");
            for (int k = 0; k < 100; ++k) file.append(Bytes(64));
        });
        EXPECT_NE(what.find("cannot write at byte 1000: "), std::string::npos) << what;
    }
    EXPECT_EQ(read_file(folder / "f"), (Bytes{1, 2, 3})) << "what was there stays";
    std::size_t names = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++names;
    EXPECT_EQ(names, 1u) << "nothing else is left";
    publish_file(folder / "f", Bytes(5000));
    EXPECT_EQ(read_file(folder / "f").size(), 5000u);
}

TEST(DiskFault, CannotRead) {
    // The memory of this process as a file: nothing is mapped at address 0, so reading there is an input/output error.
    const RandomFile file("/proc/self/mem");
    Bytes some(16);
    const std::string what = failure(ErrorCode::damaged_store, "/proc/self/mem", [&] { file.read(0, some); });
    EXPECT_NE(what.find("at byte 0: "), std::string::npos) << what;
    EXPECT_NE(what.find("nput/output error"), std::string::npos) << what;
}

TEST(DiskFault, CutBehindTheReadersBack) {
    const test::TemporaryFolder folder;
    {
        BlockFileWriter file(folder / "blocks", FileKind::strip, 7, Key{1, 2});
        for (std::uint64_t k = 0; k < 4; ++k) {
            Bytes bytes(1000);
            for (std::size_t b = 0; b < bytes.size(); ++b) bytes[b] = static_cast<std::uint8_t>(b * b * (k + 3) >> 3);
            file.append(k, bytes, 1);
        }
        file.publish();
    }
    const BlockFileReader file(folder / "blocks", FileKind::strip, 7);
    const Bytes last = file.read(3);
    std::filesystem::resize_file(folder / "blocks", file.blocks()[2].offset + 10);
    EXPECT_EQ(file.read(1).size(), 1000u) << "what is still there can be read";
    for (const std::size_t block : {2u, 3u}) {
        const std::string what = failure(ErrorCode::damaged_store, folder / "blocks", [&] { (void)file.read(block); });
        EXPECT_NE(what.find("at byte " + std::to_string(file.blocks()[block].offset)), std::string::npos) << what;
        EXPECT_NE(what.find("ends at byte " + std::to_string(file.blocks()[2].offset + 10)), std::string::npos) << what;
    }
}

}  // namespace
}  // namespace luxel
