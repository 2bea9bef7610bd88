#include "baker/sweep/error_meter.h"

#include <algorithm>
#include <cmath>

#include "formats/base/error.h"

namespace luxel {
namespace {

constexpr double dark_share = 0.01;  ///< of the mean: what is darker is held against this
constexpr std::array<double, 3> luminance_weights{0.2126, 0.7152, 0.0722};

using Lux = std::array<double, 3>;

Lux as_double(const std::array<float, 3>& v) { return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])}; }
double luminance(const Lux& v) { return luminance_weights[0] * v[0] + luminance_weights[1] * v[1] + luminance_weights[2] * v[2]; }

/// A texel of the reference: mean of what there is, and the variance of that mean.
struct Truth {
    Lux mean{}, variance{};
    double lux = 0, lux_variance = 0;
    Truth(const ReferencePage& reference, std::size_t at) : mean(as_double(reference.first.lux[at])) {
        if (!reference.second.lux.empty()) {
            const Lux first = mean, second = as_double(reference.second.lux[at]);
            for (std::size_t c = 0; c < 3; ++c) {
                mean[c] = (first[c] + second[c]) / 2;
                variance[c] = (first[c] - second[c]) * (first[c] - second[c]) / 4;
            }
            const double apart = luminance(first) - luminance(second);
            lux_variance = apart * apart / 4;
        }
        lux = luminance(mean);
    }
};

void check_size(const PageLight& found, const PageLight& expected, std::uint32_t page) {
    if (found.width == expected.width && found.height == expected.height) return;
    throw Error(ErrorCode::bad_input, "reference",
                "page " + std::to_string(page) + ": expected " + std::to_string(expected.width) + " x " + std::to_string(expected.height) +
                    " texels as in the bake, found " + std::to_string(found.width) + " x " + std::to_string(found.height),
                "a reference has the layout of the bake: the same texels per metre, atlas size and padding");
}

double relative(double square, double area, double mean) { return area > 0 && mean > 0 ? std::sqrt(std::max(0.0, square / area)) / mean : 0; }

/// Sums of the cells of a coarse map, over the part of the page where surface is.
class MapSums {
  public:
    explicit MapSums(const MeasuredPage& page) {
        std::size_t last_x = 0, last_y = 0;
        left_ = page.light.width, top_ = page.light.height;
        for (std::size_t at = 0; at < page.area_m2.size(); ++at) {
            if (page.area_m2[at] <= 0) continue;
            const std::size_t x = at % page.light.width, y = at / page.light.width;
            left_ = std::min(left_, x), top_ = std::min(top_, y), last_x = std::max(last_x, x), last_y = std::max(last_y, y);
        }
        if (left_ > last_x) return;  // no surface, no cells
        step_ = (std::max(last_x - left_, last_y - top_) + map_side) / map_side;
        map_.width = static_cast<std::uint32_t>((last_x - left_) / step_ + 1);
        map_.height = static_cast<std::uint32_t>((last_y - top_) / step_ + 1);
        square_.resize(std::size_t{map_.width} * map_.height);
        area_.resize(square_.size());
    }
    void add(std::size_t x, std::size_t y, double error, double area) {
        const std::size_t cell = (y - top_) / step_ * map_.width + (x - left_) / step_;
        square_[cell] += area * error * error;
        area_[cell] += area;
    }
    ErrorMap finish() {
        for (std::size_t cell = 0; cell < area_.size(); ++cell)
            map_.error.push_back(area_[cell] > 0 ? static_cast<float>(std::sqrt(square_[cell] / area_[cell])) : -1);
        return std::move(map_);
    }

  private:
    std::size_t left_ = 0, top_ = 0, step_ = 1;
    ErrorMap map_;
    std::vector<double> square_, area_;
};

}  // namespace

void MeanLight::add(const ReferencePage& reference, const std::vector<float>& areas) {
    for (std::size_t at = 0; at < areas.size(); ++at) {
        const auto area = static_cast<double>(areas[at]);
        if (area <= 0) continue;
        light += area * Truth(reference, at).lux;
        area_m2 += area;
    }
}

