/// Points along seams, and the texels that a bilinear filter reads there on either side.
///
/// Points lie half a texel of the denser side apart at most. A point is left out
/// - where something stands on the seam: the straight way from the visible part of the texel on one side to that on
///   the other is not free (trace/texel_joints.h asks the same inside charts). The light jumps there in truth;
/// - where the surface beside it lies inside a solid on either side: there is no light to compare;
/// - where charts are packed so closely that the filter reads texels of another one (padding 0): they are not ours.
///
/// Threads: uses them all; the result depends on nothing else. Errors: none.
#pragma once
#include <array>
#include <span>
#include <tuple>

#include "baker/output/seam_edges.h"
#include "baker/patches/texels.h"
#include "baker/trace/tracer.h"

namespace luxel {

/// A texel that a filter reads at a seam, with surface or in the padding.
struct SeamTexel {
    std::uint32_t page = 0;
    std::uint16_t x = 0, y = 0;
    auto operator<=>(const SeamTexel& other) const {
        return std::tuple(page, y, x) <=> std::tuple(other.page, other.y, other.x);
    }
    bool operator==(const SeamTexel&) const = default;
};

/// What one side reads: value = sum of weight * texel; weights are >= 0 and sum to 1.
struct SeamTap {
    std::array<std::uint32_t, 4> texel{};  ///< into SeamSamples::texels
    std::array<float, 4> weight{};
};

struct SeamSample {
    SeamTap a, b;
    float length = 0;  ///< of the stretch that it stands for, in texels of the denser side, > 0
};

struct SeamSamples {
    std::vector<SeamTexel> texels;                       ///< by page, then in raster order; each once
    std::vector<SeamSample> samples;                     ///< along the seams, in their order
    std::uint64_t blocked = 0, hidden = 0, crowded = 0;  ///< points left out: see above, in that order
};

SeamSamples sample_seams(const Scene& scene, const Atlas& atlas, const TexelSet& texels, const Tracer& tracer,
                         std::span<const Seam> seams);

/// Points that sample_seams() looks at.
std::uint64_t seam_point_count(std::span<const Seam> seams);

/// What a bilinear filter with its coordinates clamped to the page reads at (u, v), texels of the page.
struct BilinearTap {
    std::array<std::uint32_t, 4> x{}, y{};
    std::array<float, 4> weight{};
};
BilinearTap bilinear_tap(const Vec2f& at, std::uint32_t page_size);

}  // namespace luxel
