/// Which way form factors are found.
#pragma once
#include <memory>

#include "baker/bake/geometry_stages.h"
#include "baker/formfactors/estimator.h"

namespace luxel {

/// Rays per patch of a first round that others may follow.
constexpr std::uint64_t thin_round_rays = 64;

/// Levels of a patch that gets so many rays at once: of the hemicube all that there are.
LevelRange first_levels(const BakeOptions& options, std::uint64_t rays);

/// The geometry must outlive the estimator.
std::unique_ptr<Estimator> make_estimator(const BakeOptions& options, const BakedGeometry& geometry);

}  // namespace luxel
