#include "baker/bake/first_gathering.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "baker/core/sobol.h"

namespace luxel {
namespace {

/// Rays per texel, of so many that it may have in the second gathering. What texels send is read by many rays, so its noise hardly
/// shows; no error that is estimated later knows of it, so it must fall with the others.
std::uint32_t first_rays(std::uint32_t most_rays) { return std::max(8u, std::bit_floor(most_rays) / 16); }

/// With fewer rays in the second gathering, its noise is larger than what a second round would mend.
constexpr std::uint32_t rays_for_two_rounds = 512;

std::uint32_t most_rays(const BakeOptions& options) { return options.error > 0 ? options.most_gather_rays : options.gather_rays; }

/// Where shadows may have their edges, lamps are tested at so many points of a texel, elsewhere at one.
constexpr std::uint32_t edge_points = 4;

/// Where few texels make a patch, or where their halves differ much, some rays may have found far too much by chance, and what lies
/// opposite in a gap sees nothing else. So patches have at least the rays of this many texels, and as many more, up to 16 times, as it
/// takes until this is the standard error of what they send, relative to it or to a share of the page's mean light.
constexpr std::uint32_t least_texels = 4;
constexpr double largest_error = 0.25;
constexpr double dark_share = 0.02;
constexpr std::uint32_t most_doublings = 4;

/// What the texels of a patch have gathered, in luminance. Emitters are aimed at: only what others reflect makes such outliers.
struct PatchNoise {
    std::uint32_t rays = 0;  ///< in units of those that a texel has at first
    std::uint32_t texels = 0;
    double light = 0, variance = 0;  ///< sums of all light, lux, and of the variance of what is reflected; in double: the light of 1e-30 has a variance too
    [[nodiscard]] bool is_uncertain(double dark) const {
        return rays < least_texels || std::sqrt(variance) > largest_error * std::max(light, dark * texels);
    }
};

/// Of the texels of a page.
class FirstPage {
  public:
    FirstPage(const BakedGeometry& geometry, const GatherInput& input, std::uint32_t page, const GatherOptions& options)
        : g_(geometry), in_(input), number_(page), page_(geometry.texels.pages[page]), options_(options) {}

    std::optional<GatheredPage> gathered() {
        found_ = gather_page(in_, number_, options_, nullptr);
        if (!found_) return {};
        std::vector<std::uint8_t> doublings(page_.texels.size(), 0);
        for (std::uint32_t doubling = 0; doubling < most_doublings; ++doubling) {
            const std::vector<std::uint32_t> chosen = uncertain(doublings);
            if (chosen.empty()) break;
            if (!double_rays(in_, number_, options_, chosen, doublings, *found_)) return {};
        }
        return std::move(found_);
    }

  private:
    [[nodiscard]] PatchNumber patch_of(std::size_t k) const {
        const Texel& texel = page_.texels[k];
        return page_.can_send(texel) ? g_.patches.page_patch[number_][std::size_t{texel.y} * g_.patches.page_size + texel.x] : no_patch;
    }

    [[nodiscard]] std::vector<std::uint32_t> uncertain(std::span<const std::uint8_t> doublings) const {
        std::vector<PatchNoise> patches(g_.patches.count());
        const GatheredLight& reflected = found_->reflected;
        double sum = 0;
        for (std::size_t k = 0; k < page_.texels.size(); ++k) {
            const PatchNumber patch = patch_of(k);
            if (patch == no_patch) continue;
            const auto half = static_cast<double>(luminance(reflected.halves[0][k] - reflected.halves[1][k])) / 2;
            const auto light = static_cast<double>(luminance(found_->lamps[k] + found_->gathered(k)));
            patches[patch].rays += 1u << doublings[k];
            sum += light;
            patches[patch].light += light;
            ++patches[patch].texels;
            patches[patch].variance += half * half;
        }
        const double dark = dark_share * sum / static_cast<double>(std::max<std::size_t>(page_.texels.size(), 1));
        std::vector<std::uint32_t> chosen;
        for (std::uint32_t k = 0; k < page_.texels.size(); ++k)
            if (const PatchNumber patch = patch_of(k); patch != no_patch && patches[patch].is_uncertain(dark)) chosen.push_back(k);
        return chosen;
    }

    const BakedGeometry& g_;
    const GatherInput& in_;
    std::uint32_t number_;
    const PageTexels& page_;
    const GatherOptions& options_;
    std::optional<GatheredPage> found_;
};

}  // namespace

std::uint32_t first_rounds(const BakeOptions& options) { return most_rays(options) >= rays_for_two_rounds ? 2 : 1; }

std::optional<FirstGathering> first_gathering(const BakeOptions& options, std::uint32_t round, const BakedGeometry& geometry,
                                              const GatherInput& input, std::vector<Rgb> reflected) {
    // Its own points, so that what this gathering happened to see does not come twice.
    const GatherOptions gathering{first_rays(most_rays(options)), true, 1, edge_points, patch_side_m(options, geometry.atlas),
                                  mix(options.seed, 0x6669727374 + round), options.stop};
    FirstGathering first{RadiosityDetail(std::move(reflected), PatchMean::texels)};
    for (std::uint32_t page = 0; page < geometry.atlas.page_count; ++page) {
        const auto found = FirstPage(geometry, input, page, gathering).gathered();
        if (!found) return {};
        first.radiosity.add_page(geometry.texels, geometry.patches, page, found->irradiance());
        first.rays = std::accumulate(found->rays.begin(), found->rays.end(), first.rays);
    }
    first.radiosity.finish();
    return first;
}

}  // namespace luxel
