/// Line segments in a hash grid with a level per power of two of their lengths: which longer ones lie near a given one?
/// Source: the hierarchical spatial hash of Eitz and Lixu, Hierarchical Spatial Hashing for Real-time Collision
/// Detection, SMI 2007.
///
/// A segment lies in the cells of its level, whose side is at least its length, that its box meets: hardly ever more
/// than 8. Memory: about 100 bytes per segment. Threads: const and reentrant once built; building
/// uses them all.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "baker/core/vec.h"

namespace luxel {

struct GridSegment {
    Vec3d from, to;
};

class EdgeGrid {
  public:
    /// `near_m`: segments that near each other meet, > 0 unless there are none. Segments are finite and longer than 0.
    EdgeGrid(std::vector<GridSegment> segments, double near_m);

    /// Segments whose boxes, grown by near_m, meet that of `segment`, none of a lower level, and of the same level
    /// only higher numbers, so that each pair appears once; ascending. Looks at `most` at each level at most, lowest
    /// numbers first.
    [[nodiscard]] std::vector<std::uint32_t> longer_near(std::uint32_t segment, std::size_t most) const;

  private:
    struct Box {
        Vec3d low, high;
    };
    [[nodiscard]] Box box(std::uint32_t segment) const;
    [[nodiscard]] int level(std::uint32_t segment) const;
    template <class Visit>
    void for_cells(const Box& box, int level, const Visit& visit) const;
    [[nodiscard]] bool meet(std::uint32_t a, std::uint32_t b) const;

    std::vector<GridSegment> segments_;
    double near_m_;
    std::vector<std::int16_t> levels_;  // per segment
    std::vector<int> used_levels_;      // ascending
    std::uint64_t bucket_mask_ = 0;
    std::vector<std::uint64_t> first_;    // per bucket, into members_
    std::vector<std::uint32_t> members_;  // ascending inside a bucket
};

}  // namespace luxel
