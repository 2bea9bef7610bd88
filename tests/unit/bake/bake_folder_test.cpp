/// Names in the bake folder, and the temporary one that leaves nothing behind.
#include "baker/bake/bake_folder.h"

#include <gtest/gtest.h>

#include <set>

#include "formats/base/error.h"
#include "formats/base/file.h"
#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

TEST(BakeFolder, NamesDifferByStageAndKey) {
    const test::TemporaryFolder temporary;
    const BakeFolder folder(temporary / "a/b", temporary / "out.glb");
    std::set<std::filesystem::path> names;
    for (const Key& key : {Key{1, 2}, Key{2, 1}}) {
        for (const auto& path : {folder.atlas(key), folder.closure(key), folder.solution(key), folder.evidence(key),
                                 folder.strips(key), folder.lightmaps(key)}) {
            EXPECT_TRUE(names.insert(path).second) << path;
            EXPECT_EQ(path.parent_path(), folder.root());
            EXPECT_NE(path.string().find(key.text()), std::string::npos);
        }
        for (const auto& path : {folder.evidence(key), folder.strips(key), folder.lightmaps(key)})
            EXPECT_TRUE(std::filesystem::is_directory(path));
        for (const auto& path : {folder.atlas(key), folder.closure(key), folder.solution(key)})
            EXPECT_FALSE(std::filesystem::exists(path));
    }
    EXPECT_NE(BakeFolder::evidence_file("x", 1), BakeFolder::evidence_file("x", 11));
    EXPECT_NE(BakeFolder::lightmap_file("x", 0), BakeFolder::lightmap_file("x", 1));
}

TEST(BakeFolder, AGivenFolderIsKept) {
    const test::TemporaryFolder temporary;
    const Key key{3, 4};
    { publish_file(BakeFolder(temporary / "work", temporary / "out.glb").atlas(key), Bytes{1}); }
    EXPECT_TRUE(std::filesystem::exists(BakeFolder(temporary / "work", temporary / "out.glb").atlas(key)));
}

TEST(BakeFolder, ATemporaryOneIsRemoved) {
    const test::TemporaryFolder temporary;
    {
        const BakeFolder folder({}, temporary / "out.glb"), second({}, temporary / "out.glb");
        EXPECT_EQ(folder.root().parent_path(), temporary.path()) << "beside the output: the same disk";
        EXPECT_NE(folder.root(), second.root()) << "two bakes at a time";
        publish_file(BakeFolder::evidence_file(folder.evidence({1, 1}), 0), Bytes{1});
    }
    EXPECT_TRUE(std::filesystem::is_empty(temporary.path()));
}

TEST(BakeFolder, SaysWhereItCannotWrite) {
    const test::TemporaryFolder temporary;
    publish_file(temporary / "file", Bytes{1});
    const auto code_of = [](const std::filesystem::path& work, const std::filesystem::path& output) {
        try {
            const BakeFolder folder(work, output);
        } catch (const Error& error) {
            EXPECT_FALSE(error.what_text.empty());
            return error.code;
        }
        return ErrorCode::internal;
    };
    EXPECT_EQ(code_of({}, temporary / "no/such/out.glb"), ErrorCode::cannot_write);
    EXPECT_EQ(code_of(temporary / "file/work", temporary / "out.glb"), ErrorCode::cannot_write);
    EXPECT_EQ(code_of(temporary / "file", temporary / "out.glb"), ErrorCode::cannot_write) << "a file, not a folder";
}

}  // namespace
}  // namespace luxel
