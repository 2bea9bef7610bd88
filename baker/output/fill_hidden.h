/// Gives texels whose surface lies inside a solid the light of the visible surface beside it: viewers filter over them,
/// and without light of their own they would draw dark fringes where objects stand.
///
/// A hidden texel gets the mean of what it is nearest to, measured through texels of its own chart: a texel of another
/// chart that happens to lie beside it on the page is no source and no way. Distances are those of chamfer 5-7 (a step
/// straight is 5, across the corner 7; Borgefors, Distance transformations in digital images, CVGIP 34, 1986); of
/// several ways of the same length each counts its own neighbour once.
///
/// values   one per texel of a page, row 0 at the top; changed only where `mask` is hidden.
/// mask     hidden texels become filled, or empty where nothing of their chart can be reached (a chart all in solids).
/// charts   per texel the chart that it belongs to; not read where `mask` is empty.
/// Threads  pure; one page per call. Time: n log n in the hidden texels. Memory: 4 bytes per texel of the page.
/// Errors   Error{internal} for sizes that do not fit.
#pragma once
#include "baker/output/dilate.h"

namespace luxel {

void fill_hidden(std::span<Rgb> values, std::span<std::uint8_t> mask, std::span<const std::uint32_t> charts,
                 std::uint32_t width, std::uint32_t height);

}  // namespace luxel
