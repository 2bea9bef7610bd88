#include "tools/luxel/progress_printer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace luxel {
namespace {

constexpr double redraw_s = 0.1;   // terminal
constexpr double repeat_s = 10.0;  // log file

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

ProgressPrinter::ProgressPrinter(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1) {}

std::string ProgressPrinter::line(std::uint64_t done, std::uint64_t total, const char* unit, double seconds) const {
    std::string text = fmt::format("{:<9}", stage_);
    if (total) text += fmt::format(" {:3d} %", static_cast<int>(100.0 * static_cast<double>(done) / static_cast<double>(total)));
    if (done && seconds > 0) {
        const double rate = static_cast<double>(done) / seconds;
        const char* scale = rate >= 1e6 ? "M" : rate >= 1e3 ? "k" : "";
        text += fmt::format("  {:.1f} {}{}/s", rate / (rate >= 1e6 ? 1e6 : rate >= 1e3 ? 1e3 : 1), scale, unit);
        if (total > done) text += fmt::format("  {:.0f} s left", static_cast<double>(total - done) / rate);
    }
    return text;
}

void ProgressPrinter::update(const std::string& stage, std::uint64_t done, std::uint64_t total, const char* unit) {
    if (quiet_) return;
    const std::lock_guard lock(mutex_);
    if (stage != stage_) {
        end_stage();
        stage_ = stage;
        stage_start_ = last_print_ = Clock::now();
        if (terminal_) std::fprintf(stderr, "\r\033[K%s", line(0, 0, "", 0).c_str());
        return;
    }
    if (seconds_since(last_print_) < (terminal_ ? redraw_s : repeat_s)) return;
    last_print_ = Clock::now();
    const std::string text = line(done, total, unit, seconds_since(stage_start_));
    std::fprintf(stderr, terminal_ ? "\r\033[K%s" : "luxel: %s\n", text.c_str());
}

void ProgressPrinter::end_stage() {
    if (stage_.empty()) return;
    if (terminal_) std::fputs("\r\033[K", stderr);
    std::fprintf(stderr, "luxel: %-9s %7.2f s\n", stage_.c_str(), seconds_since(stage_start_));
}

void ProgressPrinter::finish() {
    const std::lock_guard lock(mutex_);
    if (!quiet_) end_stage();
    stage_.clear();
}

}  // namespace luxel
