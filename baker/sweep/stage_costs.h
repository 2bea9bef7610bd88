/// What stages cost to compute, by the name of their results: so that a bake that found some of them in the shared bake folder is known
/// for what it would have taken from nothing.
///
/// A stage that was reused is charged with the time and memory of the run that made it. What lies between two rounds of rays (matrix
/// and solve that choose where the next rays go) is done no more once the choice is known; so a reused choice, "importance", stands for
/// everything since the round before it. A result that the same run made before is taken at what it costs to read.
///
/// Threads  one at a time.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "baker/sweep/bake_run.h"

namespace luxel {

struct StageCost {
    std::string name;
    double seconds = 0;
    std::uint64_t peak_bytes = 0;
    double processor_seconds = 0;  ///< of all threads
    bool operator==(const StageCost&) const = default;
};

class StageCosts {
  public:
    /// The stages of this run as they would have been from nothing, in order; what it made is known from now on. Throws Error{internal}
    /// where a reused result is unknown.
    std::vector<StageCost> whole(const BakeRun& run);

    /// The file beside a bake folder that remembers them. load() throws Error{bad_input} on one that is damaged.
    void save(const std::filesystem::path& path) const;
    static StageCosts load(const std::filesystem::path& path);

  private:
    std::map<std::string, std::vector<StageCost>> made_;
};

double total_seconds(const std::vector<StageCost>& stages);
double total_processor_seconds(const std::vector<StageCost>& stages);
std::uint64_t highest_peak(const std::vector<StageCost>& stages);

}  // namespace luxel
