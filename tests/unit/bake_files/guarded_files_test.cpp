/// Evidence and strip files as a whole: every cut and every flipped bit is refused, and with right checksums everything that
/// their pages forbid beyond a single block (the blocks' own rules: evidence_file_test, strip_file_test, gap_symbols_test).
#include <gtest/gtest.h>

#include "formats/bake/evidence_file.h"
#include "formats/bake/gap_symbols.h"
#include "formats/base/compress.h"
#include "tests/support/damage.h"
#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

const Key key{31, 32};

class GuardedFile : public testing::Test {
  protected:
    const test::TemporaryFolder folder_;
    const std::filesystem::path path_ = folder_ / "file";
};

class GuardedEvidence : public GuardedFile {
  protected:
    void write() const {
        const std::vector<EvidenceRecord> records{{0x10, 0, 0, 1, 1, 0, {0x20}, {1}},
                                                  {0x20, 0, 0, 2, 0, 1, {0x10, 0x30}, {1, 2}},
                                                  {0x30, 1, 3, 3, 1, 1, {0x20}, {2}},
                                                  {0x30, 2, 3, 3, 2, 1, {0x30}, {1}}};
        const std::span<const EvidenceRecord> all(records);
        BlockFileWriter file(path_, FileKind::evidence, evidence_version, key);
        file.append(0, encode_evidence(all.first(2)));
        file.append(2, encode_evidence(all.subspan(2, 1)), 0);
        file.append(3, encode_evidence(std::span<const EvidenceRecord>()));
        file.append(3, encode_evidence(all.last(1)));
        file.publish();
    }
    [[nodiscard]] bool refuses(const std::function<void(test::BlockContents&)>& change) const {
        write();
        test::rewrite(path_, change);
        return test::file_refused(path_, load_);
    }
    const std::function<void()> load_ = [this] {
        const BlockFileReader file(path_, FileKind::evidence, evidence_version, &key);
        for (std::size_t k = 0; k < file.blocks().size(); ++k) (void)read_evidence_block(file, k);
    };
};

TEST_F(GuardedEvidence, RefusesDamage) {
    write();
    test::expect_guarded(path_, load_);
    test::expect_tags_guarded(path_, load_);
}

TEST_F(GuardedEvidence, RefusesBlocksThatAreLostDoubleOrMoved) {
    EXPECT_FALSE(refuses([](auto&) {}));
    EXPECT_FALSE(refuses([](auto& file) { file.parts.pop_back(); })) << "whether the last block is there, the footer says";
    EXPECT_TRUE(refuses([](auto& file) { file.parts.erase(file.parts.begin()); })) << "the first block is lost";
    EXPECT_TRUE(refuses([](auto& file) { file.parts.erase(file.parts.begin() + 1); })) << "a block is lost";
    EXPECT_TRUE(refuses([](auto& file) { file.parts.insert(file.parts.begin() + 1, file.parts[1]); })) << "a block twice";
    EXPECT_TRUE(refuses([](auto& file) { std::swap(file.parts[0], file.parts[1]); })) << "blocks out of order";
    EXPECT_TRUE(refuses([](auto& file) { std::swap(file.parts[0].bytes, file.parts[1].bytes); })) << "contents out of order";
    EXPECT_TRUE(refuses([](auto& file) { file.parts[2].tag = file.parts[3].tag = ~std::uint64_t{0}; })) << "tags that overflow";
}

TEST_F(GuardedEvidence, RefusesACountOfZeroInAWholeFile) {
    EXPECT_TRUE(refuses([](auto& file) { file.parts[1].bytes.back() = 0; }));
    EXPECT_TRUE(refuses([](auto& file) { file.parts[1].bytes.back() = 3; })) << "a sum that is not the number of rays";
}

