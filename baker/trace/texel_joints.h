/// Which neighbouring texels are one surface and which are parted by something that stands on it: a patch must not
/// reach through a wall, however thin, else the light of one side comes out on the other.
///
/// Two texels next to each other are joined if nothing crosses the short way between a visible point of each, a 64th of
/// a texel above the surface. Where the surface bends so much between them that this way might meet itself, they count
/// as joined. What is inside solids is parted from what is not. Seen from the front only.
///
/// A wall without thickness may run through a texel. Of two texels that are parted while both are visible, each has as its own what lies on
/// its point's side of the wall (Texel::own_side; patches/parted_texels.h says what follows). Threads: uses them all. A pure function of geometry; errors: none.
#pragma once
#include <optional>

#include "baker/patches/texels.h"
#include "baker/trace/tracer.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

/// The question asked of two texels, wherever they lie. Threads: const and reentrant.
class JointProbe {
  public:
    /// A point above the visible part of a texel.
    struct Post {
        Vec3f above, normal;
        std::uint32_t triangle;
    };

    JointProbe(const Scene& scene, const Atlas& atlas, const Tracer& tracer)
        : scene_(scene), atlas_(atlas), tracer_(tracer) {}

    /// On the fragment with the largest visible part; none where no ray can start.
    [[nodiscard]] std::optional<Post> post(const PageTexels& page, const Texel& texel) const;
    /// Also true if neither is there.
    [[nodiscard]] bool joined(const std::optional<Post>& a, const std::optional<Post>& b) const;

    /// What of a texel can be reached from its post, as Texel::own_side has it.
    [[nodiscard]] VisibleCells own_side(const PageTexels& page, const Texel& texel, const Post& post) const;

  private:
    [[nodiscard]] Post post_at(std::uint32_t triangle, const Vec2f& barycentric) const;

    const Scene& scene_;
    const Atlas& atlas_;
    const Tracer& tracer_;
};

/// Sets Texel::joined_right, joined_down and own_side; `texels` as find_visible_area() left them.
void find_texel_joints(const Scene& scene, const Atlas& atlas, const Tracer& tracer, TexelSet& texels);

}  // namespace luxel
