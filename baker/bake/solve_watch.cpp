#include "baker/bake/solve_watch.h"

#include "baker/bake/stage_files.h"
#include "baker/bake/stopping.h"

namespace luxel {

SolveWatch::SolveWatch(const BakeOptions& options, std::filesystem::path checkpoint, const Key& key, ProgressFunction progress,
                       Preview* preview)
    : options_(options), checkpoint_(std::move(checkpoint)), key_(key), progress_(std::move(progress)), preview_(preview) {}

void SolveWatch::finish() {
    if (writing_.valid()) writing_.get();
}

void SolveWatch::save(const SolveView& solve) {
    if (options_.work.empty()) return;
    finish();
    last_ = Clock::now();
    writing_ = std::async(std::launch::async, [path = checkpoint_, key = key_, state = solve.state()] { save_checkpoint(path, key, state); });
}

bool SolveWatch::step(const SolveView& solve) {
    ++steps_;
    if (progress_) progress_(solve.bytes_read() / 4096, 0);
    // The first look shows where the solve began: nothing that a picture needs, and those that are stopped each time they run
    // would never come any further.
    const bool has_moved = steps_ > 1;
    if (has_moved && is_stopping(options_)) {
        stopped_ = true;
        save(solve);
        finish();
        return false;
    }
    const std::chrono::duration<double> since_last = Clock::now() - last_;
    const bool is_idle = !writing_.valid() || writing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    if (options_.checkpoint_s == 0 || (since_last.count() >= options_.checkpoint_s && is_idle)) save(solve);
    if (has_moved && preview_) preview_->show(solve);
    return true;
}

}  // namespace luxel
