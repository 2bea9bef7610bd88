/// What a bake of this scene will do, and what it will leave out because the scene does not need it.
#pragma once
#include <string>
#include <vector>

#include "baker/bake/geometry_stages.h"

namespace luxel {

/// A part of the bake that a scene may or may not need.
struct Decision {
    std::string part;
    bool runs = false;
    std::string why;
};

/// Of a part that can be forced: it runs if the scene needs it, or if `options` force it.
Decision decide_part(const BakeOptions& options, Part part, bool is_needed, const std::string& why);

/// In the order of the bake: all that the geometry and the materials tell. The conditions are those of the stages themselves. What only rays tell (whether
/// anything sees the sky, which patches lie in the dark, whether the blocks fit into memory) the stages add to the report.
/// Threads: a pure function. Errors: none.
std::vector<Decision> decide(const BakeOptions& options, const BakedGeometry& geometry);

/// Does anything shine, inside the scene or around it?
bool has_light(const BakedGeometry& geometry);

/// Does any light depend on form factors? Where nothing is reflected texels gather what shines, and a thin round of rays is all that is traced.
bool needs_form_factors(const BakeOptions& options, const BakedGeometry& geometry);

}  // namespace luxel
