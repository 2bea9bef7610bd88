#include "tools/luxel/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <string_view>

namespace luxel {
namespace {

constexpr std::array signals{SIGINT, SIGTERM};
/// A handler has no other way to its data.
std::atomic<StopRequest*> asked_request{nullptr};
std::atomic<bool> on_terminal{false};

void let_go() {
    for (const int number : signals) {
        struct sigaction present {};
        if (::sigaction(number, nullptr, &present) == 0 && present.sa_handler != SIG_IGN) ::signal(number, SIG_DFL);
    }
}

/// Only what POSIX allows in a handler.
extern "C" void on_interrupt(int) {
    const int error = errno;
    if (StopRequest* request = asked_request.load()) request->ask();
    let_go();
    const std::string_view newline = on_terminal ? "\n" : "";
    const std::string_view text =
        "luxel: interrupted: finishes the step and writes what there is to write; interrupt again to stop at once\n";
    for (const std::string_view part : {newline, text})
        if (::write(STDERR_FILENO, part.data(), part.size()) < 0) break;
    errno = error;
}

}  // namespace

InterruptGuard::InterruptGuard(StopRequest& request) {
    asked_request = &request;
    on_terminal = ::isatty(STDERR_FILENO) == 1;
    for (const int number : signals) {
        struct sigaction present {}, action {};
        if (::sigaction(number, nullptr, &present) != 0 || present.sa_handler == SIG_IGN) continue;
        action.sa_handler = on_interrupt;
        action.sa_flags = SA_RESTART;
        ::sigemptyset(&action.sa_mask);
        ::sigaction(number, &action, nullptr);
    }
}

InterruptGuard::~InterruptGuard() {
    let_go();
    asked_request = nullptr;
}

}  // namespace luxel
