// Grids of settings: what a file means, what is refused, and the grids of the program.
#include "baker/sweep/grid.h"

#include <gtest/gtest.h>

#include <set>

#include "formats/base/error.h"

namespace luxel {
namespace {

std::vector<GridPoint> parse(const std::string& text) { return parse_grid({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, "grid.json"); }

std::string refusal(const std::string& text) {
    try {
        parse(text);
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::bad_input);
        EXPECT_TRUE(error.where.starts_with("grid.json")) << error.where;
        EXPECT_FALSE(error.hint.empty());
        return error.what_text;
    }
    ADD_FAILURE() << "accepted: " << text;
    return {};
}

TEST(Grid, AxesAreCrossedAndPointsStandAlone) {
    const auto points = parse(R"({"axes": {"rays": [64, 256], "solver": ["shoot", "cg"]}, "points": [{"name": "quick", "quality": "draft", "gather-rays": 0}, {"quality": "high"}, {}]})");
    ASSERT_EQ(points.size(), 7u);
    EXPECT_EQ(points[0].name, "rays 64, solver shoot");
    EXPECT_EQ(points[1].settings, (std::vector<BakeSetting>{{"rays", "64"}, {"solver", "cg"}}));
    EXPECT_EQ(points[3].name, "rays 256, solver cg");
    EXPECT_EQ(points[4].name, "quick");
    EXPECT_EQ(points[4].settings, (std::vector<BakeSetting>{{"quality", "draft"}, {"gather-rays", "0"}}));
    EXPECT_FALSE(points[4].is_preset);
    EXPECT_EQ(points[5].name, "quality high");
    EXPECT_TRUE(points[5].is_preset);
    EXPECT_EQ(points[6].name, "defaults");
}

TEST(Grid, ValuesAreTextsNumbersAndTrue) {
    const auto points = parse(R"({"points": [{"tolerance": 1e-3, "error": 0.05, "draco": true, "share": "off"}]})");
    EXPECT_EQ(settings_arguments(points[0].settings), (std::vector<std::string>{"--tolerance", "0.001", "--error", "0.05", "--draco", "--share", "off"}));
}

TEST(Grid, WhatIsNoGridIsRefused) {
    for (const char* text : {"", "{", "[]", "7", "{\"axes\": []}", "{\"axes\": {\"rays\": 64}}", "{\"axes\": {\"rays\": []}}", "{\"points\": {}}", "{\"points\": [7]}", "{\"points\": []}", "{}",
                             "{\"points\": [{\"rays\": null}]}", "{\"points\": [{\"rays\": [1]}]}", "{\"points\": [{\"draco\": false}]}", "{\"points\": [{\"name\": 3}]}", "{\"points\": [{\"name\": \"\"}]}"})
        EXPECT_FALSE(refusal(text).empty());
    EXPECT_NE(refusal("{\"axis\": {}}").find("found \"axis\""), std::string::npos);
    EXPECT_NE(refusal("{\"points\": [{\"--rays\": 3}]}").find("without dashes"), std::string::npos);
    EXPECT_NE(refusal(R"({"points": [{"name": "a", "rays": 64}, {"name": "a", "rays": 65}]})").find("two points are called \"a\""), std::string::npos);
    EXPECT_NE(refusal(std::string(most_grid_bytes + 1, ' ')).find("bytes"), std::string::npos);
}

TEST(Grid, AbsurdNumbersOfPointsAreRefused) {
    std::string axis, axes;
    for (int k = 0; k < 100; ++k) axis += (k ? "," : "") + std::to_string(k);
    for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h"}) axes += (axes.empty() ? "\"" : ",\"") + std::string(name) + "\":[" + axis + "]";
    EXPECT_NE(refusal("{\"axes\":{" + axes + "}}").find("more than 500 points"), std::string::npos);
    std::string points;
    for (int k = 0; k < 501; ++k) points += (k ? ",{\"seed\":" : "{\"seed\":") + std::to_string(k) + "}";
    EXPECT_NE(refusal("{\"points\":[" + points + "]}").find("501 points"), std::string::npos);
}

TEST(Grid, ThoseOfTheProgramHaveNamesAndThePresets) {
    for (const std::string& name : grid_names()) {
        const auto points = named_grid(name);
        std::set<std::string> names, settings;
        for (const GridPoint& point : points) {
            names.insert(point.name);
            settings.insert(settings_text(point.settings));
        }
        EXPECT_EQ(names.size(), points.size()) << name;
        EXPECT_EQ(settings.size(), points.size()) << name << ": nothing is baked twice";
        for (const char* preset : {"draft", "medium", "high"}) EXPECT_TRUE(names.contains(preset)) << name;
    }
    EXPECT_EQ(named_grid("presets").size(), 3u);
}

TEST(Grid, LinesAreReadBackByAShell) {
    EXPECT_EQ(shell_word("out/hall.glb"), "out/hall.glb");
    EXPECT_EQ(shell_word("my hall.glb"), "'my hall.glb'");
    EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
    EXPECT_EQ(shell_word(""), "''");
    EXPECT_EQ(shell_word("a;rm -rf $HOME"), "'a;rm -rf $HOME'");
    EXPECT_EQ(shell_word("~/x"), "'~/x'");
}

TEST(Grid, APointsOwnSettingsCount) {
    const auto merged = merged_settings({{"rays", "64"}, {"seed", "3"}}, {{"rays", "128"}, {"solver", "cg"}});
    EXPECT_EQ(settings_text(merged), "--rays 128 --seed 3 --solver cg");
}

}  // namespace
}  // namespace luxel
