#include "formats/bake/evidence_file.h"

#include <algorithm>

namespace luxel {

EvidenceBlock block_of(std::span<const EvidenceRecord> records) {
    EvidenceBlock block;
    for (const EvidenceRecord& record : records)
        block.targets.insert(block.targets.end(), record.target_id.begin(), record.target_id.end());
    std::sort(block.targets.begin(), block.targets.end());
    block.targets.erase(std::unique(block.targets.begin(), block.targets.end()), block.targets.end());
    for (const EvidenceRecord& r : records) {
        block.rows.push_back({r.patch_id, r.replicate, r.first_level, r.last_level, r.open, r.back,
                              static_cast<std::uint32_t>(block.counts.size()), static_cast<std::uint32_t>(r.count.size())});
        for (const std::uint64_t id : r.target_id)
            block.target_index.push_back(static_cast<std::uint32_t>(
                std::lower_bound(block.targets.begin(), block.targets.end(), id) - block.targets.begin()));
        block.counts.insert(block.counts.end(), r.count.begin(), r.count.end());
    }
    return block;
}

Bytes encode_evidence(const EvidenceBlock& block) {
    ByteWriter out;
    out.put_varint(block.rows.size());
    out.put_varint(block.targets.size());
    out.put_array(std::span<const std::uint64_t>(block.targets));
    // Column by column: equal kinds of numbers beside each other compress better.
    for (const EvidenceBlock::Row& r : block.rows) out.put(r.patch_id);
    for (const EvidenceBlock::Row& r : block.rows) out.put(r.replicate), out.put(r.first_level), out.put(r.last_level);
    for (const EvidenceBlock::Row& r : block.rows) out.put_varint(r.open), out.put_varint(r.back), out.put_varint(r.count);
    for (const EvidenceBlock::Row& r : block.rows) {
        std::uint64_t expected = 0;
        for (std::uint32_t k = r.first; k < r.first + r.count; ++k) {
            out.put_varint(block.target_index[k] - expected);
            expected = std::uint64_t{block.target_index[k]} + 1;
        }
    }
    for (const std::uint32_t count : block.counts) out.put_varint(count);
    return out.take();
}

EvidenceBlock decode_evidence(ByteView raw, const std::string& where) {
    ByteCursor in(raw, where);
    EvidenceBlock block;
    const std::uint64_t record_count = in.get_varint("record count");
    const std::uint64_t table_size = in.get_varint("target table size");
    if (table_size > 0xffffffffu) in.fail("target table size", "above 2^32");
    block.targets = in.get_array<std::uint64_t>(table_size, "target table");
    for (std::size_t k = 1; k < block.targets.size(); ++k)
        if (block.targets[k] <= block.targets[k - 1]) in.fail("target table", "not ascending");

    const auto ids = in.get_array<std::uint64_t>(record_count, "patch ids");
    block.rows.resize(ids.size());
    for (std::size_t k = 0; k < ids.size(); ++k) {
        EvidenceBlock::Row& row = block.rows[k];
        row.patch_id = ids[k];
        row.replicate = in.get<std::uint8_t>("replicate");
        row.first_level = in.get<std::uint8_t>("first level");
        row.last_level = in.get<std::uint8_t>("last level");
        if (row.first_level > row.last_level || row.last_level > 31) in.fail("levels", "out of order or above 31");
    }
    std::uint64_t total = 0;
    for (EvidenceBlock::Row& row : block.rows) {
        const std::uint64_t open = in.get_varint("open"), back = in.get_varint("back");
        const std::uint64_t count = in.get_varint("target count");
        if (open > 0xffffffffu || back > 0xffffffffu || count > table_size || total + count > 0xffffffffu)
            in.fail("record", "a number is out of range");
        row.open = static_cast<std::uint32_t>(open);
        row.back = static_cast<std::uint32_t>(back);
        row.first = static_cast<std::uint32_t>(total);
        row.count = static_cast<std::uint32_t>(count);
        total += count;
    }
    if (total > in.remaining()) in.fail("targets", "more than the bytes that are left");
    block.target_index.resize(total);
    block.counts.resize(total);
    for (const EvidenceBlock::Row& row : block.rows) {
        std::uint64_t next = 0;
        for (std::uint32_t k = 0; k < row.count; ++k) {
            const std::uint64_t gap = in.get_varint("target gap");
            if (gap >= table_size - next) in.fail("target gap", "beyond the target table");
            block.target_index[row.first + k] = static_cast<std::uint32_t>(next + gap);
            next += gap + 1;
            if (next > table_size) in.fail("target gap", "beyond the target table");
        }
    }
    for (const EvidenceBlock::Row& row : block.rows) {
        std::uint64_t sum = std::uint64_t{row.open} + row.back;
        for (std::uint32_t k = 0; k < row.count; ++k) {
            const std::uint64_t count = in.get_varint("count");
            if (count == 0 || count > 0xffffffffu) in.fail("count", "zero or above 2^32");
            block.counts[row.first + k] = static_cast<std::uint32_t>(count);
            sum += count;
        }
        EvidenceRecord shape;
        shape.first_level = row.first_level, shape.last_level = row.last_level;
        if (sum != shape.ray_count())
            in.fail("counts", "sum " + std::to_string(sum) + " is not the number of rays, " +
                                  std::to_string(shape.ray_count()));
    }
    in.expect_end("evidence block");
    return block;
}

EvidenceBlock read_evidence_block(const BlockFileReader& file, std::size_t index) {
    const std::string where = file.name() + ": block " + std::to_string(index);
    EvidenceBlock block = decode_evidence(file.read(index), where);
    const auto tag = [&](std::size_t k) { return file.blocks()[k].tag; };
    const bool is_last = index + 1 == file.blocks().size();
    if ((index == 0 && tag(0) != 0) || (!is_last && tag(index + 1) - tag(index) != block.rows.size()))
        throw Error(
            ErrorCode::damaged_store, where,
            std::to_string(block.rows.size()) + " records, but the tags of this block and the next do not say so",
            "the file is damaged; remove it and run the same command again");
    return block;
}

EvidenceRecord record_of(const EvidenceBlock& block, std::size_t index) {
    const EvidenceBlock::Row& row = block.rows.at(index);
    EvidenceRecord record{row.patch_id, row.replicate, row.first_level, row.last_level, row.open, row.back, {}, {}};
    for (std::uint32_t k = row.first; k < row.first + row.count; ++k) {
        record.target_id.push_back(block.targets[block.target_index[k]]);
        record.count.push_back(block.counts[k]);
    }
    return record;
}

}  // namespace luxel
