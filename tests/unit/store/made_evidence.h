/// Evidence made up at random, its files cut in any way, and what pooling must make of it.
#pragma once
#include <map>
#include <random>
#include <set>

#include "baker/store/pooling.h"
#include "baker/store/strip_store.h"
#include "formats/bake/evidence_file.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {

using PairCounts = std::map<std::pair<PatchNumber, PatchNumber>, std::uint64_t>;

struct MadeEvidence {
    ChunkLayout layout;
    std::vector<PatchId> ids;
    std::vector<EvidenceRecord> records;

    /// c_ij for i < j by plain counting.
    [[nodiscard]] PairCounts pooled() const {
        const auto number = numbers();
        PairCounts counts;
        for (const EvidenceRecord& record : records) {
            const PatchNumber i = number.at(record.patch_id);
            for (std::size_t k = 0; k < record.count.size(); ++k) {
                const PatchNumber j = number.at(record.target_id[k]);
                if (i != j) counts[std::minmax(i, j)] += record.count[k];
            }
        }
        return counts;
    }
    [[nodiscard]] RayTallies tallies() const {
        const auto number = numbers();
        const std::vector<std::uint32_t> zero(ids.size());
        RayTallies tallies{zero, zero, zero, zero};
        for (const EvidenceRecord& record : records) {
            const PatchNumber i = number.at(record.patch_id);
            tallies.rays[i] += static_cast<std::uint32_t>(record.ray_count());
            tallies.open[i] += record.open;
            tallies.back[i] += record.back;
            for (std::size_t k = 0; k < record.count.size(); ++k)
                if (record.target_id[k] == record.patch_id) tallies.self[i] += record.count[k];
        }
        return tallies;
    }

  private:
    [[nodiscard]] std::map<PatchId, PatchNumber> numbers() const {
        std::map<PatchId, PatchNumber> number;
        for (PatchNumber p = 0; p < ids.size(); ++p) number[ids[p]] = p;
        return number;
    }
};

/// `targets` distinct targets per record and `replicates` records of two level ranges per patch. A few counts need more
/// than 16 bits.
inline MadeEvidence random_evidence(const std::vector<std::uint32_t>& chunk_sizes, std::size_t targets,
                                    std::uint32_t replicates, unsigned seed) {
    std::mt19937_64 random(seed);
    MadeEvidence made;
    for (const std::uint32_t size : chunk_sizes)
        made.layout.first_patch.push_back(made.layout.first_patch.back() + size);
    std::set<PatchId> ids;
    while (ids.size() < made.layout.patch_count()) ids.insert(random());
    made.ids.assign(ids.begin(), ids.end());
    std::shuffle(made.ids.begin(), made.ids.end(), random);
    for (const PatchId id : made.ids)
        for (std::uint32_t k = 0; k < 2 * replicates; ++k) {
            EvidenceRecord record;
            record.patch_id = id;
            record.replicate = static_cast<std::uint8_t>(k / 2);
            record.first_level = k % 2 ? 9 : 0;
            record.last_level = k % 2 ? (random() % 50 ? 10 : 18) : 8;
            std::uint64_t rays = record.ray_count();
            std::set<PatchId> met;
            while (met.size() < std::min(targets, made.ids.size())) met.insert(made.ids[random() % made.ids.size()]);
            for (const PatchId target : met) {
                if (rays < 2) break;
                const std::uint64_t count = 1 + random() % (rays > 1000 ? rays - 1 : 3) % rays;
                record.target_id.push_back(target);
                record.count.push_back(static_cast<std::uint32_t>(count));
                rays -= count;
            }
            record.open = static_cast<std::uint32_t>(rays / 3);
            record.back = static_cast<std::uint32_t>(rays - rays / 3);
            made.records.push_back(std::move(record));
        }
    return made;
}

constexpr Key evidence_key{11, 12}, strip_key{21, 22};

/// Files of `per_file` records in blocks of `per_block`, in the records' order.
inline std::vector<std::filesystem::path> write_evidence(const std::filesystem::path& folder,
                                                         std::span<const EvidenceRecord> records, std::size_t per_file,
                                                         std::size_t per_block, const std::string& name = "evidence") {
    std::vector<std::filesystem::path> files;
    for (std::size_t begin = 0; begin < records.size(); begin += per_file) {
        const std::size_t end = std::min(records.size(), begin + per_file);
        files.push_back(folder / (name + std::to_string(files.size())));
        BlockFileWriter file(files.back(), FileKind::evidence, evidence_version, evidence_key);
        for (std::size_t at = begin; at < end; at += per_block)
            file.append(at - begin, encode_evidence(records.subspan(at, std::min(per_block, end - at))), 1);
        file.publish();
    }
    return files;
}

/// The files with the key that they were written with.
inline std::vector<EvidenceFile> keyed(std::span<const std::filesystem::path> files, const Key& key = evidence_key) {
    std::vector<EvidenceFile> all;
    for (const auto& path : files) all.push_back({path, key});
    return all;
}

/// Pools into a new folder `name`; returns it.
inline std::filesystem::path pool(const TemporaryFolder& folder, const MadeEvidence& made,
                                  std::span<const std::filesystem::path> files, const std::string& name,
                                  std::uint64_t memory_bytes = std::uint64_t{1} << 30) {
    const auto strips = folder / name;
    std::filesystem::create_directory(strips);
    pool_evidence(made.layout, made.ids, keyed(files), strips, strip_key, {memory_bytes, folder.path()}, {});
    return strips;
}

inline PairCounts counts_of(const StripStore& store) {
    PairCounts counts;
    CountBlock block;
    for (std::size_t k = 0; k < store.block_count(); ++k) {
        store.load(k, block);
        const PatchNumber row_first = store.layout().first_patch[block.a],
                          column_first = store.layout().first_patch[block.b];
        for (std::uint32_t row = 0; row + 1 < block.row_begin.size(); ++row)
            for (std::uint32_t p = block.row_begin[row]; p < block.row_begin[row + 1]; ++p)
                counts[{row_first + row, column_first + block.columns[p]}] += block.counts[p];
    }
    return counts;
}

}  // namespace luxel::test
