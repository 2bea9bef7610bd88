#include "baker/formfactors/estimator.h"

#include <algorithm>
#include <utility>

namespace luxel {

std::uint64_t ray_count(LevelRange levels) {
    if (levels.empty()) return 0;
    EvidenceRecord shape;
    shape.first_level = levels.first, shape.last_level = levels.last;
    return shape.ray_count();
}

std::uint64_t Estimator::rays_of(LevelRange levels) const { return ray_count(levels) * replicate_count(); }

void collect_records(const Estimator& estimator, std::span<const PatchId> ids, PatchNumber patch, LevelRange levels,
                     std::vector<EvidenceRecord>& out) {
    std::vector<Landings> all;
    std::vector<std::pair<PatchId, std::uint32_t>> met;
    estimator.cast(patch, levels, all);
    for (std::size_t replicate = 0; replicate < all.size(); ++replicate) {
        const Landings& landings = all[replicate];
        EvidenceRecord record{ids[patch], static_cast<std::uint8_t>(replicate), levels.first, levels.last,
                              landings.open, landings.back, {}, {}};
        met.clear();
        for (std::size_t k = 0; k < landings.patches.size(); ++k)
            met.emplace_back(ids[landings.patches[k]], landings.weights.empty() ? 1 : landings.weights[k]);
        std::sort(met.begin(), met.end());
        for (const auto& [id, weight] : met) {
            if (record.target_id.empty() || record.target_id.back() != id) {
                record.target_id.push_back(id);
                record.count.push_back(0);
            }
            record.count.back() += weight;
        }
        out.push_back(std::move(record));
    }
}

}  // namespace luxel
