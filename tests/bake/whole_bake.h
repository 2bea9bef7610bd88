/// What the tests of a whole bake share: small settings, edited samples, and the bytes and numbers of what came out.
#pragma once
#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "baker/bake/bake.h"
#include "baker/solver/solver.h"

namespace luxel::test {

/// Root of the source tree, and the program under test.
std::filesystem::path source_folder();
std::filesystem::path luxel_program();

/// samples/<name>/<name>.gltf
std::filesystem::path sample(const std::string& name);

/// Writes a sample with its JSON changed by `edit` to `folder` (its buffer beside it); returns the new file.
std::filesystem::path edited_sample(const std::string& name, const std::filesystem::path& folder,
                                    const std::function<void(nlohmann::json&)>& edit);

/// Few texels, few rays, two threads; gathering with 16 rays a texel.
BakeOptions small_options(const std::filesystem::path& input, const std::filesystem::path& output);

/// Relative path -> bytes of every file below `folder`, temporary files of killed runs left out.
using FileBytes = std::map<std::string, std::string>;
FileBytes files_below(const std::filesystem::path& folder);
/// The names that differ or are missing on one side; empty means equal.
std::string differences(const FileBytes& expected, const FileBytes& found);

/// What a bake has left.
struct FinishedBake {
    BakeReport report;
    FileBytes outputs, stored;  ///< files of the output's folder, files of the bake folder

    /// Files of the bake folder whose name begins with `stem`.
    [[nodiscard]] FileBytes files(const std::string& stem) const;
};
/// Bakes in a folder of its own: outputs in out/, bake folder in work/.
FinishedBake bake_in(const std::filesystem::path& folder, BakeOptions options);

/// The key that a file of a bake folder bears in its name.
Key key_in_name(const std::string& name);
/// The file of a finished bake folder whose name begins with `stem`, and the solution stored in one.
std::filesystem::path stored_file(const std::filesystem::path& work, const std::string& stem);
SolveResult stored_solution(const std::filesystem::path& work, std::size_t patch_count);

/// Pixels of one EXR page: irradiance in the first three; 0 where a texel has no value.
struct PagePixels {
    std::uint32_t width = 0, height = 0;
    std::vector<std::array<float, 4>> pixels;
};
/// All EXR pages that the report lists, in order.
std::vector<PagePixels> lightmap_pages(const BakeReport& report);
/// Irradiance of every covered texel of the bake folder, page after page, in texel order.
std::vector<float> stored_irradiance(const std::filesystem::path& work);

/// |emitted - absorbed - lost| / emitted of the worst channel.
double energy_imbalance(const BakeReport& report);

/// The smallest budget with which these options work, in bytes, as the refusal of a smaller one states it.
std::uint64_t smallest_memory(BakeOptions options);

}  // namespace luxel::test
