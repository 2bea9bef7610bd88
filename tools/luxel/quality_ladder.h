/// Choices between speed and quality, and --target-seconds, which takes one of them.
#pragma once
#include <string>
#include <vector>

#include "baker/plan/forecast.h"
#include "tools/luxel/bake_options.h"

namespace luxel {

/// The presets, with everything else as the user wants it.
std::vector<NamedOptions> all_presets(const BakeArguments& arguments, const CLI::App& command);

/// Presets and steps between and beyond them, the fastest first. Throws Error{usage} where --target-seconds was given with options that
/// decide the same.
std::vector<NamedOptions> quality_ladder(const BakeArguments& arguments, const CLI::App& command);

/// What --target-seconds took; a name of "" before that.
struct TimeChoice {
    NamedOptions chosen;
    Forecast foreseen;
};

/// Makes the bake take the best of the ladder that it will be done with in --target-seconds, if the user gave it. `choice` is filled
/// once the geometry is known; arguments and choice must outlive the bake. Throws what quality_ladder() throws.
void adapt_to_seconds(BakeOptions& options, const BakeArguments& arguments, const CLI::App& command, TimeChoice& choice);

/// `options` with what was chosen: rays of patches and texels, points on lamps, tolerance.
void take(const NamedOptions& chosen, BakeOptions& options);

}  // namespace luxel
