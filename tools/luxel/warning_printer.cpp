#include "tools/luxel/warning_printer.h"

#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <string>

#include "tools/luxel/printable.h"

namespace luxel {
namespace {

/// A fourth is worth a line of its own; from the fifth on they share one.
constexpr std::size_t most_alone = 4, shown = 3;

}  // namespace

void print_warnings(std::span<const Warning> warnings) {
    std::map<std::string, std::size_t> count, done;
    for (const Warning& warning : warnings) ++count[warning.code];
    for (const Warning& warning : warnings) {
        const std::size_t all = count[warning.code], place = done[warning.code]++;
        if (all <= most_alone || place < shown)
            fmt::print(stderr, "luxel: warning: {}: {} [{}]\n", printable(warning.where), printable(warning.text), warning.code);
        else if (place == shown)
            fmt::print(stderr, "luxel: warning: {} more of this kind; --report FILE lists them all [{}]\n", all - shown, warning.code);
    }
}

}  // namespace luxel
