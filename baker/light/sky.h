/// Light from outside of all surfaces (SkyMap), asked by direction and aimed at by brightness.
///
/// Units      radiance in nits: lm/(m2 sr) per channel; densities per sr. A sky of L nits from everywhere gives pi L lux to
///            a surface that sees the whole of its hemisphere.
/// Pixels     are areas of one radiance, so a density that goes with it is exact: what a pixel gives over the density is the
///            same for all directions in it.
/// Threads    const and reentrant.
/// Source     importance sampling of pictures by a table of rows and one of columns per row: Pharr, Jakob, Humphreys,
///            Physically Based Rendering, 3rd ed., section 14.2.4.
#pragma once
#include <vector>

#include "baker/scene/scene.h"

namespace luxel {

class Sky {
  public:
    /// Keeps a reference to `map`, which is not empty.
    explicit Sky(const SkyMap& map);
    /// Of the tables that it makes of a map of this size.
    static constexpr std::uint64_t bytes(std::uint64_t width, std::uint64_t height) {
        return width * height * sizeof(float) + (height + 1) * (sizeof(double) + sizeof(float));
    }

    /// `direction`: unit, away from the surface.
    [[nodiscard]] Rgb radiance(const Vec3f& direction) const { return map_.nits[pixel(direction)]; }
    /// Nothing comes from anywhere: sample() may not be called.
    [[nodiscard]] bool is_dark() const { return !(total_ > 0); }
    /// Light comes from few directions: rays that are spread evenly would seldom find them.
    [[nodiscard]] bool is_uneven() const { return is_uneven_; }

    struct Sample {
        Vec3f direction;
        float density = 0;  ///< > 0 but for rounding at the edge of a black pixel, where it is 0
    };
    /// A direction by luminance, for u, v in [0, 1).
    [[nodiscard]] Sample sample(float u, float v) const;
    /// Density of sample() in a direction; integrates to 1 over the sphere.
    [[nodiscard]] float density(const Vec3f& direction) const;

    /// Irradiance of a plane that sees all of its hemisphere, lux. By quadrature over cells of at most 0.7 degrees.
    [[nodiscard]] Rgb irradiance(const Vec3f& normal) const;

  private:
    [[nodiscard]] std::size_t pixel(const Vec3f& direction) const;

    const SkyMap& map_;
    double total_ = 0;  ///< luminance times solid angle
    bool is_uneven_ = false;
    std::vector<double> row_edge_;     ///< height y at which each row begins; height + 1 of them, 1 to -1
    std::vector<float> row_up_to_;     ///< cumulative share of luminance per row, the last is 1
    std::vector<float> column_up_to_;  ///< within each row; all 1 in a row without light
};

}  // namespace luxel
