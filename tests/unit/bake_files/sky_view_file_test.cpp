/// Sky view files: what is written is read, the page's example is what is written, and nothing damaged is believed.
#include "formats/bake/sky_view_file.h"

#include <gtest/gtest.h>

#include "tests/support/damage.h"
#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

using test::TemporaryFolder;

const Key key{11, 22};

SkyCounts counts_of(std::size_t patches, std::size_t first) {
    SkyCounts counts;
    for (std::size_t p = 0; p < patches; ++p) {
        const std::size_t bins = (first + p) * 7 % 1025;
        counts.bins_of_patch.push_back(static_cast<std::uint16_t>(bins));
        for (std::size_t b = 0; b < bins; ++b) {
            counts.bins.push_back(static_cast<SkyBin>(b));
            counts.counts.push_back(static_cast<std::uint16_t>(1 + (p + b) % 30));
        }
    }
    return counts;
}

TEST(SkyViewFile, IsReadAsItWasWritten) {
    const TemporaryFolder folder;
    for (const std::size_t patches : {std::size_t{0}, std::size_t{1}, std::size_t{256}, std::size_t{600}}) {
        const auto path = folder / ("sky" + std::to_string(patches));
        std::vector<SkyCounts> blocks;
        for (std::size_t begin = 0; begin < patches; begin += sky_view_block)
            blocks.push_back(counts_of(std::min<std::size_t>(sky_view_block, patches - begin), begin));
        SkyViewWriter writer(path, key, patches, most_sky_rays);
        for (const SkyCounts& block : blocks) writer.append(block);
        writer.publish();
        const SkyViewReader reader(path, key);
        EXPECT_EQ(reader.patch_count(), patches);
        EXPECT_EQ(reader.rays(), most_sky_rays);
        ASSERT_EQ(reader.block_count(), blocks.size());
        for (std::size_t k = 0; k < blocks.size(); ++k) EXPECT_EQ(reader.read(k), blocks[k]);
    }
}

TEST(SkyViewFile, TheExampleOfThePage) {
    const TemporaryFolder folder;
    SkyViewWriter writer(folder / "sky", key, 1, 4);
    writer.append({{2}, {5, 9}, {2, 1}});
    writer.publish();
    const BlockFileReader file(folder / "sky", FileKind::sky_view, sky_view_version, &key);
    EXPECT_EQ(file.read(0), (Bytes{1, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4, 0, 0}));
    EXPECT_EQ(file.read(1), (Bytes{2, 0, 5, 0, 9, 0, 2, 0, 1, 0}));
}

/// A block file that is whole, but says what cannot be.
void write_blocks(const std::filesystem::path& path, const Bytes& head, const std::vector<Bytes>& blocks) {
    BlockFileWriter file(path, FileKind::sky_view, sky_view_version, key);
    file.append(0, head, 0);
    for (const Bytes& block : blocks) file.append(file.block_count(), block, 0);
    file.publish();
}

TEST(SkyViewFile, RejectsWhatCannotBe) {
    const TemporaryFolder folder;
    const Bytes head{1, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4, 0, 0};
    const auto is_refused = [&](const Bytes& first, const std::vector<Bytes>& blocks) {
        write_blocks(folder / "sky", first, blocks);
        try {
            const SkyViewReader reader(folder / "sky", key);
            for (std::size_t k = 0; k < reader.block_count(); ++k) static_cast<void>(reader.read(k));
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::damaged_store);
            return true;
        }
        return false;
    };
    EXPECT_FALSE(is_refused(head, {{2, 0, 5, 0, 9, 0, 2, 0, 1, 0}}));
    EXPECT_TRUE(is_refused(head, {}));
    EXPECT_TRUE(is_refused(head, {{2, 0, 5, 0, 9, 0, 2, 0, 1, 0}, {0, 0}}));
    EXPECT_TRUE(is_refused(head, {{2, 0, 9, 0, 5, 0, 2, 0, 1, 0}})) << "bins out of order";
    EXPECT_TRUE(is_refused(head, {{2, 0, 5, 0, 5, 0, 2, 0, 1, 0}})) << "a bin twice";
    EXPECT_TRUE(is_refused(head, {{2, 0, 5, 0, 0, 4, 2, 0, 1, 0}})) << "bin 1024";
    EXPECT_TRUE(is_refused(head, {{2, 0, 5, 0, 9, 0, 2, 0, 0, 0}})) << "a bin without a ray";
    EXPECT_TRUE(is_refused(head, {{2, 0, 5, 0, 9, 0, 2, 0, 3, 0}})) << "five of four rays";
    EXPECT_TRUE(is_refused(head, {{2, 0, 5, 0, 9, 0, 2, 0, 1, 0, 0}})) << "a byte left over";
    EXPECT_TRUE(is_refused(head, {{2, 0, 5, 0, 9, 0, 2, 0, 1}})) << "cut short";
    EXPECT_TRUE(is_refused(head, {{255, 255, 5, 0, 9, 0, 2, 0, 1, 0}}));
    for (const std::size_t byte : {std::size_t{7}, std::size_t{8}, std::size_t{11}, std::size_t{12}}) {
        Bytes other = head;
        other[byte] = static_cast<std::uint8_t>(byte == 8 ? 0 : 0x7f);
        EXPECT_TRUE(is_refused(other, {{2, 0, 5, 0, 9, 0, 2, 0, 1, 0}})) << byte;
    }
    EXPECT_TRUE(is_refused({1, 0, 0}, {{2, 0, 5, 0, 9, 0, 2, 0, 1, 0}}));
    EXPECT_THROW(SkyViewReader(folder / "none", key), Error);
}

TEST(SkyViewFile, ASizeThatIsALieGetsNoMemory) {
    const TemporaryFolder folder;
    const auto message = [&](const Bytes& head, const Bytes& block) {
        BlockFileWriter file(folder / "sky", FileKind::sky_view, sky_view_version, key);
        file.append(0, head, 1);
        file.append(1, block, 1);
        file.publish();
        try {
            const SkyViewReader reader(folder / "sky", key);
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::damaged_store);
            return std::string(error.what());
        }
        return std::string();
    };
    // Zeros take next to nothing on the disk: the frame's own size is no limit.
    const Bytes head{1, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4, 0, 0}, zeros(1 << 24);
    EXPECT_EQ(message(head, {0, 0}), "");
    EXPECT_NE(message(head, zeros).find("block 1: expected at most 1049088 bytes, found 16777216"), std::string::npos);
    EXPECT_NE(message(zeros, {0, 0}).find("head: expected 16 bytes, found 16777216"), std::string::npos);
}

TEST(SkyViewFile, RefusesDamage) {
    const TemporaryFolder folder;
    const auto path = folder / "sky";
    SkyViewWriter writer(path, key, 3, 4);
    writer.append({{2, 0, 1}, {5, 9, 1023}, {2, 1, 4}});
    writer.publish();
    test::expect_guarded(path, [&] {
        const SkyViewReader reader(path, key);
        for (std::size_t k = 0; k < reader.block_count(); ++k) static_cast<void>(reader.read(k));
    });
}

}  // namespace
}  // namespace luxel
