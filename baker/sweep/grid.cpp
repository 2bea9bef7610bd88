#include "baker/sweep/grid.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "formats/base/error.h"

namespace luxel {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t longest_name = 100;

[[noreturn]] void refuse(const std::string& where, const std::string& what, const std::string& hint) {
    throw Error(ErrorCode::bad_input, where, what, hint);
}

constexpr const char* form_hint = R"(the form is {"axes": {"rays": [64, 256]}, "points": [{"name": "quick", "quality": "draft"}]}; docs/sweep.md)";

/// A value as it is typed on the command line.
BakeSetting setting(const std::string& option, const Json& value, const std::string& where) {
    if (option.empty() || option.starts_with('-'))
        refuse(where, "expected the name of an option without dashes, found \"" + option + "\"", "for example \"rays\": 256");
    if (value.is_string()) return {option, value.get<std::string>()};
    if (value.is_number()) return {option, value.dump()};
    if (value.is_boolean() && value.get<bool>()) return {option, "", false};
    refuse(where, "\"" + option + "\": expected a text, a number or true, found " + value.type_name(),
           "leave an option without a value out where it is not wanted");
}

/// "rays 64, solver cg"
std::string name_of(const std::vector<BakeSetting>& settings) {
    std::string name;
    for (const BakeSetting& s : settings) name.append(name.empty() ? "" : ", ").append(s.option).append(s.has_value ? " " : "").append(s.value);
    return name;
}

std::vector<GridPoint> crossed(const Json& axes, const std::string& where) {
    if (!axes.is_object()) refuse(where, "\"axes\": expected an object of lists", form_hint);
    std::vector<GridPoint> points(axes.empty() ? 0 : 1);
    for (const auto& [option, values] : axes.items()) {
        if (!values.is_array() || values.empty()) refuse(where, "\"axes\": \"" + option + "\": expected a list of values", form_hint);
        if (points.size() * values.size() > most_grid_points)
            refuse(where, "its axes make more than " + std::to_string(most_grid_points) + " points", "use fewer values, or list the points that matter under \"points\"");
        std::vector<GridPoint> next;
        for (const GridPoint& point : points)
            for (const Json& value : values) {
                next.push_back(point);
                next.back().settings.push_back(setting(option, value, where));
            }
        points = std::move(next);
    }
    for (GridPoint& point : points) point.name = name_of(point.settings);
    return points;
}

GridPoint listed(const Json& point, std::size_t number, const std::string& where) {
    const std::string place = where + ": point " + std::to_string(number);
    if (!point.is_object()) refuse(place, "expected an object of options", form_hint);
    GridPoint found;
    for (const auto& [option, value] : point.items()) {
        if (option != "name") found.settings.push_back(setting(option, value, place));
        else if (value.is_string() && !value.get_ref<const std::string&>().empty()) found.name = value.get<std::string>();
        else refuse(place, "\"name\": expected a text", form_hint);
    }
    if (found.name.empty()) found.name = found.settings.empty() ? "defaults" : name_of(found.settings);
    if (found.name.size() > longest_name) refuse(place, "its name is longer than " + std::to_string(longest_name) + " bytes", "shorten it");
    return found;
}

void check_names(const std::vector<GridPoint>& points, const std::string& where) {
    std::set<std::string> names;
    for (const GridPoint& point : points)
        if (!names.insert(point.name).second) refuse(where, "two points are called \"" + point.name + "\"", "give each a \"name\" of its own");
}

bool is_preset(const GridPoint& point) { return point.settings.size() == 1 && point.settings[0].option == "quality"; }

BakeSetting text(const char* option, const char* value) { return {option, value}; }

GridPoint preset(const char* quality) { return {quality, {text("quality", quality)}, true}; }

/// A point of `quality` with changes, named after these.
GridPoint changed(const char* quality, std::vector<BakeSetting> changes) {
    GridPoint point{std::string(quality) + ", " + name_of(changes), {text("quality", quality)}};
    point.settings.insert(point.settings.end(), changes.begin(), changes.end());
    return point;
}

void add_rays(std::vector<GridPoint>& points) {
    for (const char* rays : {"64", "256", "1024"})
        for (const char* gather : {"32", "128", "512"})
            if (std::string_view(rays) != "256" || std::string_view(gather) != "128")  // that is medium
                points.push_back(changed("medium", {text("rays", rays), text("gather-rays", gather)}));
    for (const char* rays : {"128", "1024", "4096"}) points.push_back(changed("draft", {text("rays", rays), text("interpolation", "cubic-bspline")}));
}

/// One thing changed at a time.
void add_others(std::vector<GridPoint>& points) {
    for (const auto& [option, values] : std::vector<std::pair<const char*, std::vector<const char*>>>{
             {"patch-texels", {"2", "8"}}, {"error", {"0.05", "0.02"}}, {"share", {"off"}}, {"importance", {"off"}}, {"solver", {"cg", "gather"}},
             {"tolerance", {"1e-2", "1e-5"}}, {"store", {"hot", "none"}}, {"lightmap-format", {"png16", "rgbm", "exr"}}})
        for (const char* value : values) points.push_back(changed("medium", {text(option, value)}));
    for (const char* resolution : {"32", "128"})
        points.push_back(changed("medium", {text("estimator", "hemicube"), text("hemicube-resolution", resolution)}));
    for (const char* way : {"constant", "corners", "catmull-rom"}) points.push_back(changed("draft", {text("interpolation", way)}));
    for (const char* side : {"2", "8"}) points.push_back(changed("draft", {text("patch-texels", side)}));
}

}  // namespace

