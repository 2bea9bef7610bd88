#include "baker/sweep/bake_child.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include "formats/base/error.h"
#include "formats/base/file.h"

namespace luxel {
namespace {

constexpr std::chrono::milliseconds look_every{10};
constexpr std::size_t longest_message = 600;
constexpr int not_started = 127;

/// Only what is allowed between fork and exec.
[[noreturn]] void become(const char* program, char* const* arguments, int log, pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(not_started);  // it is gone already
    ::dup2(log, STDOUT_FILENO);
    ::dup2(log, STDERR_FILENO);
    ::execv(program, arguments);
    ::_exit(not_started);
}

/// From the first line that tells of an error on, without its prefix; else the last line.
std::string message_of(const std::filesystem::path& log) {
    const Bytes bytes = read_file(log);
    std::string text(bytes.begin(), bytes.end());
    constexpr std::string_view prefix = "luxel: error: ";
    if (const auto at = text.find(prefix); at != std::string::npos) text = text.substr(at + prefix.size());
    else {
        while (text.ends_with('\n')) text.pop_back();
        text = text.substr(text.find_last_of('\n') + 1);
    }
    std::string one_line;
    for (std::size_t at = 0; at < std::min(text.size(), longest_message); ++at) {
        if (text[at] != '\n') one_line += text[at];
        else if (at = text.find_first_not_of("\n ", at); at == std::string::npos) break;
        else one_line += std::string("; ") + text[at];
    }
    return one_line;
}

/// The status of the child once it has ended; ends it when that is asked for.
int wait_for(pid_t child, const StopRequest* stop, bool& interrupted) {
    int status = 0;
    for (;;) {
        const pid_t ended = ::waitpid(child, &status, WNOHANG);
        if (ended == child) return status;
        if (ended < 0 && errno != EINTR) throw Error(ErrorCode::internal, "sweep", std::string("waitpid: ") + std::strerror(errno));
        if (stop && stop->is_asked() && !interrupted) {
            interrupted = true;
            ::kill(child, SIGKILL);
        }
        std::this_thread::sleep_for(look_every);
    }
}

}  // namespace

ChildResult run_child(const std::filesystem::path& program, const std::vector<std::string>& arguments, const std::filesystem::path& log,
                      const StopRequest* stop) {
    const std::string name = program.string();
    std::vector<char*> words{const_cast<char*>(name.c_str())};
    for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) throw Error(ErrorCode::cannot_write, log.string(), std::strerror(errno));
    const pid_t parent = ::getpid(), child = ::fork();
    if (child == 0) become(name.c_str(), words.data(), file, parent);
    ::close(file);
    if (child < 0) throw Error(ErrorCode::internal, "sweep", std::string("fork: ") + std::strerror(errno));
    ChildResult result;
    const int status = wait_for(child, stop, result.interrupted);
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    // Ctrl-C on a terminal reaches both.
    result.interrupted |= stop && stop->is_asked() && result.exit_code != 0;
    if (result.exit_code != 0) {
        result.message = message_of(log);
        if (WIFSIGNALED(status)) result.message = "ended by signal " + std::to_string(WTERMSIG(status)) + (result.message.empty() ? "" : ": " + result.message);
        if (result.exit_code == not_started && result.message.empty()) result.message = name + " cannot be started";
    }
    return result;
}

std::filesystem::path own_program() { return std::filesystem::read_symlink("/proc/self/exe"); }

}  // namespace luxel
