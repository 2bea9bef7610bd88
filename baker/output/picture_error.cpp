#include "baker/output/picture_error.h"

#include <algorithm>
#include <cmath>

namespace luxel {
namespace {

/// The smallest value that this share of all values does not exceed.
double quantile(std::vector<float>& values, double share) {
    if (values.empty()) return 0;
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
    std::nth_element(values.begin(), at, values.end());
    return static_cast<double>(*at);
}

}  // namespace

PictureError PictureError::worst_of(const PictureError& other) const {
    return {std::max(median, other.median), std::max(p95, other.p95), std::max(largest, other.largest)};
}

void PictureErrorSum::add(const double (&decoded)[3], const double (&truth)[3]) {
    double error = 0, value = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        error = std::max(error, std::abs(decoded[c] - truth[c]));
        value = std::max(value, truth[c]);
    }
    largest_error_ = std::max(largest_error_, error);
    largest_value_ = std::max(largest_value_, value);
    if (value > 0) relative_.push_back(static_cast<float>(error / value));
}

PictureError PictureErrorSum::result() {
    return {quantile(relative_, 0.5), quantile(relative_, 0.95), largest_value_ > 0 ? largest_error_ / largest_value_ : 0};
}

}  // namespace luxel
