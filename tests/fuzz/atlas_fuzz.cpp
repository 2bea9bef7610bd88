/// Any blocks as the atlas of a scene: refused as a damaged store, or an atlas that fits the scene and is, written
/// again, the same.
#include <cstddef>

#include "baker/unwrap/atlas_file.h"
#include "tests/fuzz/fuzz_file.h"
#include "tests/fuzz/fuzz_scene.h"

namespace luxel {
namespace {

void check(const Atlas& atlas, const Scene& scene) {
    fuzz::require(atlas.triangle_chart.size() == scene.triangle_count() &&
                  atlas.corner_uv.size() == 3 * scene.triangle_count());
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        fuzz::require(atlas.triangle_chart[t] < atlas.charts.size());
        const Chart& chart = atlas.charts[atlas.triangle_chart[t]];
        fuzz::require(chart.page < atlas.page_count && chart.object == scene.triangle_object[t]);
        for (int k = 0; k < 3; ++k) {
            const Vec2f uv = atlas.page_uv(t, k);
            const auto side = static_cast<float>(atlas.page_size);
            fuzz::require(uv.x >= 0 && uv.y >= 0 && uv.x <= side && uv.y <= side);
        }
    }
}

}  // namespace
}  // namespace luxel

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace luxel;
    static const Scene scene = fuzz::two_boxes();
    const auto path = fuzz::scratch_file(fuzz::contents_from({data, size}, FileKind::atlas, 1));
    Atlas atlas;
    if (!fuzz::accepts([&] { atlas = load_atlas(path, fuzz::key, scene); })) return 0;
    check(atlas, scene);
    save_atlas(path, fuzz::key, atlas);
    const test::BlockContents written = test::contents_of(path);
    const Atlas again = load_atlas(path, fuzz::key, scene);
    save_atlas(path, fuzz::key, again);
    const test::BlockContents twice = test::contents_of(path);
    for (std::size_t k = 0; k < written.parts.size(); ++k)
        fuzz::require(written.parts[k].bytes == twice.parts[k].bytes);
    return 0;
}
