/// The sky as patches see it: the directions in which each has the open sky (formfactors/sky_view.h), and how bright it is there.
#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "baker/core/vec.h"
#include "baker/patches/patch.h"
#include "formats/bake/sky_view_file.h"

namespace luxel {

/// Threads: const and reentrant; a block of the file is read as often as it is asked for.
class SkyInView {
  public:
    /// `bin_nits`: mean radiance of each bin (SkySplit::bins). Throws Error{damaged_store}: see SkyViewReader, or a view of another
    /// number of patches.
    SkyInView(const std::filesystem::path& path, const Key& key, std::size_t patch_count, std::vector<Rgb> bin_nits);

    /// Of the rays() that left a patch: the bins that open ones went into, and how many.
    using Visit = std::function<void(PatchNumber patch, std::span<const SkyBin> bins, std::span<const std::uint16_t> counts)>;
    /// Of patches [begin, end), in their order.
    void visit(PatchNumber begin, PatchNumber end, const Visit& visit) const;
    [[nodiscard]] std::uint32_t rays() const { return view_.rays(); }
    [[nodiscard]] const std::vector<Rgb>& bin_nits() const { return bin_nits_; }

  private:
    SkyViewReader view_;
    std::vector<Rgb> bin_nits_;
};

}  // namespace luxel
