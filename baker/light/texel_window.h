/// The texels around one texel that lie on the same piece of surface: of its chart, and to be walked to step by step away from it
/// without crossing what stands on the surface (Texel::joined_right, joined_down).
/// Threads: TexelGrid is const and shared; a TexelWindow is one thread's.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "baker/patches/texels.h"

namespace luxel {

/// Texels of a page by place.
class TexelGrid {
  public:
    /// Keeps no reference.
    TexelGrid(const PageTexels& page, std::uint32_t page_size);

  private:
    friend class TexelWindow;
    static constexpr std::uint8_t to_right = 1, to_below = 2, sends = 4;
    std::uint32_t size_;
    std::vector<std::uint32_t> index_;  ///< into PageTexels::texels; none: nothing is covered
    std::vector<std::uint8_t> flags_;
    std::vector<std::array<std::uint16_t, 2>> place_;  ///< per texel
};

class TexelWindow {
  public:
    static constexpr int most_radius = 8;
    /// Discs of the window, by squared radius in texels: each holds those before it.
    static constexpr std::array<int, 5> disc_squares{0, 1, 4, 25, 62};
    static constexpr std::array<int, 5> disc_radii{0, 1, 2, 5, 8};
    static constexpr std::size_t disc_count = disc_squares.size();

    struct Place {
        int dx, dy;
    };
    /// Places of all discs, the nearest first; those of disc k are the first disc_ends()[k].
    static std::span<const Place> places();
    static const std::array<std::size_t, disc_count>& disc_ends();

    struct Member {
        Place place;
        std::uint32_t texel;  ///< index
    };
    TexelWindow(const TexelGrid& grid, std::uint32_t centre);
    /// Grows to disc `disc`, by one disc each time, beginning with 0. Returns what it has added: texels that light can be gathered at.
    std::span<const Member> grow(std::size_t disc);
    /// All so far.
    [[nodiscard]] std::span<const Member> members() const { return {members_.data(), count_}; }
    /// Which of places() they are: bit k is place k.
    using Shape = std::array<std::uint64_t, 4>;
    [[nodiscard]] const Shape& shape() const { return shape_; }

  private:
    static constexpr int width = 2 * most_radius + 1;
    [[nodiscard]] bool is_reached(const Place& to, std::size_t there) const;

    const TexelGrid& grid_;
    int x_, y_;
    std::array<bool, std::size_t{width} * width> reached_{};
    std::array<Member, std::size_t{width} * width> members_;
    std::size_t count_ = 0;
    Shape shape_{};
};

}  // namespace luxel
