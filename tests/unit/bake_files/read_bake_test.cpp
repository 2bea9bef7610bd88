/// tools/scripts/read_bake.py, a reader written from the documents alone, finds in our files what we wrote into them:
/// if it does not, the documents or the code are wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iomanip>
#include <random>
#include <sstream>

#include "formats/bake/evidence_file.h"
#include "formats/bake/strip_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/bake_files/made_strips.h"

namespace luxel {
namespace {

const Key key{0x0123456789abcdefULL, 0xfedcba9876543210ULL};
const std::string key_text = "efcdab89674523011032547698badcfe";  // the bytes as they lie in the file

struct ReaderResult {
    std::string output;
    int status = 0;
};

/// Standard error goes into the output too.
ReaderResult read_bake(const std::vector<std::filesystem::path>& files) {
    const char* root = std::getenv("LUXEL_SOURCE_DIR");
    std::string command = std::string(LUXEL_PYTHON) + " -B '" + (root ? root : ".") + "/tools/scripts/read_bake.py'";
    for (const auto& file : files) command += " '" + file.string() + "'";
    FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    ReaderResult result;
    char buffer[4096];
    for (std::size_t got; pipe && (got = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;)
        result.output.append(buffer, got);
    result.status = pipe ? ::pclose(pipe) : -1;
    return result;
}

std::string line(const EvidenceRecord& r) {
    std::ostringstream text;
    const auto hex = [&](std::uint64_t id) -> std::ostream& {
        return text << std::hex << std::setw(16) << std::setfill('0') << id << std::dec;
    };
    text << "patch ";
    hex(r.patch_id) << " replicate " << int{r.replicate} << " levels " << int{r.first_level} << ".."
                    << int{r.last_level} << " open " << r.open << " back " << r.back << " on";
    for (std::size_t k = 0; k < r.count.size(); ++k) {
        text << " ";
        hex(r.target_id[k]) << "*" << r.count[k];
    }
    text << "\n";
    return text.str();
}

/// Two blocks of records, one of them empty, one stored raw.
std::string write_evidence(const std::filesystem::path& path) {
    const std::vector<EvidenceRecord> records{
        {0x10, 2, 0, 1, 1, 0, {0x20}, {1}},
        {0xffffffffffffffffULL, 255, 3, 9, 100, 8, {0x10, 0x20, 0xfffffffffffffffeULL}, {1, 300, 99}},
        {7, 0, 31, 31, 0x3fffffffu, 0, {5}, {1}},
        {8, 0, 0, 0, 0, 1, {}, {}}};
    const std::span<const EvidenceRecord> all(records);
    BlockFileWriter file(path, FileKind::evidence, evidence_version, key);
    file.append(0, encode_evidence(all.first(3)));
    file.append(3, encode_evidence(all.last(1)), 0);
    file.append(4, encode_evidence(std::span<const EvidenceRecord>()));
    file.publish();
    std::string expected = "evidence version 1 key " + key_text + " blocks 3\n";
    for (const EvidenceRecord& record : records) expected += line(record);
    return expected;
}

void append_block(std::uint32_t b, const StripPairs& block, StripWriter& strip, std::ostream& expected) {
    strip.append(b, block.column.size(), pack_pairs(block));
    expected << "block " << b << " rows " << block.rows << " columns " << block.columns << " pairs "
             << block.column.size() << "\n";
    for (std::uint32_t row = 0; row < block.rows; ++row)
        for (std::uint32_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k)
            expected << row << " " << block.column[k] << " " << block.count[k] << "\n";
}

/// Regular enough that the bit index is the smaller codec.
StripPairs chessboard(std::uint32_t rows, std::uint32_t columns) {
    StripPairs block{rows, columns, {0}, {}, {}};
    for (std::uint32_t row = 0; row < rows; ++row) {
        for (std::uint32_t column = 0; column < columns; column += 2) {
            block.column.push_back(static_cast<std::uint16_t>(column));
            block.count.push_back(1);
        }
        block.row_begin.push_back(static_cast<std::uint32_t>(block.column.size()));
    }
    EXPECT_EQ(pack_pairs(block).stored[0], static_cast<std::uint8_t>(PairCodec::bit_index));
    return block;
}

std::string write_strip(const std::filesystem::path& path) {
    std::mt19937_64 random(1);
    RayTallies tallies;
    std::ostringstream expected;
    expected << "strip version 3 key " << key_text << " blocks 10\n";
    for (std::uint32_t k = 0; k < 70; ++k) {
        tallies.rays.push_back(0xffffffffu - k), tallies.self.push_back(k), tallies.open.push_back(9);
        tallies.back.push_back(k * k);
        expected << "patch " << k << " rays " << 0xffffffffu - k << " self " << k << " open 9 back " << k * k << "\n";
    }
    StripWriter strip(path, key, std::move(tallies));
    append_block(2, test::random_pairs(70, 70, 900, true, random), strip, expected);
    append_block(3, test::random_pairs(70, 65536, 500, false, random), strip, expected);
    append_block(4, chessboard(70, 300), strip, expected);
    append_block(5, test::random_pairs(70, 4000, 20000, false, random), strip, expected);
    append_block(65535, test::random_pairs(70, 1, 5, false, random), strip, expected);
    strip.publish();
    return expected.str();
}

TEST(ReadBake, FindsWhatWasWritten) {
    const test::TemporaryFolder folder;
    const std::string expected = write_evidence(folder / "evidence") + write_strip(folder / "strip");
    const ReaderResult found = read_bake({folder / "evidence", folder / "strip"});
    EXPECT_EQ(found.status, 0) << found.output;
    EXPECT_EQ(found.output, expected);
}

TEST(ReadBake, RefusesDamage) {
    const test::TemporaryFolder folder;
    write_evidence(folder / "evidence");
    write_strip(folder / "strip");
    std::vector<std::filesystem::path> copies;
    for (const char* name : {"evidence", "strip"}) {
        const Bytes whole = read_file(folder / name);
        for (std::size_t k = 0; k < 60; ++k) {
            Bytes bytes = whole;
            const std::size_t at = k * 37 % 2 ? bytes.size() - 1 - k * 3 : k * (bytes.size() - 1) / 59;
            bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1u << (k % 8)));
            if (k == 59) bytes.resize(bytes.size() / 2);
            copies.push_back(folder / (std::string(name) + std::to_string(k)));
            publish_file(copies.back(), bytes);
        }
    }
    const ReaderResult found = read_bake(copies);
    EXPECT_NE(found.status, 0);
    EXPECT_EQ(static_cast<std::size_t>(std::count(found.output.begin(), found.output.end(), '\n')), copies.size())
        << "one line of complaint per file:\n"
        << found.output;
    EXPECT_EQ(found.output.find("Traceback"), std::string::npos) << found.output;
}

}  // namespace
}  // namespace luxel
