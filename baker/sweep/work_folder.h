/// A bake folder that the bakes of a sweep share, with what its stages took to make (stage_costs.h) in a file beside it.
///
/// Open: a mark beside the folder says that a bake is at work. It is taken away by whole(), after the bake has ended well. A folder that
/// still has its mark when it is opened has stages that are half done: it is removed, and begun anew.
/// Threads  one at a time. Errors: Error{cannot_write}.
#pragma once
#include <filesystem>
#include <vector>

#include "baker/sweep/stage_costs.h"

namespace luxel {

class WorkFolder {
  public:
    explicit WorkFolder(std::filesystem::path folder);
    [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
    /// The bake that opened it has ended well: what its stages would have taken from nothing.
    std::vector<StageCost> whole(const BakeRun& run);

  private:
    std::filesystem::path folder_, mark_, costs_path_;
    StageCosts costs_;
};

}  // namespace luxel
