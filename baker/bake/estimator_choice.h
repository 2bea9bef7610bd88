/// Which way form factors are found.
#pragma once
#include <memory>

#include "baker/bake/geometry_stages.h"
#include "baker/formfactors/estimator.h"

namespace luxel {

/// The geometry must outlive the estimator.
std::unique_ptr<Estimator> make_estimator(const BakeOptions& options, const BakedGeometry& geometry);

}  // namespace luxel