std::vector<GridPoint> parse_grid(ByteView json, const std::string& where) {
    if (json.size() > most_grid_bytes)
        refuse(where, "it has " + std::to_string(json.size()) + " bytes, expected at most " + std::to_string(most_grid_bytes), "a grid of settings is a small file");
    const Json file = Json::parse(json.begin(), json.end(), nullptr, false);
    if (!file.is_object()) refuse(where, "expected a JSON object", form_hint);
    for (const auto& [member, value] : file.items())
        if (member != "axes" && member != "points") refuse(where, "expected \"axes\" or \"points\", found \"" + member + "\"", form_hint);
    std::vector<GridPoint> points;
    if (file.contains("axes")) points = crossed(file["axes"], where);
    if (file.contains("points")) {
        const Json& list = file["points"];
        if (!list.is_array()) refuse(where, "\"points\": expected a list", form_hint);
        if (points.size() + list.size() > most_grid_points)
            refuse(where, "it has " + std::to_string(points.size() + list.size()) + " points, expected at most " + std::to_string(most_grid_points), "leave out those that do not matter");
        for (std::size_t k = 0; k < list.size(); ++k) points.push_back(listed(list[k], k + 1, where));
    }
    if (points.empty()) refuse(where, "it has no points", form_hint);
    for (GridPoint& point : points) point.is_preset = is_preset(point);
    check_names(points, where);
    return points;
}

const std::vector<std::string>& grid_names() {
    static const std::vector<std::string> names{"default", "rays", "presets"};
    return names;
}

std::vector<GridPoint> named_grid(const std::string& name) {
    std::vector<GridPoint> points{preset("draft"), preset("medium"), preset("high")};
    if (name == "presets") return points;
    add_rays(points);
    if (name == "rays") return points;
    if (name != "default") throw Error(ErrorCode::internal, "sweep", "no grid is called \"" + name + "\"");
    add_others(points);
    return points;
}

std::string shell_word(const std::string& text) {
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./,=:+@%";
    if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
    std::string quoted = "'";
    for (const char letter : text) quoted += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
    return quoted + "'";
}

std::vector<std::string> settings_arguments(const std::vector<BakeSetting>& settings) {
    std::vector<std::string> words;
    for (const BakeSetting& s : settings) {
        words.push_back(std::string("--").append(s.option));
        if (s.has_value) words.push_back(s.value);
    }
    return words;
}

std::string settings_text(const std::vector<BakeSetting>& settings) {
    std::string line;
    for (const std::string& word : settings_arguments(settings)) line.append(line.empty() ? "" : " ").append(shell_word(word));
    return line;
}

std::vector<BakeSetting> merged_settings(std::vector<BakeSetting> base, const std::vector<BakeSetting>& changes) {
    for (const BakeSetting& change : changes) {
        const auto same = std::ranges::find(base, change.option, &BakeSetting::option);
        if (same != base.end()) *same = change;
        else base.push_back(change);
    }
    return base;
}

}  // namespace luxel
