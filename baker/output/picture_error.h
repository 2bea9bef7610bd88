/// How far a page's picture in some format is from the float page. Threads: pure.
#pragma once
#include <cstddef>
#include <functional>
#include <vector>

namespace luxel {

/// Of a texel: its worst channel's |decoded - truth|, relative to its largest channel; texels without light do not count.
struct PictureError {
    double median = 0, p95 = 0;  ///< of the texels, relative
    double largest = 0;          ///< of any channel, relative to the page's largest channel

    /// The larger of each figure: what holds for two pages together.
    [[nodiscard]] PictureError worst_of(const PictureError& other) const;
};

/// Collects texels, one by one.
class PictureErrorSum {
  public:
    explicit PictureErrorSum(std::size_t texels) { relative_.reserve(texels); }
    void add(const double (&decoded)[3], const double (&truth)[3]);
    /// Once, at the end.
    [[nodiscard]] PictureError result();

  private:
    std::vector<float> relative_;
    double largest_value_ = 0, largest_error_ = 0;
};

}  // namespace luxel
