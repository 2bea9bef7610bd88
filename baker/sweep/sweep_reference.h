/// What a sweep measures against: two bakes of the same scene at `--quality reference` with seeds of their own, kept in the sweep's folder; or
/// pages that the user brings.
///
/// Errors  Error{bad_input} naming what is missing. Threads: one at a time.
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "baker/sweep/error_meter.h"
#include "formats/base/bytes.h"
#include "formats/base/hash.h"

namespace luxel {

/// Seeds of the two bakes: none that a user is likely to choose, so that no point shares its noise with the reference.
constexpr std::array<std::uint64_t, 2> reference_seeds{7046029254386353131u, 1442695040888963407u};

class SweepReference {
  public:
    /// Pages of one or two lightmaps, as many of each. `name` is for people.
    SweepReference(std::vector<std::filesystem::path> first, std::vector<std::filesystem::path> second, Key key, std::string name);

    [[nodiscard]] ReferencePage page(std::uint32_t number) const;
    [[nodiscard]] std::size_t page_count() const { return first_.size(); }
    /// Of everything that it was made of.
    [[nodiscard]] const Key& key() const { return key_; }
    [[nodiscard]] const std::string& name() const { return name_; }

  private:
    std::vector<std::filesystem::path> first_, second_;
    Key key_;
    std::string name_;
};

/// From files of the user, page after page; the key is of their bytes.
SweepReference user_reference(const std::vector<std::filesystem::path>& pages);

/// Of a bake: its pages beside `model`, `pages` of them.
std::vector<std::filesystem::path> pages_of(const std::filesystem::path& model, std::uint64_t pages);

/// How far the bake that wrote `model` is from the reference, and its error maps. `has_error`: it has the layer `error`.
struct MeasuredBake {
    ErrorFigures figures;
    Bytes error_map_png;
};
MeasuredBake measure_bake(const std::filesystem::path& model, std::uint64_t pages, bool has_error, const SweepReference& reference);

}  // namespace luxel
