/// What a ray reads of the solution where it ends. A patch has one radiosity; the texture on it and the light that changes
/// across it do not. Here every texel has a factor per channel on the radiosity of its patch:
///
///     B_texel = rho_texel H_texel
///
/// so light bounces with the detail of the texture. Where H is only spread from the patches, the texels of a patch are scaled so that
/// their mean stays what was solved: no power is made or lost. Where each texel has gathered its own, it is taken as it is: one
/// more bounce of the solution, at the resolution of the texels, is nearer to the truth than the patch was (in a gap that is
/// narrower than a patch, by far).
///
/// Stored   4 bytes a texel: three logarithmic factors of 10 bits, 2^-4 .. 2^4 in steps of 0.54 %, 0, and exactly 1 where
///          nothing differs: an evenly lit surface without texture stays exact.
/// Threads  const and reentrant once made.
/// Source   two-pass radiosity: patches shoot, elements receive (Cohen, Greenberg, Immel, Brock 1986).
#pragma once
#include <array>
#include <span>
#include <vector>

#include "baker/patches/patch.h"
#include "baker/patches/patch_lookup.h"

namespace luxel {

/// What the mean over the texels of a patch is.
enum class PatchMean {
    solved,  ///< the patch's own radiosity
    texels   ///< what its texels were given
};

class RadiosityDetail {
  public:
    /// `reflected`: B - M per patch number, lm/m2, without self-emission, which may be so much brighter that a float of both
    /// has lost it. No detail: every texel is as its patch.
    explicit RadiosityDetail(std::vector<Rgb> reflected, PatchMean mean = PatchMean::solved)
        : reflected_(std::move(reflected)), mean_(mean) {}

    /// Adds the detail of page `page`. `irradiance`: H of each of its texels (lux), in their order; with PatchMean::solved the
    /// scale does not matter patch by patch. All pages once, in any order, before the first look-up; then finish().
    void add_page(const TexelSet& texels, const PatchSet& patches, std::uint32_t page, std::span<const Rgb> irradiance);
    /// Makes the mean over each patch what it should be, which rounding has changed.
    void finish();

    /// Tells the processor that at() will be asked for `at`.
    void prefetch(const PatchSet& patches, const SurfaceTexel& at) const {
        if (!pages_.empty()) __builtin_prefetch(&pages_[at.chart->page][place_on_page(patches, at)]);
    }
    /// Reflected radiosity, lm/m2, where a ray met patch `patch` at `at`.
    [[nodiscard]] Rgb at(PatchNumber patch, const PatchSet& patches, const SurfaceTexel& at) const {
        const Rgb& mean = reflected_[patch];
        // A back has no texels of its own, and what rounding put beside the chart has none either.
        if (pages_.empty() || *at.patch != patch) return mean;
        const std::uint32_t packed = pages_[at.chart->page][place_on_page(patches, at)];
        return {mean.x * factor(packed), mean.y * factor(packed >> 10), mean.z * factor(packed >> 20)};
    }

    [[nodiscard]] std::uint64_t resident_bytes() const;
    static constexpr std::uint64_t bytes_per_page_texel = 4;

  private:
    static constexpr std::uint32_t channel_mask = 1023;
    static const std::array<float, 1024>& factors();
    static std::uint32_t code(double factor);
    [[nodiscard]] float factor(std::uint32_t packed) const { return (*factors_)[packed & channel_mask]; }

    std::vector<Rgb> reflected_;
    PatchMean mean_;
    const std::array<float, 1024>* factors_ = &factors();
    std::vector<std::vector<std::uint32_t>> pages_;
    /// Per patch and channel: area times factor of its texels so far, and their area.
    std::vector<std::array<double, 4>> sums_;
};

}  // namespace luxel
