/// Surfaces that reflect all light, reflectance exactly 1: common (glTF's default colour), harmless where something else absorbs
/// or the scene is open, and without an answer where light has no way out.
///
/// Whether there is a way out is known only as well as rays can tell, and a crack between two white surfaces must not cost a scene
/// its light. So the solve takes 1 as 1 - 1/(2N), N the rays of the patch: what half a ray would have found. That share of what
/// arrives ends there, though nothing in the scene absorbs it: fictive light.
///
/// The rule, in each channel: up to some_fictive of all light that ends (absorbed, or lost into the open) it is as small as other
/// errors of a bake, and nothing is said. Above, there is a warning. But where it is more than most_fictive of what ends in a part of
/// the scene that exchanges no light with the rest, and that part ends at least some_fictive of all light, the light never ends:
/// Error{bad_input}. Error and warning name the materials, the one with the most fictive light first.
///
/// Cost     nothing up to some_fictive; above, one read of the matrix, which finds the parts.
#pragma once
#include "baker/bake/solve_stage.h"

namespace luxel {

/// What is left is openings and absorbers that a few rays found by chance.
constexpr double most_fictive = 0.99;
constexpr double some_fictive = 0.01;

/// Reflectance per patch as the solve takes it.
std::vector<Rgb> solvable_reflectances(const PatchSet& patches, const RayTallies& tallies);

/// Applies the rule to the final solution, whose sums the report has.
void judge_endless_light(const BakeOptions& options, const BakedGeometry& geometry, const BakedMatrix& matrix,
                         const BakedSolution& solution, BakeReport& report);

}  // namespace luxel
