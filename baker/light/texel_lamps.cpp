#include "baker/light/texel_lamps.h"

#include <atomic>

#include "baker/core/parallel.h"
#include "baker/light/surface_lamps.h"
#include "baker/light/texel_seed.h"
#include "baker/light/texel_window.h"

namespace luxel {
namespace {

/// Do the texels beside it say that an edge may run through this one? Where there are none, it may.
bool may_be_edge(const TexelGrid& grid, std::uint32_t texel, const std::vector<Rgb>& light, const std::vector<std::uint8_t>& uneven,
                 float other) {
    TexelWindow window(grid, texel);
    window.grow(0);
    const auto beside = window.grow(1);
    if (beside.size() < 2) return true;
    LightRange range;
    for (const TexelWindow::Member& member : beside) {
        if (uneven[member.texel]) return true;
        range.add(luminance(light[member.texel]));
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
        LightRange range;
        light[k] = lamps.by_few(piece, options.points, range);
        uneven[k] = range.is_wide(range.most + other[k]);
    });
    if (options.edge_points > options.points && !stopped) {
        std::vector<std::uint8_t> at_edge(count, 0);
        {
            const TexelGrid grid(page, page_size);
            for_texels([&](std::size_t k) { at_edge[k] = may_be_edge(grid, static_cast<std::uint32_t>(k), light, uneven, other[k]); });
        }
        for_pieces([&](std::size_t k, const SurfaceLamps::Piece& piece) {
            if (at_edge[k]) light[k] = lamps.by_many(piece, options.points, options.edge_points, other[k]);
        });
    }
    if (stopped) return {};
    return light;
}

}  // namespace luxel
