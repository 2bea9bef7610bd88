/// The second UV set of an object as its chart, if it is fit for a lightmap.
#pragma once
#include <optional>
#include <string>

#include "baker/unwrap/chart_shape.h"

namespace luxel {

/// One chart with the whole layout of Scene::uv[1], scaled so that its area is the object's area; relative places stay.
/// Nothing, and `why_not` set, if coordinates do not fit into one tile of 1 x 1 at whole numbers (0..1, or any other), have no area, or
/// overlap on more than a thousandth of theirs. It says how many triangles that are, which, and a coordinate to look at.
std::optional<FlatChart> kept_chart(const Scene& scene, const Object& object, const ObjectMesh& mesh,
                                    double samples_per_metre, std::string& why_not);

}  // namespace luxel
