#include "formats/base/publisher.h"

#include <gtest/gtest.h>

#include "formats/base/error.h"
#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

PublishedFile complete(const std::filesystem::path& path, std::uint8_t byte) {
    PublishedFile file(path);
    file.append(Bytes(1000, byte));
    return file;
}

std::size_t names_in(const std::filesystem::path& folder) {
    std::size_t names = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) ++names;
    return names;
}

TEST(Publisher, PublishesAllInOrder) {
    const test::TemporaryFolder folder;
    Publisher publisher;
    for (std::uint8_t k = 0; k < 20; ++k) {
        publisher.add(complete(folder / std::to_string(k), k));
        publisher.add(complete(folder / "same name", k));
    }
    publisher.finish();
    for (std::uint8_t k = 0; k < 20; ++k) EXPECT_EQ(read_file(folder / std::to_string(k)), Bytes(1000, k));
    EXPECT_EQ(read_file(folder / "same name"), Bytes(1000, 19)) << "the last";
    EXPECT_EQ(names_in(folder.path()), 21u);
    publisher.add(complete(folder / "more", 1));
    publisher.finish();
    EXPECT_EQ(names_in(folder.path()), 22u);
}

TEST(Publisher, PublishesWhatWaitsWhenItEnds) {
    const test::TemporaryFolder folder;
    {
        Publisher publisher;
        for (int k = 0; k < 2; ++k) publisher.add(complete(folder / std::to_string(k), 1));
    }
    EXPECT_EQ(names_in(folder.path()), 2u);
    EXPECT_EQ(read_file(folder / "1"), Bytes(1000, 1));
}

TEST(Publisher, ReportsAFailureAndPublishesNothingAfterIt) {
    const test::TemporaryFolder folder;
    Publisher publisher;
    PublishedFile refused = complete(folder / "refused", 1);
    std::filesystem::create_directories(folder / "refused" / "in the way");
    PublishedFile late = complete(folder / "late", 2);
    publisher.add(std::move(refused));
    try {
        publisher.finish();
        ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::cannot_write);
        EXPECT_EQ(error.where, (folder / "refused").string());
    }
    EXPECT_THROW(publisher.add(std::move(late)), Error);
    EXPECT_THROW(publisher.finish(), Error) << "again";
    EXPECT_EQ(names_in(folder.path()), 1u) << "the folder in the way, and no temporary";
}

}  // namespace
}  // namespace luxel
