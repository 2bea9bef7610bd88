#include "baker/light/texel_lamps.h"

#include <atomic>

#include "baker/core/parallel.h"
#include "baker/light/surface_lamps.h"
#include "baker/light/texel_seed.h"
#include "baker/light/texel_window.h"

namespace luxel {
namespace {

/// Of a texel's light: where lamps that are chosen by chance give more, a few choices tell too little.
constexpr float much_by_chance = 0.25f;

/// Do the texels beside it say that an edge may run through this one? Where there are none, it may.
/// `strong`: luminance of what strong lamps give to each texel; `uneven`: where the points of one differ, or where chance decides.
bool may_be_edge(const TexelGrid& grid, std::uint32_t texel, const std::vector<float>& strong, const std::vector<std::uint8_t>& uneven,
                 float other) {
    TexelWindow window(grid, texel);
    window.grow(0);
    const auto beside = window.grow(1);
    if (beside.size() < 2) return true;
    LightRange range;
    for (const TexelWindow::Member& member : beside) {
        if (uneven[member.texel]) return true;
        range.add(strong[member.texel]);
    }
    return range.is_wide(range.most + other);
}

}  // namespace

std::optional<std::vector<Rgb>> texel_lamps(const Scene& scene, const Atlas& atlas, const PageTexels& page, std::uint32_t page_size,
                                            const Tracer& tracer, std::span<const float> other, const TexelLampOptions& options) {
    const std::size_t count = page.texels.size();
    std::vector<Rgb> light(count, Rgb(0, 0, 0));
    if (scene.lamps.empty()) return light;
    const SurfaceLamps lamps(scene, tracer);
    std::vector<std::uint8_t> uneven(count, 0);
    std::vector<float> strong(count, 0);
    std::atomic<bool> stopped{false};
    const auto for_texels = [&](const auto& visit) {
        parallel_ranges(count, 256, [&](std::size_t, std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                if (options.stop && options.stop->is_asked()) stopped = true;
                if (stopped) return;
                if (page.can_send(page.texels[k])) visit(k);
            }
        });
    };
    const auto for_pieces = [&](const auto& visit) {
        for_texels([&](std::size_t k) {
            const Texel& texel = page.texels[k];
            const SurfaceSampler sampler(scene, atlas, {page.fragments.data() + texel.first_fragment, texel.fragment_count}, false);
            visit(k, SurfaceLamps::Piece{sampler, texel_seed(scene, atlas, texel, options.seed), true});
        });
    };
    for_pieces([&](std::size_t k, const SurfaceLamps::Piece& piece) {
        const SurfaceLamps::Few few = lamps.by_few(piece, options.points);
        const float all = luminance(few.light) + other[k];
        light[k] = few.light, strong[k] = few.strong;
        uneven[k] = few.range.is_wide(few.range.most + other[k]) || luminance(few.light) - few.strong > much_by_chance * all;
    });
    if (options.edge_points > options.points && !stopped) {
        std::vector<std::uint8_t> at_edge(count, 0);
        {
            const TexelGrid grid(page, page_size);
            for_texels([&](std::size_t k) { at_edge[k] = may_be_edge(grid, static_cast<std::uint32_t>(k), strong, uneven, other[k]); });
        }
        for_pieces([&](std::size_t k, const SurfaceLamps::Piece& piece) {
            if (at_edge[k]) light[k] = lamps.by_many(piece, options.points, options.edge_points, other[k]);
        });
    }
    if (stopped) return {};
    return light;
}

}  // namespace luxel
