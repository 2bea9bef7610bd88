/// Settings of nodes: what files and extras may say, every wrong type, patterns, and who wins.
#include "formats/gltf/node_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/gltf/gltf_in.h"
#include "tests/unit/gltf/made_gltf.h"

namespace luxel {
namespace {

using nlohmann::json;
using test::bad_input_of;
using test::MadeGltf;
using testing::AllOf;
using testing::HasSubstr;

SettingsFile parsed(const std::string& text) {
    return parse_settings({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, "luxel.json");
}

/// Nodes "chair", "chair" and one without a name, which share a mesh.
MadeGltf three_nodes() {
    MadeGltf made;
    made.primitive(made.square())["mode"] = 5;
    made.json["nodes"] = {{{"name", "chair"}, {"mesh", 0}}, {{"name", "chair"}, {"mesh", 0}}, {{"mesh", 0}}};
    made.json["scenes"][0]["nodes"] = {0, 1, 2};
    return made;
}

SceneRecord read_with(const MadeGltf& made, const std::string& settings = "{}") {
    const SettingsFile file = parsed(settings);
    return read_scene(made.document(), {.settings = &file});
}

TEST(NodeSettings, AllMembers) {
    const SettingsFile file = parsed(R"({"nodes": [{"match": "a", "lightmap": false, "texelsPerMetre": 8, "castShadow": false, "receive": false,
                                                   "twoSided": true, "optional": true}, {"match": "b"}]})");
    ASSERT_EQ(file.nodes.size(), 2u);
    const SettingsEntry& entry = file.nodes[0];
    EXPECT_EQ(entry.match, "a");
    EXPECT_TRUE(entry.optional);
    EXPECT_EQ(entry.settings.lightmap, false);
    EXPECT_EQ(entry.settings.texels_per_metre, 8.0);
    EXPECT_EQ(entry.settings.cast_shadow, false);
    EXPECT_EQ(entry.settings.receive, false);
    EXPECT_EQ(entry.settings.two_sided, true);
    EXPECT_FALSE(file.nodes[1].optional);
    EXPECT_FALSE(file.nodes[1].settings.lightmap || file.nodes[1].settings.texels_per_metre || file.nodes[1].settings.two_sided);
    EXPECT_TRUE(parsed("{}").nodes.empty());
}

TEST(NodeSettings, WrongFilesAreErrorsThatNameTheMember) {
    const auto fault = [](const std::string& text) { return bad_input_of([&] { parsed(text); }); };
    EXPECT_THAT(fault(""), HasSubstr("luxel.json"));
    EXPECT_THAT(fault("{\"nodes\": ["), HasSubstr("not valid JSON"));
    EXPECT_THAT(fault(std::string(100000, '[')), HasSubstr("luxel.json"));
    EXPECT_THAT(fault("[]"), HasSubstr("expected an object"));
    EXPECT_THAT(fault("{\"node\": []}"), HasSubstr("node: unknown"));
    EXPECT_THAT(fault("{\"nodes\": {}}"), HasSubstr("nodes"));
    EXPECT_THAT(fault("{\"nodes\": [3]}"), HasSubstr("nodes[0]"));
    EXPECT_THAT(fault("{\"nodes\": [{\"match\": \"a\"}, {\"lightmap\": true}]}"), AllOf(HasSubstr("nodes[1]"), HasSubstr("\"match\" is missing")));
    EXPECT_THAT(fault("{\"nodes\": [{\"match\": \"\"}]}"), HasSubstr("match"));
    EXPECT_THAT(fault("{\"nodes\": [{\"match\": 3}]}"), HasSubstr("match"));
    EXPECT_THAT(fault("{\"nodes\": [{\"match\": \"a\", \"optional\": 1}]}"), HasSubstr("optional"));
    EXPECT_THAT(fault("{\"nodes\": [{\"match\": \"a\", \"lightMap\": false}]}"), AllOf(HasSubstr("lightMap: unknown"), HasSubstr("lightmap, texelsPerMetre")));
    for (const std::string flag : {"lightmap", "castShadow", "receive", "twoSided"})
        for (const std::string value : {"0", "1", "\"false\"", "null", "[]", "{}", "0.5"})
            EXPECT_THAT(fault(R"({"nodes": [{"match": "a", ")" + flag + "\": " + value + "}]}"), HasSubstr(flag + ": expected true or false"));
    for (const std::string value : {"0", "-1", "true", "\"8\"", "null", "[8]", "1e10", "1e-9", "1e400"})
        EXPECT_NE(fault(R"({"nodes": [{"match": "a", "texelsPerMetre": )" + value + "}]}"), "") << value;
    EXPECT_THAT(fault(R"({"nodes": [{"match": "a", "texelsPerMetre": -1}]})"), HasSubstr("texelsPerMetre: expected a number from 1e-6 to 1e9"));
}

