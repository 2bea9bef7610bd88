/// Joins the lightmaps along their seams, over all pages at once although only one is in memory at a time: what is read
/// at seams is a small part of the texels, so it is picked from each page in a first pass, solved for all together, and
/// put into the pages when they are made again to be written. Making a page twice costs a read of its light; holding
/// all of them would make --memory grow with the scene.
#pragma once
#include "baker/bake/page_image.h"
#include "baker/output/seam_join.h"

namespace luxel {

class JoinedSeams {
  public:
    /// Nothing is joined.
    JoinedSeams() = default;
    JoinedSeams(const BakeOptions& options, const BakedGeometry& geometry, const BakedLight& light);

    /// Puts the joined texels of a page into its picture.
    void put_into(std::uint32_t page, std::uint32_t page_size, PageImage& image) const;
    [[nodiscard]] const SeamReport& report() const { return report_; }

  private:
    std::vector<SeamTexel> texels_;
    std::vector<Rgb> values_;  // one each
    SeamReport report_;
};

}  // namespace luxel
