/// The luxel program as a child of a test.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace luxel::test {

struct ChildResult {
    int exit_code = -1;    ///< -1: ended by a signal
    bool killed = false;   ///< by us
    double seconds = 0;
};

/// Runs the program under test with these arguments, its messages appended to `log`. With kill_after_s >= 0 it gets
/// SIGKILL then, unless it has ended before.
ChildResult run_luxel(const std::vector<std::string>& arguments, const std::filesystem::path& log, double kill_after_s = -1);

/// The same, killed as soon as `is_time` says so; it is asked every half a millisecond.
ChildResult run_luxel_until(const std::vector<std::string>& arguments, const std::filesystem::path& log,
                            const std::function<bool()>& is_time);

}  // namespace luxel::test
