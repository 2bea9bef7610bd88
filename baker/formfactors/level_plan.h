/// Which levels of rays every patch gets in a round of evidence: a stage result of its own, so that rounds can be added.
///
/// A patch that has reached level k has sent replicates * 2^k rays. Rounds only ever add levels, so what was traced
/// stays valid, and the evidence of all rounds together is that of the levels reached.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "baker/formfactors/estimator.h"

namespace luxel {

/// One round.
struct LevelPlan {
    std::vector<LevelRange> levels;  ///< per patch number; empty: nothing for this patch in this round
    bool operator==(const LevelPlan&) const = default;
};

/// No patch may go beyond 2^20 rays per replicate.
constexpr std::uint8_t highest_level = 20;

/// The same levels for all patches: at least `rays` rays each, replicates * 2^k.
LevelPlan uniform_plan(std::size_t patch_count, std::uint32_t replicates, std::uint64_t rays);

/// Rays of a whole plan, or of one chunk's part of it.
std::uint64_t planned_rays(const LevelPlan& plan, std::uint32_t replicates, PatchNumber begin, PatchNumber end);
/// What the estimator really traces for it.
std::uint64_t planned_rays(const LevelPlan& plan, const Estimator& estimator, PatchNumber begin, PatchNumber end);

/// Rays in proportion to `wanted` (any scale, >= 0), each rounded to the nearest power of two (in the logarithm), as many as
/// fit into `total_rays` together with what `reached` stands for; never fewer than a patch has. `reached`: last level per
/// patch of the rounds so far. Returns the levels that are missing. Bits depend on the arguments only.
LevelPlan plan_by_want(std::span<const double> wanted, std::span<const std::uint8_t> reached, std::uint32_t replicates,
                       std::uint64_t total_rays);

/// Last level per patch after a round on top of `reached`; `reached` is empty before the first round.
std::vector<std::uint8_t> levels_after(std::span<const std::uint8_t> reached, const LevelPlan& round);

}  // namespace luxel