class GuardedStrip : public GuardedFile {
  protected:
    void write() const {
        StripWriter strip(path_, key, {{9, 8, 7}, {1, 0, 2}, {0, 8, 1}, {8, 0, 4}});
        const StripPairs diagonal{3, 3, {0, 1, 2, 2}, {1, 2}, {5, 70000}}, wide{3, 70, {0, 2, 2, 3}, {0, 69, 3}, {1, 2, 300}};
        strip.append(2, 2, packed(PairCodec::gap_symbols, encode_gaps(diagonal)));
        strip.append(4, 3, packed(PairCodec::gap_symbols, encode_gaps(wide)));
        const Bytes index = encode_counts(wide);
        Bytes framed = compress(index, 3);
        framed.insert(framed.begin(), static_cast<std::uint8_t>(index.size()));  // a varint of one byte
        strip.append(5, 3, packed(PairCodec::bit_index, framed));
        strip.publish();
    }
    /// A block in this codec, whichever is the smaller one.
    static BlockFileWriter::Packed packed(PairCodec codec, Bytes bytes) {
        bytes.insert(bytes.begin(), static_cast<std::uint8_t>(codec));
        return BlockFileWriter::pack(bytes, 0);
    }
    [[nodiscard]] bool refuses(const std::function<void(test::BlockContents&)>& change) const {
        write();
        test::rewrite(path_, change);
        return test::file_refused(path_, load_);
    }
    /// Chunk a is number 2; its directory begins with the number of blocks, then 12 bytes each.
    [[nodiscard]] bool refuses_directory(std::size_t at, std::uint8_t value) const {
        return refuses([&](auto& file) { file.parts[4].bytes.at(at) = value; });
    }
    const std::function<void()> load_ = [this] {
        const BlockFileReader file(path_, FileKind::strip, strip_version, &key);
        (void)read_tallies(file);
        const auto directory = read_strip_directory(file);
        for (std::size_t k = 0; k < directory.size(); ++k)
            (void)unpack_pairs(file.read(first_pair_block + k), directory[k].b == 2, file.name() + ": block");
    };
};

TEST_F(GuardedStrip, RefusesDamage) {
    write();
    test::expect_guarded(path_, load_);
    test::expect_tags_guarded(path_, load_);
}

TEST_F(GuardedStrip, RefusesTalliesThatDoNotAddUp) {
    EXPECT_FALSE(refuses([](auto&) {}));
    for (const std::size_t block : {1u, 2u, 3u})
        EXPECT_TRUE(refuses([&](auto& file) { test::set_element<std::uint32_t>(file.parts[block], 1, 9); })) << "block " << block;
    EXPECT_TRUE(refuses([](auto& file) {
        for (const std::size_t block : {1u, 2u}) test::set_element<std::uint32_t>(file.parts[block], 0, 0x80000000u);
    })) << "a sum that is 8 in 32 bits";
    EXPECT_TRUE(refuses([](auto& file) { file.parts[0].bytes.resize(8); })) << "a patch less in one column";
    EXPECT_TRUE(refuses([](auto& file) { file.parts[2].bytes.pop_back(); })) << "a cut number";
}

TEST_F(GuardedStrip, RefusesADirectoryThatDoesNotAddUp) {
    EXPECT_FALSE(refuses_directory(0, 3));
    EXPECT_TRUE(refuses_directory(0, 2)) << "fewer blocks than there are";
    EXPECT_TRUE(refuses_directory(0, 4)) << "more blocks than there are";
    EXPECT_TRUE(refuses_directory(7, 255)) << "blocks beyond all memory";
    EXPECT_TRUE(refuses_directory(8 + 12, 2)) << "the same chunk twice";
    EXPECT_TRUE(refuses_directory(8 + 12, 1)) << "chunks out of order";
    EXPECT_TRUE(refuses_directory(8 + 12, 3)) << "another chunk than the block's tag";
    EXPECT_TRUE(refuses_directory(8 + 4, 0)) << "a pair count of zero";
    EXPECT_TRUE(refuses([](auto& file) { file.parts[4].bytes.pop_back(); })) << "cut";
    EXPECT_TRUE(refuses([](auto& file) { file.parts[4].bytes.push_back(0); })) << "bytes left over";
    EXPECT_TRUE(refuses([](auto& file) { std::swap(file.parts[6], file.parts[7]); })) << "blocks out of order";
    EXPECT_TRUE(refuses([](auto& file) { file.parts.erase(file.parts.begin() + 3); })) << "a column is lost";
    EXPECT_TRUE(refuses([](auto& file) { file.parts.resize(4); })) << "no directory";
}

TEST_F(GuardedStrip, RefusesPairsInTheWrongPlace) {
    EXPECT_TRUE(refuses([](auto& file) { std::swap(file.parts[5].bytes, file.parts[6].bytes); })) << "a diagonal block elsewhere";
    EXPECT_TRUE(refuses([](auto& file) { file.parts[7].bytes[0] = 2; })) << "one codec's bytes under the other's number";
    EXPECT_TRUE(refuses([](auto& file) { file.parts[6].bytes[0] = 1; })) << "one codec's bytes under the other's number";
    EXPECT_TRUE(refuses([](auto& file) { file.parts[6].bytes = {}; })) << "nothing";
}

}  // namespace
}  // namespace luxel
