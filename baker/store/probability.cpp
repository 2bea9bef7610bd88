#include "baker/store/probability.h"

#include <cmath>

namespace luxel {
namespace {

/// Regularised incomplete beta function I_x(a, b) for x below (a + 1) / (a + b + 2), by its continued fraction evaluated with
/// the method of Lentz (Abramowitz and Stegun, Handbook of Mathematical Functions, 26.5.8).
double incomplete_beta(double x, double a, double b) {
    constexpr double tiny = 1e-300;
    const auto not_zero = [](double v) { return std::abs(v) < tiny ? tiny : v; };
    double c = 1, d = 1 / not_zero(1 - (a + b) * x / (a + 1)), fraction = d;
    for (int m = 1; m < 500; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        d = 1 / not_zero(1 + even * d);
        c = not_zero(1 + even / c);
        fraction *= d * c;
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1 / not_zero(1 + odd * d);
        c = not_zero(1 + odd / c);
        const double step = d * c;
        fraction *= step;
        if (std::abs(step - 1) < 1e-14) break;
    }
    const double log_front =
        std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x);
    return std::exp(log_front) * fraction / a;
}

}  // namespace

double student_tail(double t, double freedom) {
    if (!(t > 0)) return 1;
    if (std::isinf(t)) return 0;
    // P(|T| > t) = I_x(freedom / 2, 1 / 2), x = freedom / (freedom + t^2)
    const double a = freedom / 2, b = 0.5, x = freedom / (freedom + t * t);
    return x < (a + 1) / (a + b + 2) ? incomplete_beta(x, a, b) : 1 - incomplete_beta(1 - x, b, a);
}

double digamma(double x) {
    double shift = 0;
    for (; x < 10; ++x) shift -= 1 / x;
    const double s = 1 / (x * x);
    return shift + std::log(x) - 0.5 / x - s * (1.0 / 12 - s * (1.0 / 120 - s * (1.0 / 252 - s / 240)));
}

double trigamma(double x) {
    double shift = 0;
    for (; x < 10; ++x) shift += 1 / (x * x);
    const double s = 1 / (x * x);
    return shift + 1 / x + s / 2 + s / x * (1.0 / 6 - s * (1.0 / 30 - s * (1.0 / 42 - s / 30)));
}

double inverse_trigamma(double y) {
    // trigamma falls from infinity to 0: halve an interval of the logarithm.
    double low = -40, high = 40;
    for (int step = 0; step < 200; ++step) {
        const double middle = 0.5 * (low + high);
        (trigamma(std::exp(middle)) > y ? low : high) = middle;
    }
    return std::exp(0.5 * (low + high));
}

}  // namespace luxel