void ErrorMeter::check(const MeasuredPage& page, const ReferencePage& reference, std::uint32_t number) {
    check_size(reference.first, page.light, number);
    if (!reference.second.lux.empty()) check_size(reference.second, page.light, number);
}

void ErrorMeter::add(const MeasuredPage& page, const ReferencePage& reference) {
    check(page, reference, pages_);
    predicts_ &= !page.error.empty();
    MapSums map(page);
    const double dark = dark_share * mean_lux_;
    for (std::size_t at = 0; at < page.area_m2.size(); ++at) {
        const auto area = static_cast<double>(page.area_m2[at]);
        if (area <= 0) continue;
        const Truth truth(reference, at);
        const Lux light = as_double(page.light.lux[at]);
        const double lux = luminance(light), apart = lux - truth.lux;
        if (!std::isfinite(lux) || !std::isfinite(truth.lux))
            throw Error(ErrorCode::bad_input, "page " + std::to_string(pages_),
                        "texel " + std::to_string(at % page.light.width) + ", " + std::to_string(at / page.light.width) + " is not a finite number",
                        "the bake and its reference must be finite on all surface");
        sums_.area += area;
        sums_.light += area * lux;
        sums_.reference += area * truth.lux;
        sums_.square += area * apart * apart;
        sums_.variance += area * truth.lux_variance;
        for (std::size_t c = 0; c < 3; ++c) {
            sums_.channel_square[c] += area * (light[c] - truth.mean[c]) * (light[c] - truth.mean[c]);
            sums_.channel_variance[c] += area * truth.variance[c];
            sums_.channel_reference[c] += area * truth.mean[c];
        }
        if (predicts_) sums_.predicted += area * std::pow(static_cast<double>(page.error[at]) * lux, 2);
        const double floor = std::max(truth.lux, dark), error = floor > 0 ? std::abs(apart) / floor : 0;
        errors_.emplace_back(static_cast<float>(error), page.area_m2[at]);
        const std::size_t x = at % page.light.width, y = at / page.light.width;
        map.add(x, y, error, area);
        if (error > worst_.error) worst_ = {error, pages_, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), lux, truth.lux};
    }
    maps_.push_back(map.finish());
    ++pages_;
}

double ErrorMeter::quantile(double share) const {
    double reached = 0;
    for (const auto& [error, area] : errors_) {
        reached += static_cast<double>(area);
        if (reached >= share * sums_.area) return static_cast<double>(error);
    }
    return errors_.empty() ? 0 : static_cast<double>(errors_.back().first);
}

ErrorFigures ErrorMeter::figures() {
    std::sort(errors_.begin(), errors_.end());
    ErrorFigures f;
    f.area_m2 = sums_.area;
    f.texels = errors_.size();
    f.mean_lux = sums_.area > 0 ? sums_.reference / sums_.area : 0;
    const double excess = sums_.square - sums_.variance;
    f.relative_rmse = relative(excess, sums_.area, f.mean_lux);
    f.is_below_noise = excess < sums_.variance;
    for (std::size_t c = 0; c < 3; ++c)
        f.channel_rmse[c] = relative(sums_.channel_square[c] - sums_.channel_variance[c], sums_.area,
                                     sums_.area > 0 ? sums_.channel_reference[c] / sums_.area : 0);
    f.bias = sums_.reference > 0 ? (sums_.light - sums_.reference) / sums_.reference : 0;
    f.median = quantile(0.5);
    f.p95 = quantile(0.95);
    f.worst = worst_;
    if (predicts_ && pages_ > 0) f.predicted = relative(sums_.predicted, sums_.area, sums_.area > 0 ? sums_.light / sums_.area : 0);
    f.noise = relative(sums_.variance, sums_.area, f.mean_lux);
    return f;
}

}  // namespace luxel
