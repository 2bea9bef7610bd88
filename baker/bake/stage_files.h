/// Results of small stages in the bake folder: block files whose blocks are columns (formats/base/block_file.md).
///
/// closure   kind 4, version 1: 0 mu (f64), 1 diagonal_m2 (f64), 2 row_open_m2 (f64), 3 report (f64: iterations, largest
///           and mean row error before, the same after, diagonal share, remainder share,
///           short rows, their share, largest and mean change).
/// solution  kind 5, version 1: 0 radiosity (f64, 3 per patch), 1 unshot (f64, 3 per patch), 2 report (f64: error bound,
///           reads, converged 0/1), 3 history (f64 pairs: bytes read, bound), 4 name of the solver (text),
///           5 irradiance (f64, 3 per patch).
/// plan      kind 9, version 1: 0 first level, 1 last level of this round (u8 each, per patch; first > last: none).
/// accuracy  kind 10, version 1: 0 sigma of radiosity (f64, 3 per patch), 1 sigma of irradiance (f64, 3 per patch),
///           2 relative error (f64).
/// lightmap  kind 6, version 2, per texel of the page, in texel order: 0 direct (f32, 3 each, lux), 1 indirect (f32, 3 each, lux),
///           2 relative error (f32), 3 rays (u32), 4 of the error, sharing (f32).
/// checkpoint kind 13, version 2: SolveState: 0 name of the solver (text), 1 bytes that came from the disk, bytes that were
///           asked for (2 u64), 2 history: bytes read (u64), 3 history: bound (f64), 4 sizes of the solver's vectors (u64),
///           5 ... the vectors one after the other (f64), each in pieces of 65536 numbers, its last one shorter.
#pragma once
#include <filesystem>
#include <optional>

#include "baker/accuracy/standard_error.h"
#include "baker/formfactors/closure.h"
#include "baker/formfactors/level_plan.h"
#include "baker/light/texel_light.h"
#include "baker/solver/solver.h"
#include "formats/base/block_file.h"

namespace luxel {

void save_plan(const std::filesystem::path& path, const Key& key, const LevelPlan& plan);
/// Empty if the file is absent, here and below. Throws Error{damaged_store} for damage, sizes other than patch_count,
/// and numbers that no save_ function would be given: not finite (but for error bounds), counts that are not whole,
/// levels out of order.
std::optional<LevelPlan> load_plan(const std::filesystem::path& path, const Key& key, std::size_t patch_count);

void save_closure(const std::filesystem::path& path, const Key& key, const Closure& closure);
std::optional<Closure> load_closure(const std::filesystem::path& path, const Key& key, std::size_t patch_count);

void save_solution(const std::filesystem::path& path, const Key& key, const SolveResult& result);
std::optional<SolveResult> load_solution(const std::filesystem::path& path, const Key& key, std::size_t patch_count);

void save_checkpoint(const std::filesystem::path& path, const Key& key, const SolveState& state);
/// Empty also for another version: what was in work is begun again. Whether the vectors fit is for the solver to say; none
/// of their numbers is a not-a-number.
std::optional<SolveState> load_checkpoint(const std::filesystem::path& path, const Key& key);

void save_accuracy(const std::filesystem::path& path, const Key& key, const StandardError& error);
std::optional<StandardError> load_accuracy(const std::filesystem::path& path, const Key& key, std::size_t patch_count);

void save_page_light(const std::filesystem::path& path, const Key& key, std::span<const TexelLight> light);
std::optional<std::vector<TexelLight>> load_page_light(const std::filesystem::path& path, const Key& key, std::size_t texel_count);
/// Of the same file, TexelLight::irradiance alone.
std::optional<std::vector<Rgb>> load_page_irradiance(const std::filesystem::path& path, const Key& key, std::size_t texel_count);

}  // namespace luxel
