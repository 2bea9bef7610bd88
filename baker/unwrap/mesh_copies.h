/// Which instances show the same mesh and can share one layout of it, so that its geometry is stored once.
///
/// Copies that differ by rotation, mirror image and place only always share. Copies of other sizes share the layout of the
/// largest one, stretched, as long as no direction on them is more than 4 times shorter than there (they get at most 16 times
/// the texels that they need) nor more than 2^(1/4) times longer (one step of the automatic density): mesh_copies.cpp.
/// Pure and deterministic. Errors: none.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/scene/scene.h"

namespace luxel {

/// The objects of one instance: they follow each other in Scene::objects.
struct ObjectRun {
    std::uint32_t first = 0, count = 0;
};

/// Instances with one layout, which is made for the first of them; the others in the scene's order.
struct CopyGroup {
    std::vector<ObjectRun> instances;
};

/// Groups of two and more, and groups of one where the instance shares its node (Object::shares_node): its place must be an attribute.
/// Instances without a lightmap are left out, and those with different densities of their own do not share; `density` is that of all
/// others, texels per metre. Instances of more than `most_texels`, whose layout cannot be one block of a page, share with their like only.
std::vector<CopyGroup> find_copies(const Scene& scene, double density, double most_texels);

}  // namespace luxel
