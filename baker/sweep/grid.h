/// The settings that a sweep bakes with: those that come with the program, or those of a file.
///
/// A file is JSON: {"axes": {"rays": [64, 256], "solver": ["shoot", "cg"]}, "points": [{"name": "quick", "quality": "draft"}]}, each member
/// optional. Axes are crossed with each other; points stand for themselves. Members are option names of `luxel bake` without the
/// dashes, values are texts, numbers, or true for an option without a value. Whether bake knows them is for the caller to check.
///
/// Threads  pure.
/// Errors   Error{bad_input} naming file and place: not JSON of this form, names twice, nothing in it, too many points.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "formats/base/bytes.h"

namespace luxel {

/// One option of a bake as it is typed, without the dashes; an option without a value has an empty one.
struct BakeSetting {
    std::string option, value;
    bool has_value = true;
    bool operator==(const BakeSetting&) const = default;
};

struct GridPoint {
    std::string name;  ///< unique in a grid
    std::vector<BakeSetting> settings;
    bool is_preset = false;          ///< a value of --quality and nothing else
    bool has_texel_errors = false;   ///< its bake can write the layer "error": set by who knows the options
};

constexpr std::size_t most_grid_points = 500;  ///< at a few seconds each that is an hour; more is a mistake
constexpr std::size_t most_grid_bytes = std::size_t{1} << 20;

/// `where` names the file in messages.
std::vector<GridPoint> parse_grid(ByteView json, const std::string& where);

/// Names of the grids of the program, the default first.
const std::vector<std::string>& grid_names();
/// One of them. Throws Error{internal} for another name.
std::vector<GridPoint> named_grid(const std::string& name);

/// "--rays 64 --solver cg", each part as a shell reads it back; empty for none.
std::string settings_text(const std::vector<BakeSetting>& settings);
/// The same as arguments of a program.
std::vector<std::string> settings_arguments(const std::vector<BakeSetting>& settings);
/// `base` with `changes` in the place of options that both have.
std::vector<BakeSetting> merged_settings(std::vector<BakeSetting> base, const std::vector<BakeSetting>& changes);

/// One word for a POSIX shell: as it is where nothing in it is special, else in single quotes.
std::string shell_word(const std::string& text);

}  // namespace luxel
