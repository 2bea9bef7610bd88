/// Evidence blocks: pinned bytes of evidence_file.md, round trip, and refusal of everything that the page names.
#include "formats/bake/evidence_file.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/damage.h"

namespace luxel {
namespace {

using test::refused;

void decode(ByteView bytes) { decode_evidence(bytes, "test"); }

const Bytes example{1, 1, 0x20, 0, 0, 0, 0, 0, 0, 0, 0x10, 0, 0, 0, 0, 0, 0, 0, 2, 0, 1, 1, 0, 1, 0, 1};

EvidenceRecord example_record() { return {0x10, 2, 0, 1, 1, 0, {0x20}, {1}}; }

/// Legal records with targets from a small pool, so that they share the table.
std::vector<EvidenceRecord> random_records(std::size_t count, std::mt19937_64& random) {
    std::vector<EvidenceRecord> records;
    for (std::size_t k = 0; k < count; ++k) {
        EvidenceRecord record;
        record.patch_id = random();
        record.replicate = static_cast<std::uint8_t>(random() % 256);
        record.last_level = static_cast<std::uint8_t>(random() % 20);
        record.first_level = static_cast<std::uint8_t>(random() % (record.last_level + 1u));
        std::uint64_t rays = record.ray_count();
        for (std::uint64_t id = 1; id < 40 && rays > 0; ++id) {
            if (random() % 2) continue;
            const std::uint64_t count_here = 1 + random() % rays;
            record.target_id.push_back(id << 56 | 77);
            record.count.push_back(static_cast<std::uint32_t>(count_here));
            rays -= count_here;
        }
        record.open = static_cast<std::uint32_t>(rays / 2);
        record.back = static_cast<std::uint32_t>(rays - rays / 2);
        records.push_back(std::move(record));
    }
    return records;
}

TEST(EvidenceFile, ExampleOfTheDocument) {
    const std::vector<EvidenceRecord> records{example_record()};
    EXPECT_EQ(encode_evidence(records), example);
    const EvidenceBlock block = decode_evidence(example, "example");
    ASSERT_EQ(block.rows.size(), 1u);
    EXPECT_EQ(record_of(block, 0), records[0]);
}

TEST(EvidenceFile, RaysOfLevels) {
    const auto rays = [](std::uint8_t first, std::uint8_t last) {
        return EvidenceRecord{0, 0, first, last, 0, 0, {}, {}}.ray_count();
    };
    EXPECT_EQ(rays(0, 0), 1u);
    EXPECT_EQ(rays(1, 1), 1u);
    EXPECT_EQ(rays(5, 5), 16u);
    EXPECT_EQ(rays(0, 4) + rays(5, 9), rays(0, 9));
    EXPECT_EQ(rays(0, 31), std::uint64_t{1} << 31);
}

TEST(EvidenceFile, RoundTrip) {
    std::mt19937_64 random(1);
    for (const std::size_t count : {0u, 1u, 2u, 7u, 100u}) {
        const auto records = random_records(count, random);
        const EvidenceBlock block = decode_evidence(encode_evidence(records), "round trip");
        ASSERT_EQ(block.rows.size(), records.size());
        for (std::size_t k = 0; k < records.size(); ++k) EXPECT_EQ(record_of(block, k), records[k]);
    }
}

TEST(EvidenceFile, LargestNumbers) {
    const std::vector<EvidenceRecord> records{
        {~std::uint64_t{0}, 255, 0, 31, 0, 0, {0, ~std::uint64_t{0}}, {0x7fffffffu, 1}},
        {0, 0, 31, 31, 0x40000000u, 0, {}, {}}};
    const EvidenceBlock block = decode_evidence(encode_evidence(records), "largest");
    EXPECT_EQ(record_of(block, 0), records[0]);
    EXPECT_EQ(record_of(block, 1), records[1]);
}

/// A record is the same bytes whatever else lies in its block, once taken out of it.
TEST(EvidenceFile, RecordsDoNotDependOnTheirBlock) {
    std::mt19937_64 random(2);
    const auto records = random_records(20, random);
    const EvidenceBlock together = decode_evidence(encode_evidence(records), "together");
    for (std::size_t k = 0; k < records.size(); ++k) {
        const EvidenceRecord found = record_of(together, k);
        EXPECT_EQ(encode_evidence({&found, 1}), encode_evidence({&records[k], 1}));
    }
}

TEST(EvidenceFile, RefusesEveryOtherLength) {
    std::mt19937_64 random(3);
    test::expect_exact_length(example, decode);
    test::expect_exact_length(encode_evidence(random_records(6, random)), decode);
    test::expect_exact_length(encode_evidence(std::span<const EvidenceRecord>()), decode);
}

TEST(EvidenceFile, RefusesDisorder) {
    const auto changed = [](std::size_t at, std::uint8_t value) {
        Bytes bytes = example;
        bytes.at(at) = value;
        return bytes;
    };
    EXPECT_TRUE(refused(changed(0, 2), decode)) << "more records than there are";
    EXPECT_TRUE(refused(changed(1, 2), decode)) << "a longer table than there is";
    EXPECT_TRUE(refused(changed(19, 2), decode)) << "first level above the last";
    EXPECT_TRUE(refused(changed(20, 2), decode)) << "a sum that is not the number of rays";
    EXPECT_TRUE(refused(changed(21, 0), decode)) << "a sum below the number of rays";
    EXPECT_TRUE(refused(changed(22, 1), decode)) << "a sum above the number of rays";
    EXPECT_TRUE(refused(changed(23, 2), decode)) << "more targets than the table has";
    EXPECT_TRUE(refused(changed(24, 1), decode)) << "a target beyond the table";
    EXPECT_TRUE(refused(changed(25, 0), decode)) << "a count of zero";
    EXPECT_TRUE(refused(changed(20, 32), decode)) << "a level above 31";
    EXPECT_FALSE(refused(changed(18, 255), decode)) << "any replicate is legal";
}

TEST(EvidenceFile, RefusesTablesOutOfOrder) {
    const std::vector<EvidenceRecord> records{{1, 0, 0, 1, 0, 0, {5, 6}, {1, 1}}};
    Bytes bytes = encode_evidence(records);
    ASSERT_FALSE(refused(bytes, decode));
    std::swap(bytes[2], bytes[10]);
    EXPECT_TRUE(refused(bytes, decode)) << "descending";
    bytes[2] = bytes[10];
    EXPECT_TRUE(refused(bytes, decode)) << "twice the same";
}

TEST(EvidenceFile, RefusesNumbersThatDoNotFit) {
    const auto with_open = [](std::uint64_t open) {
        ByteWriter out;
        out.put_varint(1), out.put_varint(0), out.put(std::uint64_t{1});
        out.put(std::uint8_t{0}), out.put(std::uint8_t{0}), out.put(std::uint8_t{0});
        out.put_varint(open), out.put_varint(0), out.put_varint(0);
        return out.take();
    };
    EXPECT_FALSE(refused(with_open(1), decode));
    EXPECT_TRUE(refused(with_open((std::uint64_t{1} << 32) + 1), decode)) << "would be 1 in 32 bits";
    ByteWriter many;
    many.put_varint(std::uint64_t{1} << 61);  // times 8 bytes is 0 in 64 bits
    many.put_varint(0);
    EXPECT_TRUE(refused(many.bytes(), decode));
    ByteWriter wide;
    wide.put_varint(0);
    wide.put_varint(std::uint64_t{1} << 61);
    EXPECT_TRUE(refused(wide.bytes(), decode));
}

/// Whatever the bytes are: either refused, or records that are written as the same records again.
TEST(EvidenceFile, RandomBytesAreRefusedOrLegal) {
    std::mt19937_64 random(4);
    const Bytes whole = encode_evidence(random_records(5, random));
    for (int round = 0; round < 5000; ++round) {
        Bytes bytes = whole;
        for (std::uint64_t k = 0; k < 1 + random() % 3; ++k)
            bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
        refused(bytes, [](ByteView view) {
            const EvidenceBlock block = decode_evidence(view, "random");
            std::vector<EvidenceRecord> records;
            for (std::size_t k = 0; k < block.rows.size(); ++k) records.push_back(record_of(block, k));
            const EvidenceBlock again = decode_evidence(encode_evidence(records), "again");
            for (std::size_t k = 0; k < records.size(); ++k) EXPECT_EQ(record_of(again, k), records[k]);
        });
    }
}

}  // namespace
}  // namespace luxel
