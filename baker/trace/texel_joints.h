/// Which neighbouring texels are one surface and which are parted by something that stands on it: a patch must not
/// reach through a wall, however thin, else the light of one side comes out on the other.
///
/// Two texels next to each other are joined if nothing crosses the short way between a visible point of each, a 64th of
/// a texel above the surface. Where the surface bends so much between them that this way might meet itself, they count
/// as joined. What is inside solids is parted from what is not. Seen from the front only. Threads: uses them all. A
/// pure function of geometry; errors: none.
#pragma once
#include "baker/patches/texels.h"
#include "baker/trace/tracer.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// Sets Texel::joined_right and joined_down; `texels` as find_visible_area() left them.
void find_texel_joints(const Scene& scene, const Atlas& atlas, const Tracer& tracer, TexelSet& texels);

}  // namespace luxel
