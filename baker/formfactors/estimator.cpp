#include "baker/formfactors/estimator.h"

#include <algorithm>

namespace luxel {

std::uint64_t ray_count(LevelRange levels) {
    EvidenceRecord shape;
    shape.first_level = levels.first, shape.last_level = levels.last;
    return shape.ray_count();
}

void collect_records(const Estimator& estimator, std::span<const PatchId> ids, PatchNumber patch, LevelRange levels,
                     std::vector<EvidenceRecord>& out) {
    std::vector<Landings> all;
    std::vector<PatchId> met;
    estimator.cast(patch, levels, all);
    for (std::size_t replicate = 0; replicate < all.size(); ++replicate) {
        const Landings& landings = all[replicate];
        EvidenceRecord record{ids[patch], static_cast<std::uint8_t>(replicate), levels.first, levels.last,
                              landings.open, landings.back, {}, {}};
        met.clear();
        for (const PatchNumber target : landings.patches) met.push_back(ids[target]);
        std::sort(met.begin(), met.end());
        for (const PatchId id : met) {
            if (record.target_id.empty() || record.target_id.back() != id) {
                record.target_id.push_back(id);
                record.count.push_back(0);
            }
            ++record.count.back();
        }
        out.push_back(std::move(record));
    }
}

}  // namespace luxel
