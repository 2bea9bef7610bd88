/// Any blocks as an evidence file: refused as a damaged store, or records that are, written again, the same, and that
/// pooling refuses or turns into strips that can be read.
#include <cstddef>

#include "baker/store/pooling.h"
#include "baker/store/strip_store.h"
#include "formats/bake/evidence_file.h"
#include "tests/fuzz/fuzz_file.h"

namespace luxel {
namespace {

std::vector<EvidenceRecord> records_of(const BlockFileReader& file) {
    std::vector<EvidenceRecord> records;
    for (std::size_t k = 0; k < file.blocks().size(); ++k) {
        const EvidenceBlock block = read_evidence_block(file, k);
        for (std::size_t row = 0; row < block.rows.size(); ++row) records.push_back(record_of(block, row));
    }
    return records;
}

void check(const EvidenceRecord& record) {
    std::uint64_t sum = std::uint64_t{record.open} + record.back;
    fuzz::require(record.target_id.size() == record.count.size());
    for (std::size_t k = 0; k < record.count.size(); ++k) {
        fuzz::require(record.count[k] > 0 && (k == 0 || record.target_id[k - 1] < record.target_id[k]));
        sum += record.count[k];
    }
    fuzz::require(sum == record.ray_count());
}

/// Patches 1 to 12 in two chunks: other ids are refused.
void pool(const std::filesystem::path& path) {
    const ChunkLayout layout{{0, 5, 12}};
    std::vector<PatchId> ids;
    for (PatchId id = 1; id <= layout.patch_count(); ++id) ids.push_back(id);
    const auto strips = fuzz::scratch_folder() / "strips";
    std::filesystem::remove_all(strips);
    std::filesystem::create_directory(strips);
    const std::vector<EvidenceFile> files{{path, fuzz::key}};
    const bool pooled = fuzz::accepts([&] {
        pool_evidence(layout, ids, files, strips, fuzz::key, {1 << 20, fuzz::scratch_folder()}, {});
    });
    if (!pooled) return;
    const StripStore store(strips, fuzz::key, layout);
    CountBlock block;
    for (std::size_t k = 0; k < store.block_count(); ++k) store.load(k, block);
}

}  // namespace
}  // namespace luxel

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace luxel;
    const auto path = fuzz::scratch_file(fuzz::contents_from({data, size}, FileKind::evidence, evidence_version));
    std::vector<EvidenceRecord> records;
    const BlockFileReader file(path, FileKind::evidence, evidence_version, &fuzz::key);
    if (!fuzz::accepts([&] { records = records_of(file); })) return 0;
    for (const EvidenceRecord& record : records) check(record);
    const EvidenceBlock again = decode_evidence(encode_evidence(records), "again");
    fuzz::require(again.rows.size() == records.size());
    for (std::size_t row = 0; row < records.size(); ++row) fuzz::require(record_of(again, row) == records[row]);
    pool(path);
    return 0;
}
