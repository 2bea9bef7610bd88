#include "baker/bake/evidence_rounds.h"

#include "baker/bake/estimator_choice.h"
#include "baker/formfactors/evidence.h"

namespace luxel {

EvidenceRounds::EvidenceRounds(const BakeOptions& options, const BakedGeometry& geometry, const BakeFolder& folder)
    : options_(options), geometry_(geometry), folder_(folder), estimator_(make_estimator(options, geometry)) {
    for (const Patch& patch : geometry.patches.patches) ids_.push_back(patch.id);
}

EvidenceRounds::~EvidenceRounds() = default;

std::uint32_t EvidenceRounds::replicates() const { return estimator_->replicate_count(); }

std::uint64_t EvidenceRounds::rays_at(std::uint8_t level) const { return estimator_->rays_of({0, level}); }

bool EvidenceRounds::extensible() const { return options_.estimator == EstimatorKind::ray; }

Key EvidenceRounds::plan_key(std::uint32_t round) const {
    return KeyBuilder("plan 1")
        .key(geometry_.layout_key)
        .key(estimator_->identity())
        .integer(static_cast<std::int64_t>(options_.rays))
        .number(options_.error)
        .integer(options_.importance)
        .integer(round)
        .finish();
}

void EvidenceRounds::add(const LevelPlan& plan, StageClock& clock, BakeReport& report) {
    KeyBuilder builder("evidence 2");
    builder.key(geometry_.layout_key).key(estimator_->identity());
    for (const LevelRange& levels : plan.levels) builder.integer(levels.first).integer(levels.last);
    const Key key = builder.finish();
    const ChunkLayout& layout = geometry_.layout;
    const std::uint64_t rays = planned_rays(plan, *estimator_, 0, layout.patch_count());
    const auto place = folder_.evidence(key);
    clock.stage("evidence", [&] {
        ProgressCounter progress(rays, clock.progress("rays"));
        bool reused = true;
        for (ChunkNumber chunk = 0; chunk < layout.chunk_count(); ++chunk) {
            files_.push_back({BakeFolder::evidence_file(place, chunk), key});
            const auto& path = files_.back().path;
            if (block_file_is_whole(path, FileKind::evidence, evidence_version, key)) {
                progress.add(planned_rays(plan, *estimator_, layout.first_patch[chunk], layout.first_patch[chunk + 1]));
                continue;
            }
            reused = false;
            write_chunk_evidence(*estimator_, layout, ids_, chunk, plan, path, key, &progress);
        }
        return reused;
    });
    reached_ = levels_after(reached_, plan);
    total_rays_ += rays;
    key_ = KeyBuilder("evidence of rounds 1").key(key_).key(key).finish();
    ++rounds_;
    report.evidence_rays = total_rays_;
    report.evidence_rounds = rounds_;
    report.evidence_seconds += clock.last_seconds();
}

}  // namespace luxel