TEST(NodeSettings, Patterns) {
    EXPECT_TRUE(matches_node("chair", "chair", "/hall/chair"));
    EXPECT_FALSE(matches_node("chair", "chair.001", "/hall/chair.001"));
    EXPECT_TRUE(matches_node("chair*", "chair.001", "/hall/chair.001"));
    EXPECT_TRUE(matches_node("ch?[ai]r", "chair", "/x"));
    EXPECT_FALSE(matches_node("Chair", "chair", "/x"));
    EXPECT_FALSE(matches_node("hall", "chair", "/hall/chair"));
    EXPECT_TRUE(matches_node("*", "", "/x"));
    EXPECT_TRUE(matches_node("/hall/*", "chair", "/hall/table/chair:1"));
    EXPECT_TRUE(matches_node("*/chair:1", "chair", "/hall/table/chair:1"));
    EXPECT_FALSE(matches_node("hall/*", "chair", "/hall/chair"));
    EXPECT_TRUE(matches_node("/grass@3", "grass", "/grass@3"));
    EXPECT_FALSE(matches_node("/grass@3", "grass", "/grass@30"));
    EXPECT_TRUE(matches_node("/grass", "grass", "/grass@3"));
    EXPECT_TRUE(matches_node("\\*", "*", "/x"));
    EXPECT_FALSE(matches_node("\\*", "a", "/x"));
}

TEST(NodeSettings, TheFileBeatsTheNodeAndTheNodeTheMesh) {
    MadeGltf made = three_nodes();
    made.json["meshes"][0]["extras"]["luxel"] = {{"texelsPerMetre", 2}, {"lightmap", false}, {"twoSided", true}};
    made.json["nodes"][1]["extras"]["luxel"] = {{"texelsPerMetre", 4}, {"lightmap", true}};
    const SceneRecord record = read_with(made, R"({"nodes": [{"match": "chair", "texelsPerMetre": 8}, {"match": "/chair:1", "texelsPerMetre": 16},
                                                            {"match": "#2", "receive": false}]})");
    EXPECT_TRUE(record.warnings.empty());
    const auto& at = [&](std::size_t k) -> const NodeSettings& { return record.instances[k].settings; };
    EXPECT_EQ(at(0).texels_per_metre, 8.0);
    EXPECT_EQ(at(1).texels_per_metre, 16.0) << "the later entry";
    EXPECT_EQ(at(2).texels_per_metre, 2.0);
    EXPECT_EQ(at(0).lightmap, false);
    EXPECT_EQ(at(1).lightmap, true);
    EXPECT_EQ(at(1).two_sided, true) << "of the mesh";
    EXPECT_EQ(at(2).receive, false);
    EXPECT_FALSE(at(0).receive.has_value());
}

TEST(NodeSettings, PatternsMustMatchUnlessOptional) {
    const MadeGltf made = three_nodes();
    EXPECT_THAT(bad_input_of([&] { read_with(made, R"({"nodes": [{"match": "*"}, {"match": "table", "lightmap": false}]})"); }),
                AllOf(HasSubstr("luxel.json: nodes[1]"), HasSubstr("\"table\" matches no node")));
    read_with(made, R"({"nodes": [{"match": "table", "lightmap": false, "optional": true}]})");
}

TEST(NodeSettings, WrongExtrasAreWarningsAndIgnored) {
    for (const json& wrong : {json(3), json("x"), json::array(), json(true)}) {
        MadeGltf made = three_nodes();
        made.json["nodes"][0]["extras"]["luxel"] = wrong;
        const SceneRecord record = read_with(made);
        ASSERT_EQ(record.warnings.size(), 1u);
        EXPECT_EQ(record.warnings[0].code, "extras-ignored");
    }
    MadeGltf made = three_nodes();
    made.json["meshes"][0]["extras"]["luxel"] = {{"lightmap", 0}, {"texelsPerMetre", "8"}, {"castShadow", nullptr}, {"receive", {}},
                                                 {"twoSided", "yes"}, {"shadow", false}};
    made.json["nodes"][0]["extras"]["luxel"] = {{"texelsPerMetre", -8}, {"receive", false}};
    const SceneRecord record = read_with(made);
    EXPECT_EQ(record.warnings.size(), 7u) << "each once, however many nodes show the mesh";
    EXPECT_EQ(record.instances[0].settings.receive, false);
    for (const InstanceRecord& instance : record.instances) {
        EXPECT_FALSE(instance.settings.lightmap || instance.settings.texels_per_metre || instance.settings.cast_shadow ||
                     instance.settings.two_sided);
    }
    EXPECT_FALSE(record.instances[1].settings.receive.has_value());
}

TEST(NodeSettings, ForeignExtrasMeanNothing) {
    MadeGltf made = three_nodes();
    made.json["nodes"][0]["extras"] = {{"lightmap", false}, {"other", {{"luxel", 3}}}};
    made.json["nodes"][1]["extras"] = "luxel";
    const SceneRecord record = read_with(made);
    EXPECT_TRUE(record.warnings.empty());
    EXPECT_FALSE(record.instances[0].settings.lightmap.has_value());
}

}  // namespace
}  // namespace luxel
