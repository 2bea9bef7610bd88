/// The last part of the way inside: light for every texel.
#pragma once
#include <functional>

#include "baker/bake/solve_stage.h"
#include "baker/light/texel_light.h"

namespace luxel {

/// Irradiance of every page: in the bake folder, or where it is not, spread from that of the patches.
struct BakedLight {
    std::filesystem::path folder;  ///< empty: no page is in the bake folder
    Key key;
    std::optional<std::vector<Rgb>> patch_irradiance;  ///< H per patch with the lamps, lux; none where all pages are in the folder
    std::string state;                                 ///< Sidecar::state
    /// The light of a page in its parts, one per texel; an empty list where it is not known, as for pages that were interpolated. No
    /// function: it is known for none.
    std::function<std::vector<TexelLight>(std::uint32_t page)> texel_light;
};

/// Does BakedLight::texel_light come with these options? Layers that need it are refused otherwise.
bool parts_light(const BakeOptions& options);

/// Publishes what it gathers or, for drafts, interpolates in the bake folder. Stage "light".
BakedLight light_texels(const BakeOptions& options, const BakedGeometry& geometry, const BakedSources& sources,
                        const BakedMatrix& matrix, const BakedSolution& solution, const BakeFolder& folder,
                        StageClock& clock, BakeReport& report);

/// Light of the solve plus that of the lamps, per patch.
std::vector<Rgb> add_lamps(std::span<const Channels> irradiance, std::span<const Rgb> lamp_irradiance);

/// Irradiance of the texels of one page, in their order.
std::vector<Rgb> page_light(const BakeOptions& options, const BakedGeometry& geometry, const BakedLight& light, std::uint32_t page);

}  // namespace luxel
