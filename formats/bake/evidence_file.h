/// Evidence on disk: how many rays of a patch, of one replicate and a range of levels, landed on which patches. Final.
/// Specification: evidence_file.md. Everything is named by stable 64-bit patch ids, so a record stays valid, byte for
/// byte, when patches are renumbered or chunks are cut anew.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "formats/base/block_file.h"

namespace luxel {

/// Rays of one patch: replicate r, indexes [begin of first_level, end of last_level] of its sequence.
/// Level 0 is ray 0; level k > 0 is rays [2^(k-1), 2^k). Sum of counts + open + back = number of those rays.
struct EvidenceRecord {
    std::uint64_t patch_id = 0;
    std::uint8_t replicate = 0;
    std::uint8_t first_level = 0, last_level = 0;  ///< inclusive, last_level <= 31
    std::uint32_t open = 0;                        ///< rays that left into the open
    std::uint32_t back = 0;                        ///< rays absorbed by the back of a one-sided surface
    std::vector<std::uint64_t> target_id;          ///< ascending, distinct
    std::vector<std::uint32_t> count;              ///< > 0, one per target; the patch itself is a target like others

    bool operator==(const EvidenceRecord&) const = default;
    /// Rays that the level range stands for.
    [[nodiscard]] std::uint64_t ray_count() const {
        const std::uint64_t end = std::uint64_t{1} << last_level;
        return first_level == 0 ? end : end - (std::uint64_t{1} << (first_level - 1));
    }
};

/// The same records with targets as positions in a shared table: what a reader of millions of records works on.
struct EvidenceBlock {
    std::vector<std::uint64_t> targets;  ///< distinct ids, ascending
    struct Row {
        std::uint64_t patch_id = 0;
        std::uint8_t replicate = 0, first_level = 0, last_level = 0;
        std::uint32_t open = 0, back = 0;
        std::uint32_t first = 0, count = 0;  ///< run in target_index and counts
    };
    std::vector<Row> rows;
    std::vector<std::uint32_t> target_index;  ///< ascending in a row
    std::vector<std::uint32_t> counts;
};

constexpr std::uint32_t evidence_version = 1;

/// A published file and the key that it must carry: every round of evidence has a key of its own.
struct EvidenceFile {
    std::filesystem::path path;
    Key key;
};

/// Records in the given order with one table of targets. Pure.
EvidenceBlock block_of(std::span<const EvidenceRecord> records);

/// One block's bytes before compression. Requires a valid block. Pure.
Bytes encode_evidence(const EvidenceBlock& block);
inline Bytes encode_evidence(std::span<const EvidenceRecord> records) { return encode_evidence(block_of(records)); }

/// Validates everything: order, bounds, counts > 0, sums equal to the ray count. Throws Error{damaged_store}.
EvidenceBlock decode_evidence(ByteView raw, const std::string& where);

/// Block `index` of a file; also demands that its tag is the number of its first record: none is lost, double or out of
/// order as long as the file's blocks are read from end to end. Throws Error{damaged_store}.
EvidenceBlock read_evidence_block(const BlockFileReader& file, std::size_t index);

/// Row `row` of a block as a record of its own.
EvidenceRecord record_of(const EvidenceBlock& block, std::size_t row);

}  // namespace luxel
