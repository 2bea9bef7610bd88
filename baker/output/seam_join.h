/// Makes the two sides of a seam show the same light: least squares over the texels that a bilinear filter reads there,
///
///     sum over points of length * |bilinear_a - bilinear_b|^2  +  sum over texels of stiffness * |x - x0|^2
///
/// is made smallest, per channel, within bounds: a texel stays between the smallest and the largest of what is read together with it at
/// the points it takes part in, so that nothing becomes negative or rings. Texels of the padding hold no light of their
/// own and are softer than covered ones: where a border follows the grid, they alone give in, and the map shows what it
/// would without a cut. Nothing but these texels changes: the surface one texel behind the seam keeps every bit.
///
/// Source: Iwanicki, Lighting technology of "The Last of Us", SIGGRAPH 2013 talks, for the least squares. They are solved
/// by conjugate gradients (Hestenes and Stiefel 1952) with the diagonal as preconditioner, without a matrix, apart for
/// each set of texels that hang together; bounds by fixing what leaves them and solving again for the rest.
///
/// Threads: uses them all, a set each; sums are serial inside a set, so the result depends on nothing else.
/// Time: linear; the stiffness bounds the condition, and so the iterations, whatever the size.
/// Errors: Error{internal} for sizes that do not fit.
#pragma once
#include "baker/output/seam_samples.h"

namespace luxel {

/// What a texel of SeamSamples::texels is before the join.
enum class SeamTexelKind : std::uint8_t {
    covered,  ///< surface with light of its own
    filled,   ///< padding, or surface inside a solid: light of its neighbours
    empty     ///< no value at all: points that read it are left out
};

/// How far the sides differ, over all points that are joined.
struct SeamJump {
    double before = 0, after = 0;  ///< mean of |a - b| over mean of (a + b) / 2, luminance; 0 where all is dark
    double length_texels = 0;      ///< of all that is joined
    std::uint64_t texels = 0;      ///< whose value has changed
};

/// `values`: one per texel of samples.texels, lux, finite and >= 0; `kinds` alike.
SeamJump join_seams(const SeamSamples& samples, std::span<const SeamTexelKind> kinds, std::span<Rgb> values);

/// Resident bytes, at most, of sampling and joining these seams; the list itself is not counted.
std::uint64_t seam_join_bytes(std::span<const Seam> seams);

}  // namespace luxel
