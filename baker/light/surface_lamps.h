/// Mean light of lamps over a piece of surface: of a texel (texel_lamps.h), of a patch (patch_lamps.h). Which lamps are tested at many points
/// of it, a few first points decide, which then no longer count: no value decides about itself, so the mean is true also for
/// light through gaps that are thinner than the piece. A lamp that is closer than the piece is wide has points of its own on it (lamp_cells.h).
///
/// Errors: none. Threads: const and reentrant; a pure function of geometry, lamps and seeds.
/// Source: Kirk and Arvo, Unbiased Sampling Techniques for Image Synthesis, SIGGRAPH 1991 (why the samples that decide may not count).
#pragma once
#include <algorithm>
#include <limits>
#include <vector>

#include "baker/light/lamp_cells.h"
#include "baker/light/lamps.h"
#include "baker/patches/patch_sampler.h"

namespace luxel {

/// How far values of light lie apart, lux.
struct LightRange {
    /// Of a piece's light: values that differ by more belong to both sides of an edge.
    static constexpr float contrast = 0.1f;
    float least = std::numeric_limits<float>::max(), most = 0;
    void add(float value) { least = std::min(least, value), most = std::max(most, value); }
    /// Beside `all`: what the piece gets in all, about.
    [[nodiscard]] bool is_wide(float all) const { return most - least > contrast * all; }
};

class SurfaceLamps {
  public:
    /// References must outlive it.
    SurfaceLamps(const Scene& scene, const Tracer& tracer) : scene_(scene), lamps_(scene, tracer) {}

    /// Numbers of points are powers of two. `smooth`: cosines against the smooth surface, as texels have it; else against the
    /// geometric one.
    struct Piece {
        const SurfaceSampler& sampler;
        std::uint64_t seed;
        bool smooth;
    };
    struct Few {
        Rgb light{0, 0, 0};    ///< lux
        float strong = 0;      ///< luminance of what the strong lamps give of it (lamp_table.h)
        LightRange range;      ///< of that at the points: what is chosen by chance says nothing of edges
    };
    [[nodiscard]] Few by_few(const Piece& piece, std::uint32_t points) const;
    /// By `points` others; the same few as before decide which lamps need all of them. `other`: luminance of what the piece gets
    /// besides, lux.
    [[nodiscard]] Rgb by_many(const Piece& piece, std::uint32_t few_points, std::uint32_t points, float other) const;

  private:
    struct Sample {
        LightPoint at;
        Vec2f on_lamp;
        float random;
        float weight;
    };
    /// Has points of its own on the piece.
    struct CloseLamp {
        std::uint32_t lamp;
        LampCells cells;
    };
    struct Lamps {
        RankedLamps far;
        std::vector<CloseLamp> close;
    };
    [[nodiscard]] Lamps lamps_of(const Piece& piece) const;
    /// `cells`: null for places that are even.
    [[nodiscard]] std::vector<Sample> samples(const Piece& piece, std::uint64_t purpose, std::uint32_t count, const LampCells* cells = nullptr) const;
    /// Of each close lamp at points of its own: what it gives to the mean at each of them, one row after the other.
    [[nodiscard]] std::vector<Rgb> close_light(const Piece& piece, std::span<const CloseLamp> close, std::uint64_t purpose, std::uint32_t count) const;

    const Scene& scene_;
    LampLight lamps_;
};

}  // namespace luxel
