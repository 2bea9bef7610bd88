#include "baker/bake/stopping.h"

#include <cstdio>

namespace luxel {
namespace {

std::string short_text(const char* format, double value) {
    char text[32];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

const char* how_to_go_on(const BakeOptions& options) {
    return options.work.empty() ? "with --work DIR the next run would go on from here"
                                : "the same command with the same --work goes on from here";
}

}  // namespace

void note_stop(BakeReport& report, const std::string& where, const std::string& what) {
    if (report.stopped)
        report.stopped->what += "; " + what;
    else
        report.stopped = StopReport{where, what};
}

void refuse_without_light(const BakeOptions& options, const std::string& what) {
    throw Error(ErrorCode::stopped_early, "evidence", what + ": there is no light yet, so nothing was written", how_to_go_on(options));
}

void warn_of_stop(const BakeOptions& options, BakeReport& report) {
    if (!report.stopped) return;
    const std::string error = report.standard_error ? short_text("%.1f %%", 100 * *report.standard_error) : "not known";
    report.warnings.push_back({"stopped", report.stopped->where,
                               std::string(options.stop->was_asked() ? "interrupted: " : "the time is up: ") + report.stopped->what +
                                   "; error bound of the solve " + short_text("%.1e", report.error_bound) + ", standard error " +
                                   error + "; " + how_to_go_on(options)});
}

}  // namespace luxel
