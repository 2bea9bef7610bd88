/// What the settings of a sweep mean for luxel bake, checked before anything is baked; and the key of all that its results depend on.
///
/// Errors  Error{usage} naming the point and the option; Error{bad_input} of the scene.
#pragma once
#include <CLI/App.hpp>
#include <vector>

#include "baker/sweep/grid.h"
#include "formats/base/hash.h"
#include "tools/luxel/bake_options.h"

namespace luxel {

/// The options of bake that were given to `command`, as settings. Throws where one is among them that the sweep sets itself.
std::vector<BakeSetting> given_settings(const CLI::App& command);

/// Those of them that the reference keeps: what is baked, not how well.
std::vector<BakeSetting> settings_of_reference(const std::vector<BakeSetting>& common);

/// Parses each point as bake would; fills in has_texel_errors. Throws on what bake refuses, and on options that change what is baked, so that
/// there would be no common reference.
void check_points(const BakeArguments& arguments, const std::vector<BakeSetting>& common, std::vector<GridPoint>& points);

/// Of the scene with its buffers and pictures, the sky and the settings file, and this program.
Key sweep_key(const BakeArguments& arguments);

}  // namespace luxel
