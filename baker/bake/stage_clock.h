/// Times stages and carries their progress to the caller.
#pragma once
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "baker/bake/bake.h"
#include "baker/core/progress.h"

namespace luxel {

class StageClock {
  public:
    StageClock(const BakeOptions& options, BakeReport& report) : options_(options), report_(report) {}

    /// Runs `body` as stage `name`; body returns true if the result was in the bake folder.
    template <class Body>
    void stage(const std::string& name, Body&& body) {
        begin(name);
        const bool reused = body();
        end(reused);
    }
    /// The running stage has its result in this file or folder of the bake folder.
    void keeps(const std::filesystem::path& result) { kept_.push_back({result.filename().string()}); }
    /// Progress of the running stage in `unit`.
    [[nodiscard]] ProgressFunction progress(const char* unit) const;
    [[nodiscard]] double last_seconds() const;

  private:
    void begin(const std::string& name);
    void end(bool reused);
    const BakeOptions& options_;
    BakeReport& report_;
    std::string name_;
    std::vector<KeptResult> kept_;
    std::chrono::steady_clock::time_point started_;
    double processor_started_ = 0;
};

}  // namespace luxel
