#include "baker/scene/value_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace luxel {
namespace {

std::string number(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.9g", value);
    return text.data();
}

/// "0.5", or "(1, 2, 3)".
std::string list(std::span<const double> values) {
    if (values.size() == 1) return number(values[0]);
    std::string text;
    for (const double value : values) text += (text.empty() ? "(" : ", ") + number(value);
    return text + ")";
}

double nearest(double value, double highest) {
    return std::isfinite(value) && value > 0 ? std::min(value, highest) : 0.0;
}

}  // namespace

ValueCheck::ValueCheck(BadValues bad_values, std::string file, std::string where, std::vector<Warning>& warnings)
    : bad_values_(bad_values), file_(std::move(file)), where_(std::move(where)), warnings_(warnings) {}

void ValueCheck::limit(std::span<double> values, double highest, const char* code, const std::string& property) const {
    if (std::ranges::all_of(values, [&](double v) { return nearest(v, highest) == v; })) return;
    const std::string found = property + " is " + list(values) + ", expected 0 to " + number(highest);
    for (double& value : values) value = nearest(value, highest);
    fault(code, found, list(values));
}

void ValueCheck::fault(const char* code, const std::string& what, const std::string& instead) const {
    if (bad_values_ == BadValues::refuse)
        throw Error(ErrorCode::bad_input, file_.empty() ? where_ : file_ + ": " + where_, what,
                    "correct the file, or bake with --bad-values clamp, which takes " + instead + " for it");
    warnings_.push_back({code, where_, what + ": " + instead + " is used"});
}

}  // namespace luxel
