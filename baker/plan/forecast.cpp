#include "baker/plan/forecast.h"

#include <algorithm>
#include <cmath>

#include "baker/bake/decisions.h"
#include "baker/bake/estimator_choice.h"
#include "baker/plan/light_sample.h"
#include "baker/plan/sight_sample.h"

namespace luxel {
namespace {

// Fitted to the samples and four foreign scenes at draft and medium (docs/plan.md has the table).
constexpr double pairs_by_importance = 0.9;  ///< rays go where light is, and meet the same patches more often
constexpr double bytes_per_index_bit = 0.14;  ///< a bit set of that density, compressed
constexpr double least_pair_bytes = 0.4;
constexpr double weight_bytes = 3;            ///< of a pair by hemicube, whose counts are fixed-point numbers
constexpr double chunk_bytes = 650;           ///< headers and indices of a strip
constexpr double program_bytes = 14 << 20;    ///< with its libraries
constexpr double write_bytes = 27;            ///< per texel of a page, whether surface or not
constexpr double draft_bytes = 98;            ///< per texel of the surface, of interpolated light
constexpr double gather_bytes = 125;          ///< and of gathered light
constexpr double patch_bytes = 300;
constexpr double resident_per_pair = 10;      ///< blocks that are decoded
constexpr double seconds_per_pair = 5e-7;     ///< pooling, closure, solve and accuracy, of all rounds
constexpr double seconds_per_texel = 1e-6;    ///< of surface: joining seams, filling, spreading of drafts
constexpr double seconds_per_page_texel = 8e-8;  ///< of pages, whether surface or not: encoding
constexpr double first_round_share = 0.3;    ///< of the time of gathering

std::uint64_t whole(double number) { return static_cast<std::uint64_t>(std::llround(std::max(number, 0.0))); }

/// Beside the geometry.
double working_bytes(const BakeOptions& options, const BakedGeometry& g, double texels, double pairs) {
    const double page = static_cast<double>(g.atlas.page_size) * g.atlas.page_size;
    const double light = texels * (options.gather_rays ? gather_bytes : draft_bytes) + static_cast<double>(g.patches.count()) * patch_bytes;
    return program_bytes + std::max(page * write_bytes, light) + pairs * resident_per_pair;
}

}  // namespace

Forecast forecast(const NamedOptions& named, const BakedGeometry& g, double geometry_seconds) {
    const BakeOptions& options = named.options;
    std::uint64_t texels = 0;
    for (std::uint32_t page = 0; page < g.shown_pages; ++page) texels += g.texels.pages[page].texels.size();
    BakeOptions tracing = options;
    if (!needs_form_factors(options, g)) tracing.rays = std::min(options.rays, thin_round_rays);
    const SightSample sight = sample_sight(tracing, g);
    const bool is_hemicube = options.estimator == EstimatorKind::hemicube;
    const double pairs = sight.pairs * (options.importance && !is_hemicube ? pairs_by_importance : 1);
    const double pair_bytes = std::max(least_pair_bytes, bytes_per_index_bit * sight.index_bits) + (is_hemicube ? weight_bytes : 0);
    Forecast f;
    f.name = named.name;
    f.evidence_rays = sight.rays_per_patch * g.patches.count();
    const bool gathers = has_light(g) || options.forced.has(Part::dark_patches);
    f.gather_rays = gathers ? options.gather_rays * texels : 0;
    f.pairs = whole(pairs);
    f.matrix_bytes = whole(g.layout.chunk_count() * chunk_bytes + pairs * pair_bytes);
    f.peak_bytes = g.resident_bytes() + whole(std::min(working_bytes(options, g, static_cast<double>(texels), pairs), static_cast<double>(options.memory_bytes)));
    f.seconds.geometry = geometry_seconds;
    f.seconds.matrix = static_cast<double>(f.evidence_rays) * sight.seconds_per_ray + pairs * seconds_per_pair;
    f.seconds.light = static_cast<double>(texels) * (gathers ? sample_light(options, g) : 0) * (1 + first_round_share);
    f.seconds.write = static_cast<double>(texels) * seconds_per_texel + g.shown_pages * static_cast<double>(g.atlas.page_size) * g.atlas.page_size * seconds_per_page_texel;
    return f;
}

Forecast best_within(double seconds, std::span<const NamedOptions> choices, const BakedGeometry& g, double geometry_seconds) {
    Forecast best;
    for (const NamedOptions& choice : choices) {
        Forecast next = forecast(choice, g, geometry_seconds);
        const bool fits = next.seconds.total() <= seconds;
        if (fits || best.name.empty()) best = std::move(next);
        if (!fits) break;
    }
    return best;
}

}  // namespace luxel
