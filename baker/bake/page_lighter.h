/// Lights the texels of one page after the other. What all pages share is made once, when the first page asks for it: the
/// colours of panes, where light comes from, and, from a first gathering with few rays, what every texel sends
/// (light/radiosity_detail.h).
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "baker/bake/solve_stage.h"
#include "baker/core/progress.h"
#include "baker/light/gather.h"
#include "baker/light/sky.h"
#include "baker/light/texel_light.h"

namespace luxel {

class PageLighter {
  public:
    /// References must outlive it, and `dark`: patches that no light reaches, as GatherInput has them.
    PageLighter(const BakeOptions& options, const BakedGeometry& geometry, const BakedSources& sources, const BakedMatrix& matrix,
                const BakedSolution& solution, std::span<const std::uint8_t> dark = {});

    /// The light of a page in its parts, one per texel; of drafts, all of it is called direct. Empty: there was no time for it.
    /// Adds texels to `progress`.
    std::vector<TexelLight> light(std::uint32_t page, ProgressCounter& progress);

    /// What the rays of texels meet, as light() has it. Refers to this object. None: there was no time for it.
    std::optional<GatherInput> gather_input();
    /// Rays of the first gathering, once it is done.
    [[nodiscard]] std::uint64_t first_rays() const { return first_rays_; }

  private:
    /// What the rays of texels meet.
    struct Senders {
        EmitterSet emitters;
        RadiosityDetail radiosity;
        LightGuides guides;
    };

    std::vector<TexelLight> gathered(std::uint32_t page, ProgressCounter& progress);
    /// Irradiance of the patches, spread over the texels of a page.
    std::vector<Rgb> interpolated(std::uint32_t page);
    void find_colours();
    bool find_senders();
    [[nodiscard]] RadiosityDetail spread_radiosity() const;
    [[nodiscard]] LightGuides find_guides() const;
    [[nodiscard]] GatherInput input_now() const;
    /// Texels whose light is less certain than BakeOptions::error asks for, and that may have more rays.
    [[nodiscard]] std::vector<std::uint32_t> too_uncertain(std::span<const TexelLight> light, std::span<const std::uint8_t> doublings) const;
    [[nodiscard]] std::vector<TexelLight> shared(std::uint32_t page, GatheredPage gathered) const;
    void recolour(std::vector<Rgb>& irradiance) const;

    const BakeOptions& options_;
    const BakedGeometry& g_;
    const BakedSources& sources_;
    const BakedMatrix& matrix_;
    const BakedSolution& solution_;
    std::span<const std::uint8_t> dark_;
    std::optional<Sky> sky_;
    std::vector<Rgb> reflected_;   ///< per patch
    std::vector<Rgb> irradiance_;  ///< per patch, only for drafts
    std::vector<Rgb> colours_;     ///< per patch, only where panes tint
    bool has_colours_ = false;
    std::uint64_t first_rays_ = 0;
    std::optional<Senders> senders_;
};

}  // namespace luxel
