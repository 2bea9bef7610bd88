#include "baker/scene/shape_metric.h"

#include <algorithm>
#include <cmath>

namespace luxel {

ShapeMetric shape_metric(const Vec3d& x, const Vec3d& y, const Vec3d& z) {
    ShapeMetric metric{x.dot(x), y.dot(x), y.dot(y), z.dot(x), z.dot(y), z.dot(z)};
    const double largest = std::max({metric[0], metric[2], metric[5]});
    if (!(largest > 0) || !std::isfinite(largest)) return {};
    const double quantum = std::ldexp(1.0, std::ilogb(largest) - 16);
    for (double& entry : metric) entry = std::nearbyint(entry / quantum) * quantum;
    return metric;
}

std::array<double, 6> shape_root(const ShapeMetric& metric) {
    const auto ratio = [](double part, double whole) { return whole > 0 ? part / whole : 0.0; };
    const auto root = [](double square) { return square > 0 ? std::sqrt(square) : 0.0; };
    std::array<double, 6> l{};
    l[0] = root(metric[0]);
    l[1] = ratio(metric[1], l[0]);
    l[2] = root(metric[2] - l[1] * l[1]);
    l[3] = ratio(metric[3], l[0]);
    l[4] = ratio(metric[4] - l[3] * l[1], l[2]);
    l[5] = root(metric[5] - l[3] * l[3] - l[4] * l[4]);
    return l;
}

}  // namespace luxel
