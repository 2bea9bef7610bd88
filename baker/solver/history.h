/// The course of a solve in at most 1000 entries: when they fill up every second one goes, and from then on only every
/// second, fourth, ... step is kept. First and last are always there. Depends on the number of steps only.
#pragma once
#include <cstddef>
#include <vector>

#include "baker/solver/solver.h"

namespace luxel {

class History {
  public:
    static constexpr std::size_t max_entries = 1000;

    void add(const SolveStep& step) {
        last_ = step;
        last_is_kept_ = count_++ % stride_ == 0;
        if (!last_is_kept_) return;
        if (steps_.size() == max_entries - 1) {
            std::size_t kept = 0;
            for (std::size_t i = 0; i < steps_.size(); i += 2) steps_[kept++] = steps_[i];
            steps_.resize(kept);
            stride_ *= 2;
            last_is_kept_ = (count_ - 1) % stride_ == 0;
        }
        if (last_is_kept_) steps_.push_back(step);
    }

    [[nodiscard]] std::vector<SolveStep> steps() const {
        std::vector<SolveStep> steps = steps_;
        if (count_ > 0 && !last_is_kept_) steps.push_back(last_);
        return steps;
    }

  private:
    std::vector<SolveStep> steps_;
    SolveStep last_;
    bool last_is_kept_ = false;
    std::size_t count_ = 0, stride_ = 1;
};

}  // namespace luxel
