#include "baker/bake/evidence_rounds.h"

#include "baker/bake/estimator_choice.h"
#include "baker/bake/stopping.h"
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
    return KeyBuilder("plan 2")
        .key(geometry_.layout_key)
        .key(estimator_->identity())
        .integer(static_cast<std::int64_t>(options_.rays))
        .number(options_.error)
        .integer(options_.importance)
        .integer(round)
        .finish();
}

std::unique_ptr<EvidenceSource> EvidenceRounds::source() const {
    if (options_.store == StoreKind::all) return std::make_unique<EvidenceFiles>(files_);
    return std::make_unique<TracedEvidence>(*estimator_, geometry_.layout, ids_, plans_);
}

LevelPlan EvidenceRounds::all_levels() const {
    LevelPlan all;
    for (const std::uint8_t last : reached_) all.levels.push_back({0, last});
    return all;
}

bool EvidenceRounds::write(const LevelPlan& plan, const Key& key, StageClock& clock, BakeReport& report) {
    const ChunkLayout& layout = geometry_.layout;
    const auto place = folder_.evidence(key);
    const std::size_t files_before = files_.size();
    bool is_whole = true;
    clock.stage("evidence", [&] {
        clock.keeps(place);
        ProgressCounter progress(planned_rays(plan, *estimator_, 0, layout.patch_count()), clock.progress("rays"));
        Publisher publisher;
        bool reused = true;
        for (ChunkNumber chunk = 0; chunk < layout.chunk_count(); ++chunk) {
            files_.push_back({BakeFolder::evidence_file(place, chunk), key});
            const auto& path = files_.back().path;
            const std::uint64_t rays = planned_rays(plan, *estimator_, layout.first_patch[chunk], layout.first_patch[chunk + 1]);
            if (block_file_is_whole(path, FileKind::evidence, evidence_version, key)) {
                progress.add(rays);
                continue;
            }
            reused = false;
            if (is_stopping(options_)) {
                is_whole = false;
                break;
            }
            write_chunk_evidence(*estimator_, layout, ids_, chunk, plan, path, key, publisher, &progress);
            report.rays_traced += rays;
        }
        publisher.finish();
        return reused;
    });
    report.evidence_seconds += clock.last_seconds();
    if (!is_whole) files_.resize(files_before);
    return is_whole;
}

bool EvidenceRounds::add(const LevelPlan& plan, StageClock& clock, BakeReport& report) {
    KeyBuilder builder("evidence 2");
    builder.key(geometry_.layout_key).key(estimator_->identity());
    for (const LevelRange& levels : plan.levels) builder.integer(levels.first).integer(levels.last);
    const Key key = builder.finish();
    if (options_.store == StoreKind::all) {
        if (!write(plan, key, clock, report)) return false;
    } else {
        if (is_stopping(options_)) return false;
        plans_.push_back(plan);
    }
    reached_ = levels_after(reached_, plan);
    total_rays_ += planned_rays(plan, *estimator_, 0, geometry_.layout.patch_count());
    round_keys_.push_back(key);
    key_ = KeyBuilder("evidence of rounds 1").key(key_).key(key).finish();
    ++rounds_;
    report.evidence_rays = total_rays_;
    report.evidence_rounds = rounds_;
    return true;
}

}  // namespace luxel
