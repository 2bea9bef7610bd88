#include "tools/luxel/sweep_inputs.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <string_view>

#include "baker/sweep/bake_child.h"
#include "formats/base/error.h"
#include "formats/base/file.h"
#include "formats/gltf/gltf_document.h"

namespace luxel {
namespace {

/// The sweep gives these to each bake.
constexpr std::array<std::string_view, 8> own_options{"work", "report", "aov", "stop-after", "preview-every", "checkpoint-every", "verify", "quiet"};
/// Beside those of the groups Input and Light, options that change the layout of the lightmap or what its texels hold.
constexpr std::array<std::string_view, 6> layout_options{"texels-per-metre", "atlas-size", "padding", "uv", "instances", "two-sided"};

bool is_among(std::string_view name, auto& list) { return std::ranges::find(list, name) != list.end(); }

/// What bake knows, without a command line.
struct Known {
    CLI::App app;
    BakeArguments arguments;
    Known() { add_bake_options(app, arguments); }
    [[nodiscard]] const CLI::Option* find(const std::string& option) const { return app.get_option_no_throw("--" + option); }
    [[nodiscard]] std::string group(const std::string& option) const {
        const CLI::Option* found = find(option);
        return found ? found->get_group() : std::string();
    }
};

void check_is_allowed(const Known& known, const GridPoint& point) {
    for (const BakeSetting& s : point.settings) {
        const std::string where = "grid: point \"" + point.name + "\"";
        const CLI::Option* option = known.find(s.option);
        if (!option) throw Error(ErrorCode::usage, where, "luxel bake has no option --" + s.option, "luxel bake --help lists all options");
        const std::string name = option->get_lnames().front(), group = option->get_group();
        if (is_among(name, own_options)) throw Error(ErrorCode::usage, where, "--" + s.option + " is set by the sweep itself", "leave it out");
        if (group == "Input" || group == "Light" || is_among(name, layout_options))
            throw Error(ErrorCode::usage, where, "--" + s.option + " changes what is baked, so that points could not be compared", "give it on the command line, for all points");
    }
}

bool bake_gathers(const BakeArguments& arguments, const std::vector<BakeSetting>& settings, const std::string& name) {
    Known bake;
    std::vector<std::string> words = settings_arguments(settings);
    words.insert(words.begin(), arguments.input);
    std::reverse(words.begin(), words.end());  // as the parser takes them
    try {
        bake.app.parse(words);
        return resolve_bake_options(bake.arguments, bake.app).gather_rays > 0;
    } catch (const CLI::ParseError& error) {
        throw Error(ErrorCode::usage, "grid: point \"" + name + "\"", error.what(), "luxel bake --help lists all options");
    } catch (const Error& error) {
        throw Error(error.code, "grid: point \"" + name + "\": " + error.where, error.what_text, error.hint);
    }
}

void add_file(const std::string& path, KeyBuilder& key) {
    key.text(path);
    if (!path.empty()) key.bytes(read_file(path));
}

}  // namespace

std::vector<BakeSetting> given_settings(const CLI::App& command) {
    const Known known;
    std::vector<BakeSetting> settings;
    for (const CLI::Option* option : known.app.get_options()) {
        if (option->get_lnames().empty() || option->get_lnames().front() == "help") continue;
        const std::string name = option->get_lnames().front();
        const CLI::Option* given = command.get_option_no_throw("--" + name);
        if (!given || given->count() == 0 || name == "quiet") continue;
        if (is_among(name, own_options)) throw Error(ErrorCode::usage, "--" + name, "it is set by the sweep itself", "leave it out");
        const bool has_value = option->get_items_expected_max() > 0;
        settings.push_back({name, has_value ? given->results().front() : std::string(), has_value});
    }
    return settings;
}

std::vector<BakeSetting> settings_of_reference(const std::vector<BakeSetting>& common) {
    const Known known;
    std::vector<BakeSetting> kept;
    for (const BakeSetting& s : common) {
        const std::string group = known.group(s.option);
        // Memory and threads do not change the result, but they may be what it takes.
        if ((group != "Quality" && group != "Running") || s.option == "memory" || s.option == "threads") kept.push_back(s);
    }
    return kept;
}

void check_points(const BakeArguments& arguments, const std::vector<BakeSetting>& common, std::vector<GridPoint>& points) {
    const Known known;
    for (GridPoint& point : points) {
        check_is_allowed(known, point);
        point.has_texel_errors = bake_gathers(arguments, merged_settings(common, point.settings), point.name);
    }
}

Key sweep_key(const BakeArguments& arguments) {
    KeyBuilder key("sweep inputs 1");
    const GltfDocument document = load_gltf(arguments.input, arguments.allow_outside);
    key.text(document.json.dump());
    for (const Bytes& buffer : document.buffers) key.bytes(buffer);
    if (document.json.contains("images") && document.json["images"].is_array())
        for (const auto& image : document.json["images"]) {
            if (!image.is_object() || !image.contains("uri") || !image["uri"].is_string()) continue;
            try {
                key.bytes(read_uri(document, image["uri"], document.name));
            } catch (const Error& error) {
                key.text(error.what());  // bake says what it thinks of that
            }
        }
    add_file(arguments.settings, key);
    add_file(arguments.sky == "none" ? "" : arguments.sky, key);
    return key.bytes(read_file(own_program())).finish();
}

}  // namespace luxel
