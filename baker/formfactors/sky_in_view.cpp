#include "baker/formfactors/sky_in_view.h"

#include "formats/base/error.h"

namespace luxel {

SkyInView::SkyInView(const std::filesystem::path& path, const Key& key, std::size_t patch_count, std::vector<Rgb> bin_nits)
    : view_(path, key), bin_nits_(std::move(bin_nits)) {
    if (view_.patch_count() != patch_count)
        throw Error(ErrorCode::damaged_store, path.string(),
                    "expected " + std::to_string(patch_count) + " patches, found " + std::to_string(view_.patch_count()),
                    "remove the file and run the same command again");
}

void SkyInView::visit(PatchNumber begin, PatchNumber end, const Visit& visit) const {
    for (std::size_t block = begin / sky_view_block; block * sky_view_block < end; ++block) {
        const SkyCounts found = view_.read(block);
        const std::span<const SkyBin> bins(found.bins);
        const std::span<const std::uint16_t> counts(found.counts);
        std::size_t at = 0;
        for (std::size_t k = 0; k < found.bins_of_patch.size(); ++k) {
            const std::size_t count = found.bins_of_patch[k];
            const auto patch = static_cast<PatchNumber>(block * sky_view_block + k);
            if (patch >= begin && patch < end) visit(patch, bins.subspan(at, count), counts.subspan(at, count));
            at += count;
        }
    }
}

}  // namespace luxel
