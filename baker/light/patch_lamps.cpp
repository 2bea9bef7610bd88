#include "baker/light/patch_lamps.h"

#include "baker/light/patch_mean.h"

namespace luxel {

std::vector<Rgb> patch_lamp_irradiance(const Scene& scene, const Atlas& atlas, const PatchSet& patches,
                                       const Tracer& tracer, std::uint32_t points) {
    const LampLight lamps(scene, tracer);
    if (lamps.empty()) return std::vector<Rgb>(patches.count(), Rgb(0, 0, 0));
    constexpr PatchPurposes purposes{0x6c616d7073, 0x6f6e6c616d70};
    return mean_over_patches(scene, atlas, patches, points, purposes,
                             [&](const SurfacePoint& at, const std::array<float, 4>& u, const std::array<float, 4>& on_lamp) {
                                 return lamps.irradiance({at.position, at.normal, at.normal, at.triangle}, u[2], {on_lamp[0], on_lamp[1]});
                             });
}

}  // namespace luxel
