/// The light of a solve that has not ended, as lightmaps in the place of the output: patches with their ambient light
/// (SolveView::irradiance) and that of the lamps, interpolated, with their seams. What the bake writes at its end takes their place.
///
/// Never more than a third of the time: after one that took t seconds the next comes 2 t later at the earliest. Memory: the
/// light and a page beside the solve, which plan_memory() counts.
#pragma once
#include <chrono>

#include "baker/bake/solve_stage.h"

namespace luxel {

class Preview {
  public:
    /// The first one comes options.preview_s from now. References must outlive it.
    Preview(const BakeOptions& options, const BakedGeometry& geometry, const BakedSources& sources, BakeReport& report);
    /// Between two steps of a solve: writes one if it is time for it. Throws Error{cannot_write}.
    void show(const SolveView& solve);

  private:
    using Clock = std::chrono::steady_clock;
    void write(const SolveView& solve);

    const BakeOptions& options_;
    const BakedGeometry& geometry_;
    const BakedSources& sources_;
    BakeReport& report_;
    Clock::time_point next_;
    bool is_held_back_ = false;
};

}  // namespace luxel
