/// Any blocks as where patches see the sky: refused as a damaged store, or counts that are, written again, the same file, and
/// by which no patch gets more light than the whole sky has.
#include <cstddef>

#include "baker/core/units.h"
#include "baker/formfactors/sky_bins.h"
#include "baker/light/patch_sky.h"
#include "formats/bake/sky_view_file.h"
#include "tests/fuzz/fuzz_file.h"

namespace luxel {
namespace {

struct SkyView {
    std::uint64_t patch_count = 0;
    std::uint32_t rays = 0;
    std::vector<SkyCounts> blocks;
};

SkyView load(const std::filesystem::path& path) {
    const SkyViewReader file(path, fuzz::key);
    SkyView view{file.patch_count(), file.rays(), {}};
    for (std::size_t k = 0; k < file.block_count(); ++k) view.blocks.push_back(file.read(k));
    return view;
}

/// The light of a sky of 1 nit from everywhere. Returns how many patches there are.
std::size_t light(const SkyCounts& counts, std::uint32_t rays) {
    const std::vector<Rgb> sky(sky_bin_count, Rgb(1, 1, 1));
    const std::span<const SkyBin> bins(counts.bins);
    const std::span<const std::uint16_t> of_bins(counts.counts);
    std::size_t at = 0;
    for (const std::size_t count : counts.bins_of_patch) {
        fuzz::require(at + count <= bins.size() && at + count <= of_bins.size());
        const Rgb lux = binned_irradiance(sky, bins.subspan(at, count), of_bins.subspan(at, count), rays);
        fuzz::require(lux.x >= 0 && static_cast<double>(lux.x) <= 1.000001 * pi && lux.y == lux.x && lux.z == lux.x);
        at += count;
    }
    fuzz::require(at == bins.size() && at == of_bins.size());
    return counts.bins_of_patch.size();
}

}  // namespace
}  // namespace luxel

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace luxel;
    const test::BlockContents contents = fuzz::contents_from({data, size}, FileKind::sky_view, sky_view_version);
    const auto path = fuzz::scratch_file(contents);
    SkyView view;
    if (!fuzz::accepts([&] { view = load(path); })) return 0;
    std::size_t patches = 0;
    for (const SkyCounts& block : view.blocks) patches += light(block, view.rays);
    fuzz::require(patches == view.patch_count);
    SkyViewWriter file(path, fuzz::key, view.patch_count, view.rays);
    for (const SkyCounts& block : view.blocks) file.append(block);
    file.publish();
    const test::BlockContents written = test::contents_of(path);
    fuzz::require(written.parts.size() == contents.parts.size());
    for (std::size_t k = 0; k < written.parts.size(); ++k)
        fuzz::require(written.parts[k].bytes == contents.parts[k].bytes);
    return 0;
}
