/// Which two-sided surfaces show the light their wrong side: fronts in the dark, backs in the light.
///
/// Exporters set doubleSided and then leave it to chance how triangles are wound: panels that face into the wall behind them, rooms
/// whose walls face outwards. A texel holds the light of one side (design: of the front), and viewers show it on both, so such
/// surfaces come out black. A few paths of light from each side tell.
#pragma once
#include <vector>

#include "baker/trace/tracer.h"
#include "baker/unwrap/atlas.h"

namespace luxel {

struct DarkFronts {
    std::vector<bool> charts;       ///< per chart of the atlas: its front is dark and its back is not
    double area_m2 = 0;             ///< of these charts
    std::uint32_t chart_count = 0;  ///< how many they are
    std::vector<bool> unlit;        ///< per chart, if it was asked for: it has a lightmap, and no path found light on its front
};

/// A front is dark if less than a hundredth of the light of the back falls on it, in the mean over the chart, with all bounces; less than a
/// twentieth where it sees into a crack, a tenth as deep as what the back sees; and if at most one path in eight finds any there. Nor is it dark unless
/// it is so beside what fronts usually get (the median by area of those with light): the front of a lamp's shade, or the inside of a wall in the sun, is not.
/// One-sided surfaces have no other side, and what has no lightmap shows none.
/// A pure function of scene and atlas. Threads: uses them all. Errors: none.
/// Source: unidirectional path tracing with next event estimation (Kajiya 1986), 64 paths from each side. A front whose light comes along
/// few ways may be missed: along one path in a hundred, by all of them with a chance of one half.
/// `find_unlit`: follow all paths of charts on which no light was found yet; takes longer where much is dark.
DarkFronts find_dark_fronts(const Scene& scene, const Atlas& atlas, const Tracer& tracer, bool find_unlit = false);

}  // namespace luxel
