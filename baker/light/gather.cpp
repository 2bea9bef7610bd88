#include "baker/light/gather.h"

#include <algorithm>

#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/formfactors/surface_map.h"
#include "baker/light/lamps.h"
#include "baker/patches/patch_sampler.h"
#include "baker/trace/ray_offset.h"

namespace luxel {
namespace {

constexpr std::size_t batch_rays = 64;

class TexelGather {
  public:
    TexelGather(const GatherInput& input, std::uint32_t page, const GatherOptions& options)
        : in_(input), page_(input.texels.pages[page]), options_(options), lamps_(input.scene, input.tracer) {}

    [[nodiscard]] Rgb irradiance(std::size_t index) const {
        const Texel& texel = page_.texels[index];
        const SurfaceSampler sampler(in_.scene, in_.atlas,
                                     {page_.fragments.data() + texel.first_fragment, texel.fragment_count}, false);
        const SobolSequence sequence(seed(texel));
        return indirect(sampler, sequence) + direct(sampler, sequence);
    }

  private:
    /// Depends on the chart's object, its own grid and the options only: packing does not change the noise.
    [[nodiscard]] std::uint64_t seed(const Texel& texel) const {
        const Chart& chart = in_.atlas.charts[texel.chart];
        const Object& object = in_.scene.objects[chart.object];
        const std::uint64_t place = (std::uint64_t{texel.y - chart.y} << 32) | (texel.x - chart.x);
        return mix(mix(mix(object.path_hash, chart.ordinal), place), options_.seed ^ 0x746578656cULL);
    }

    [[nodiscard]] Rgb indirect(const SurfaceSampler& sampler, const SobolSequence& sequence) const {
        std::array<TraceRay, batch_rays> rays;
        std::array<TraceHit, batch_rays> hits;
        std::array<double, 3> sum{};
        for (std::uint32_t begin = 0; begin < options_.rays; begin += batch_rays) {
            const std::size_t wanted = std::min<std::size_t>(batch_rays, options_.rays - begin);
            std::size_t count = 0;
            for (std::size_t k = 0; k < wanted; ++k) {
                const auto u = sequence.point(begin + static_cast<std::uint32_t>(k));
                const SurfacePoint at = sampler.point(u[0], u[1]);
                const Vec3f direction = Frame(sampler.shading_normal(at)).to_world(cosine_direction(u[2], u[3]));
                // Below the true surface there is only the inside of the object.
                if (direction.dot(at.normal) <= 0) continue;
                rays[count++] = {offset_origin(at.position, at.normal, in_.scene.corner_extent(at.triangle)), direction,
                                 at.triangle};
            }
            in_.tracer.first_hits({rays.data(), count}, {hits.data(), count});
            for (std::size_t k = 0; k < count; ++k) {
                const Landing at = landing(in_.scene, in_.atlas, in_.patches, hits[k]);
                if (at.end != RayEnd::patch) continue;
                for (std::size_t c = 0; c < 3; ++c)
                    sum[c] += static_cast<double>(in_.radiosity[at.patch][static_cast<int>(c)]);
            }
        }
        const double scale = 1.0 / options_.rays;
        return {static_cast<float>(sum[0] * scale), static_cast<float>(sum[1] * scale),
                static_cast<float>(sum[2] * scale)};
    }

    [[nodiscard]] Rgb direct(const SurfaceSampler& sampler, const SobolSequence& sequence) const {
        Rgb sum(0, 0, 0);
        if (lamps_.empty()) return sum;
        for (std::uint32_t k = 0; k < options_.lamp_points; ++k) {
            const auto u = sequence.point(k);
            const SurfacePoint at = sampler.point(u[0], u[1]);
            sum += lamps_.irradiance({at.position, at.normal, sampler.shading_normal(at), at.triangle}, u[2]);
        }
        return sum / static_cast<float>(options_.lamp_points);
    }

    const GatherInput& in_;
    const PageTexels& page_;
    const GatherOptions& options_;
    LampLight lamps_;
};

}  // namespace

std::vector<Rgb> gather_page(const GatherInput& input, std::uint32_t page, const GatherOptions& options,
                             ProgressCounter* progress) {
    const TexelGather gather(input, page, options);
    std::vector<Rgb> irradiance(input.texels.pages[page].texels.size());
    parallel_ranges(irradiance.size(), 256, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) irradiance[k] = gather.irradiance(k);
        if (progress) progress->add(end - begin);
    });
    return irradiance;
}

}  // namespace luxel
