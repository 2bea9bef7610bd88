#include "baker/bake/memory_plan.h"

#include <algorithm>

#include "baker/bake/page_image.h"
#include "baker/formfactors/sky_view.h"
#include "baker/light/pane_colour.h"
#include "baker/light/radiosity_detail.h"
#include "baker/light/sky.h"
#include "baker/light/sky_split.h"
#include "baker/solver/coarse_space.h"
#include "formats/base/error.h"

namespace luxel {
namespace {

constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20;
/// What is resident beside the geometry (program, libraries, what the allocator holds back) varies by some 20 MB from run
/// to run; counted in whole steps, the floor that one run states is the floor of the next.
constexpr std::uint64_t fixed_step_bytes = 32 * mebibyte;
std::uint64_t whole_steps(std::uint64_t bytes) { return (bytes / fixed_step_bytes + 1) * fixed_step_bytes; }
/// What a solve holds per patch: its input, area, reflectance, closure, tallies and index by id, and at the end the result (200
/// in all); the solver's own vectors, and a copy of those that it goes on from on its way to the disk (144 in all for shooting,
/// 464 for conjugate gradients). The coarse space and its copy come beside them.
std::uint64_t solve_bytes_per_patch(SolverKind solver) {
    switch (solver) {
        case SolverKind::shoot:
        case SolverKind::shoot_patch:
            return 344;
        case SolverKind::gather:
            return 440;
        case SolverKind::jacobi:
            return 440;
        case SolverKind::cg:
            return 664;
    }
    return 0;
}
constexpr std::uint64_t bytes_per_entry = CoarseSpace::bytes_per_entry + CoarseSpace::saved_bytes_per_entry;
/// Of the standard error: patterns, noise, sums (200), the result (48), beside what is known of the light (170).
constexpr std::uint64_t accuracy_bytes_per_patch = 420;
/// Light of patches that are spread over texels: as the solver has it in double, and with the lamps in float.
/// Beside them the links between neighbours (light/cell_links.h).
constexpr std::uint64_t bytes_per_shown_patch = 24 + 12 + 16;
/// A page on its way out: its picture, its codes, and the encoders' copies of them (output/page_picture.h).
constexpr std::uint64_t bytes_per_page_texel = page_image_bytes_per_texel + 3 + 24;
/// Of gathering: what the solve leaves and was given (200), where light comes from (light/light_guide.h), radiosity, irradiance, noise.
constexpr std::uint64_t gather_bytes_per_patch = 200 + 280 + 36 + 24;
/// A page that is gathered: its lamps, rays, two halves of two kinds of light, what sharing makes of one of them, and places. What
/// comes after is smaller, as the halves are gone.
constexpr std::uint64_t gather_bytes_per_page_texel = 12 + 4 + 4 * 12 + 24 + 20 + 5;
/// Beside it what was gathered so far, the parts of its light and who gets more rays.
constexpr std::uint64_t refine_bytes_per_page_texel = 12 + 4 + 4 * 12 + 36 + 1 + 4;
/// Of each page, while another is gathered: what its texels send, as spread from the patches and as they gather it first, and their errors.
constexpr std::uint64_t kept_bytes_per_page_texel = 2 * RadiosityDetail::bytes_per_page_texel + 4;
/// Of the sky's light on patches, before there is a matrix: lamps and sky, the bright sky alone, ids and neighbourhoods.
constexpr std::uint64_t sky_bytes_per_patch = 2 * sizeof(Rgb) + 8 + 4;
/// Smallest share that pooling and the block cache work with.
constexpr std::uint64_t working_bytes = 24 * mebibyte;

}  // namespace

MemoryPlan plan_memory(std::uint64_t budget_bytes, const MemoryDemand& demand) {
    // A block in work per thread, at the density of a chunk's own block (measured: at most 40 %): 6 bytes a pair decoded,
    // as much again for its counts.
    const std::uint64_t pairs = std::uint64_t{demand.chunk_patches} * demand.chunk_patches * 2 / 5;
    const std::uint64_t blocks = pairs * 12 * demand.threads;
    const std::uint64_t page_texels = std::uint64_t{demand.page_size} * demand.page_size;
    // The lightmap is gone when its layers come.
    const std::uint64_t page = page_texels * std::max(bytes_per_page_texel, demand.layer_bytes_per_texel);
    const std::uint64_t kept_pictures = page_texels * demand.page_count * demand.picture_bytes_per_texel;
    const std::uint64_t pictures = page + kept_pictures + demand.patch_count * bytes_per_shown_patch;
    const std::uint64_t writing = pictures + demand.seam_bytes;
    const std::uint64_t vectors = std::max(demand.patch_count * accuracy_bytes_per_patch,
                                           demand.patch_count * solve_bytes_per_patch(demand.solver) +
                                               CoarseSpace::most_entries(demand.patch_count) * bytes_per_entry);
    const std::uint64_t solving = vectors + blocks + working_bytes;
    const std::uint64_t sky_pixels = std::uint64_t{demand.sky_width} * demand.sky_height;
    const std::uint64_t aiming = sky_pixels ? Sky::bytes(demand.sky_width, demand.sky_height) : 0;
    const std::uint64_t sky = !sky_pixels ? 0 : demand.patch_count * sky_bytes_per_patch + sky_view_block_bytes +
                              sky_pixels * sky_split_bytes_per_pixel + aiming;
    // Drafts light their texels in less than the solve takes, also with these. Finding the colours of panes takes less than
    // the guides of light.
    const std::uint64_t seen = aiming + (demand.has_tinting_panes ? demand.patch_count * pane_colour_bytes_per_patch : 0);
    const std::uint64_t sky_guides = sky_pixels ? demand.threads * sky_view_read_bytes : 0;
    const std::uint64_t gathering = !demand.gathers ? 0 : demand.patch_count * gather_bytes_per_patch + blocks + seen + sky_guides +
                                    page_texels * (gather_bytes_per_page_texel + (demand.refines ? refine_bytes_per_page_texel : 0) + demand.page_count * kept_bytes_per_page_texel);
    const std::uint64_t fixed = whole_steps(demand.fixed_bytes);
    MemoryPlan plan;
    const std::uint64_t aside = demand.previews ? pictures : 0;
    plan.floor_bytes = std::max(fixed + std::max({sky, writing, aside + solving, gathering}), whole_steps(demand.past_peak_bytes));
    if (budget_bytes < plan.floor_bytes) {
        const std::uint64_t smallest = (plan.floor_bytes + mebibyte - 1) / mebibyte;
        throw Error(ErrorCode::budget_too_small, "--memory",
                    std::to_string(budget_bytes / mebibyte) + "M is too small for " + std::to_string(demand.patch_count) + " patches",
                    "use --memory " + std::to_string(smallest) + "M or more; the scene's geometry is not counted");
    }
    const std::uint64_t spare = budget_bytes - fixed - aside - solving + working_bytes;
    plan.pooling_bytes = spare / 2;
    plan.cache_bytes = spare * 3 / 4;
    return plan;
}

std::uint64_t memory_floor(const MemoryDemand& demand) {
    constexpr std::uint64_t enough_for_all = std::uint64_t{1} << 62;
    return plan_memory(enough_for_all, demand).floor_bytes;
}

}  // namespace luxel
