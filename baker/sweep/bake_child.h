/// Runs one `luxel bake` as a process of its own, so that its memory is its own and a crash ends only itself.
///
/// The child ends with this process (Linux: at once, also when this one is killed). Threads: call from the main thread; one at a time.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "baker/core/stop.h"

namespace luxel {

struct ChildResult {
    int exit_code = 0;        ///< 128 + number where a signal ended it, as shells say it
    bool interrupted = false;  ///< the stop was asked for: it was ended
    std::string message;      ///< what it said of its failure, in one line; empty when it ended well
};

/// `log` receives standard output and error; it is replaced. Throws Error{cannot_write} (log), Error{internal} (no process).
ChildResult run_child(const std::filesystem::path& program, const std::vector<std::string>& arguments, const std::filesystem::path& log,
                      const StopRequest* stop);

/// The running program.
std::filesystem::path own_program();

}  // namespace luxel
