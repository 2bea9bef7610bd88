/// Light of the sky on the patches.
///
/// "sky view"  which directions of the open sky each patch sees; in the bake folder under a name made of geometry alone, so that
///             another sky needs none of these rays again. Only where a sky is asked for.
/// "sky"       the sky multiplied in, and shadow rays to what is far brighter in it than around it (light/sky_split.h).
#pragma once
#include <memory>

#include "baker/bake/bake_folder.h"
#include "baker/bake/geometry_stages.h"
#include "baker/formfactors/sky_in_view.h"

namespace luxel {

/// Name of what "sky view" leaves.
Key sky_view_key(const BakeOptions& options, const BakedGeometry& geometry);

/// Adds the sky's irradiance to that of each patch, lux, and returns the sky as patches see it. Null: there is none, or none sees it.
/// Throws Error{stopped_early} when it was asked to stop before the rays were traced.
std::unique_ptr<const SkyInView> add_sky_light(const BakeOptions& options, const BakedGeometry& geometry, const BakeFolder& folder,
                                               std::vector<Rgb>& irradiance, StageClock& clock, BakeReport& report);

}  // namespace luxel
