#include "baker/bake/preview.h"

#include <algorithm>
#include <cstdio>

#include "baker/bake/light_stages.h"
#include "baker/bake/write_stage.h"
#include "baker/core/parallel.h"

namespace luxel {
namespace {

/// Time for the solve between two previews, in times of writing one.
constexpr double rest = 2;

}  // namespace

Preview::Preview(const BakeOptions& options, const BakedGeometry& geometry, const BakedSources& sources, BakeReport& report)
    : options_(options), geometry_(geometry), sources_(sources), report_(report),
      next_(Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.preview_s))) {}

void Preview::write(const SolveView& solve) {
    BakedLight light;
    light.patch_irradiance = add_lamps(solve.irradiance(true), sources_.lamp_irradiance);
    light.state = "preview";
    write_lightmaps(options_, geometry_, light, {}, {});
    flush_denormals();  // whatever the libraries did to this thread: the solve goes on as it was
}

void Preview::show(const SolveView& solve) {
    const auto begin = Clock::now();
    if (options_.preview_s <= 0 || begin < next_) return;
    write(solve);
    const std::chrono::duration<double> seconds = Clock::now() - begin;
    ++report_.previews;
    report_.preview_seconds += seconds.count();
    const double pause = std::max(options_.preview_s - seconds.count(), rest * seconds.count());
    if (pause > options_.preview_s && !is_held_back_) {
        is_held_back_ = true;
        char text[128];
        std::snprintf(text, sizeof text, "one takes %.2g s to write, so they come every %.2g s: at most a third of the time is theirs",
                      seconds.count(), pause + seconds.count());
        report_.skipped.push_back({"previews", text});
    }
    next_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pause));
}

}  // namespace luxel
