/// Parts of a bake that a scene may do without. What it does without is decided from the scene, by the stages themselves or in
/// decisions.h; each can be forced, which changes no light (docs/needs.md says within which bound) and costs time.
///
/// Threads: pure.
#pragma once
#include <array>
#include <cstdint>
#include <string>

namespace luxel {

enum class Part : std::uint8_t { copies, textures, see_through, back_patches, lamps, sky, colours, solve, dark_patches, disk };

struct PartInfo {
    Part part;
    const char* name;  ///< on the command line, in plans and reports
};

/// In the order of the bake.
constexpr std::array<PartInfo, 10> all_parts{{
    {Part::copies, "copies"},
    {Part::textures, "textures"},
    {Part::see_through, "see-through"},
    {Part::back_patches, "back-patches"},
    {Part::lamps, "lamps"},
    {Part::sky, "sky"},
    {Part::colours, "colours"},
    {Part::solve, "solve"},
    {Part::dark_patches, "dark-patches"},
    {Part::disk, "disk"},
}};

const char* part_name(Part part);

class PartSet {
  public:
    [[nodiscard]] bool has(Part part) const { return (bits_ >> static_cast<unsigned>(part)) & 1; }
    void add(Part part) { bits_ |= 1u << static_cast<unsigned>(part); }
    bool operator==(const PartSet&) const = default;

  private:
    std::uint32_t bits_ = 0;
};

PartSet every_part();

/// "sky,lamps", in the order of all_parts; "none".
std::string part_names(const PartSet& parts);

/// "sky,lamps" -> these. Throws Error{usage} naming `where`, with all known names.
PartSet parse_parts(const std::string& list, const std::string& where);

}  // namespace luxel
