#include "formats/base/file.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

TEST(File, PublishReplacesWhole) {
    const test::TemporaryFolder folder;
    publish_file(folder / "f", Bytes{1, 2, 3});
    {
        PublishedFile abandoned(folder / "f");
        abandoned.append(Bytes{9});
    }
    EXPECT_EQ(read_file(folder / "f"), (Bytes{1, 2, 3}));
    publish_file(folder / "f", Bytes{4});
    EXPECT_EQ(read_file(folder / "f"), Bytes{4});
}

TEST(File, ErrorsHaveTheRightCode) {
    const test::TemporaryFolder folder;
    const auto code = [](const auto& body) {
        try {
            body();
        } catch (const Error& error) {
            return error.code;
        }
        return ErrorCode{0};
    };
    EXPECT_EQ(code([&] { (void)read_file(folder / "missing"); }), ErrorCode::bad_input);
    EXPECT_EQ(code([&] { (void)read_file(folder.path()); }), ErrorCode::bad_input);
    EXPECT_EQ(code([&] { publish_file(folder.path(), Bytes{}); }), ErrorCode::cannot_write);
    EXPECT_EQ(code([&] { publish_file(folder / "no" / "such" / "folder", Bytes{}); }), ErrorCode::cannot_write);
    publish_file(folder / "file", Bytes{1});
    EXPECT_EQ(code([&] { make_folder(folder / "file"); }), ErrorCode::cannot_write);
    const RandomFile file(folder / "file");
    Bytes two(2);
    EXPECT_EQ(code([&] { file.read(0, two); }), ErrorCode::damaged_store);
}

}  // namespace
}  // namespace luxel
