/// How far a lightmap is from a reference, in linear irradiance, over texels that have light of their own, weighted by area.
///
/// With weights a (m2), luminances x of the bake and r of the reference (Rec. 709), d = x - r, mean = sum a r / sum a:
///   relative RMSE   sqrt(max(0, sum a (d^2 - v) / sum a)) / mean, v the variance of r, so that the noise of the reference does not
///                   count as an error of the bake; of each channel the same against the mean of the channel
///   bias            sum a d / sum a r
///   median, p95     of |d| / max(r, 1 % of mean), by area; here v cannot be taken out
///   worst           the largest of these, with its place
///   predicted       sqrt(sum a (e x)^2 / sum a) / (sum a x / sum a), e the layer "error" of the bake
///   noise           sqrt(sum a v / sum a) / mean
///
/// Two independent references with luminances r1, r2: r = (r1 + r2) / 2, v = (r1 - r2)^2 / 4. One: v = 0.
/// Pages come one after the other; 8 bytes per texel are kept. Threads: one at a time.
/// Errors  Error{bad_input} naming page and texel: sizes that differ, values that are not finite.
#pragma once
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "baker/sweep/measured_page.h"

namespace luxel {

struct WorstTexel {
    double error = 0;  ///< relative
    std::uint32_t page = 0, x = 0, y = 0;
    double lux = 0, reference_lux = 0;  ///< luminance
};

struct ErrorFigures {
    double area_m2 = 0;
    std::uint64_t texels = 0;
    double mean_lux = 0;  ///< of the reference
    double relative_rmse = 0;
    std::array<double, 3> channel_rmse{};  ///< R, G, B; 0 where the reference has none of it
    double bias = 0, median = 0, p95 = 0;
    WorstTexel worst;
    double predicted = -1;  ///< -1: the bake does not say
    double noise = 0;
    /// What was found is not much more than the noise that was taken out of it: the figure is uncertain.
    bool is_below_noise = false;
};

/// Relative error per cell of a coarse picture of the part of a page where surface is: root of the mean square over the cell, -1 where there is none.
struct ErrorMap {
    std::uint32_t width = 0, height = 0;
    std::vector<float> error;
};
constexpr std::uint32_t map_side = 96;  ///< cells along the longer side, at most

/// One page of the reference; `second` is empty where there is only one.
struct ReferencePage {
    PageLight first, second;
};

class ErrorMeter {
  public:
    /// `mean_lux`: of the whole reference (reference_mean), > 0 unless all is dark.
    explicit ErrorMeter(double mean_lux) : mean_lux_(mean_lux) {}
    /// The next page.
    void add(const MeasuredPage& page, const ReferencePage& reference);
    /// Throws unless their sizes agree.
    static void check(const MeasuredPage& page, const ReferencePage& reference, std::uint32_t number);
    [[nodiscard]] ErrorFigures figures();
    [[nodiscard]] const std::vector<ErrorMap>& maps() const { return maps_; }

  private:
    struct Sums {
        double area = 0, light = 0, reference = 0, square = 0, variance = 0, predicted = 0;
        std::array<double, 3> channel_square{}, channel_variance{}, channel_reference{};
    };
    [[nodiscard]] double quantile(double share) const;

    double mean_lux_;
    Sums sums_;
    bool predicts_ = true;
    std::uint32_t pages_ = 0;
    std::vector<std::pair<float, float>> errors_;  ///< relative error, area
    WorstTexel worst_;
    std::vector<ErrorMap> maps_;
};

/// Adds up luminance and area of a page of the reference.
struct MeanLight {
    double light = 0, area_m2 = 0;
    void add(const ReferencePage& reference, const std::vector<float>& area_m2);
    [[nodiscard]] double lux() const { return area_m2 > 0 ? light / area_m2 : 0; }
};

}  // namespace luxel
