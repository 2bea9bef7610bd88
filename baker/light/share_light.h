/// Gathered light shared between texels. Light that comes from all around is smooth along a surface: what neighbours have
/// gathered tells about a texel too. Each texel gets the value of a polynomial fit over the largest disc of neighbours that its own
/// noise cannot tell from the smaller discs (intersection of confidence intervals): wide where light is even, none at
/// the edge of a shadow or in a corner. Nothing is learned or guessed: a fit of measured values, exact where light is a polynomial of
/// the second degree.
///
/// Noise is taken to go with light, so that dark texels beside bright ones know themselves well, and little leaks into them. Where a
/// texel's disc is smaller than those around it by chance only, it takes one as large as theirs, so that few dots are left on even surroundings.
///
/// Neighbours are texels of the same chart that one can walk to without crossing what stands on the surface
/// (Texel::joined_right, joined_down): no light passes a chart border or a wall.
///
/// Threads  uses them all; a pure function.
/// Source   Goldenshluger and Nemirovski, On spatially adaptive estimation of nonparametric regression, 1997, and Katkovnik, A
///          new method for varying adaptive bandwidth selection, IEEE Trans. Signal Processing 47(9) 1999 (the interval rule);
///          Katkovnik, Egiazarian, Astola, Local Approximation Techniques in Signal and Image Processing, SPIE 2006 (chosen scales are
///          ranked against those around).
#pragma once
#include <span>
#include <vector>

#include "baker/light/gather.h"
#include "baker/patches/texels.h"

namespace luxel {

struct SharedLight {
    std::vector<Rgb> irradiance;       ///< lux, >= 0
    std::vector<float> standard_error; ///< of the luminance, lux: noise that is left
    /// Of the luminance, lux, >= 0: how far the disc that was taken is likely to be off, as it differs from the next smaller one by more
    /// than noise explains; the mean over neighbours of the square of that, so a guide for areas, not for single texels.
    std::vector<float> bias;
};

/// Of the texels of a page, in their order. `most_texels`: radius of the largest disc, 0: no sharing, at most 8.
SharedLight share_light(const PageTexels& page, std::uint32_t page_size, const GatheredLight& light,
                        std::uint32_t most_texels);

}  // namespace luxel
