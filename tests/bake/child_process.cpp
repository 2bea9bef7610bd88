#include "tests/bake/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "tests/bake/whole_bake.h"

namespace luxel::test {
namespace {

pid_t start(const std::vector<std::string>& arguments, const std::filesystem::path& log) {
    const std::string program = luxel_program().string();
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const int output = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    const pid_t child = ::fork();
    if (child < 0) throw std::runtime_error("cannot fork");
    if (child == 0) {
        ::dup2(output, STDOUT_FILENO);
        ::dup2(output, STDERR_FILENO);
        ::execv(program.c_str(), argv.data());
        ::_exit(127);
    }
    ::close(output);
    return child;
}

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

}  // namespace

ChildResult run_luxel_until(const std::vector<std::string>& arguments, const std::filesystem::path& log,
                            const std::function<bool()>& is_time) {
    const auto begin = Clock::now();
    const pid_t child = start(arguments, log);
    ChildResult result;
    int status = 0;
    while (::waitpid(child, &status, WNOHANG) == 0) {
        if (is_time()) {
            result.killed = true;
            ::kill(child, SIGKILL);
            ::waitpid(child, &status, 0);
            break;
        }
        std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
    result.seconds = seconds_since(begin);
    if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status), result.killed = false;
    return result;
}

ChildResult run_luxel(const std::vector<std::string>& arguments, const std::filesystem::path& log, double kill_after_s) {
    const auto begin = Clock::now();
    return run_luxel_until(arguments, log, [&] { return kill_after_s >= 0 && seconds_since(begin) >= kill_after_s; });
}

}  // namespace luxel::test
