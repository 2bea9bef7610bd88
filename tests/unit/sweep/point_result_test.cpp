// What was measured comes back from its file; medians of stages; tables agree with it.
#include "baker/sweep/point_result.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "baker/sweep/sweep_page.h"
#include "formats/base/error.h"

namespace luxel {
namespace {

PointResult made(const char* name) {
    PointResult r;
    r.point = {name, {{"quality", "draft"}, {"draco", "", false}}, true};
    r.bake_line = "luxel bake 'a b.glb' -o out/x.glb --quality draft --draco";
    r.seconds = 0.125;
    r.repeat_seconds = {0.1, 0.125, 7};
    r.processor_seconds = 0.25;
    r.stages = {{"read", 0.1, 5, 0.2}, {"light", 1.0 / 3, 6, 0.5}};
    r.peak_bytes = 77, r.disk_bytes = 88, r.model_bytes = 99, r.run.texels = 5, r.run.patches = 6, r.run.evidence_rays = std::uint64_t{1} << 40;
    r.run.rays_per_texel = 12.5, r.run.patch_error = 0.25, r.run.picture_median = 0.01, r.run.picture_p95 = 0.02;
    r.error = {.area_m2 = 3, .texels = 4, .mean_lux = 5, .relative_rmse = 0.1, .channel_rmse = {0.1, 0.2, 0.3}, .bias = -0.01, .median = 0.05, .p95 = 0.5,
               .worst = {2, 1, 3, 4, 5.5, 6.5}, .predicted = 0.09, .noise = 0.001, .is_below_noise = true};
    r.error_map_png = {0x89, 'P', 'N', 'G', 0, 0xff};
    return r;
}

PointResult parse(const std::string& text) { return parse_point_file({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, "point.json"); }

TEST(PointResult, ComesBackFromItsFile) {
    PointResult r = made("draft");
    const std::string text = point_file(r);
    EXPECT_EQ(point_file(parse(text)), text);
    EXPECT_EQ(parse(text).error_map_png, r.error_map_png);
    EXPECT_EQ(parse(text).point.settings, r.point.settings);
    r.run.patch_error = r.error.predicted = -1;
    EXPECT_EQ(parse(point_file(r)).error.predicted, -1);
    EXPECT_EQ(parse(point_file(r)).run.patch_error, -1);
}

TEST(PointResult, DamagedFilesAreNamed) {
    const std::string text = point_file(made("draft"));
    for (std::size_t size = 0; size < text.size() - 2; size += 31) EXPECT_THROW(parse(text.substr(0, size)), Error) << size;
    for (const char* member : {"\"seconds\"", "\"error_map\"", "\"relative_rmse\"", "\"stages\""}) {
        std::string other = text;
        other[other.find(member) + 1] = 'x';
        EXPECT_THROW(parse(other), Error) << member;
    }
}

TEST(PointResult, MediansAreOfTheStagesOfOneName) {
    EXPECT_EQ(median_of({3, 1, 2}), 2);
    EXPECT_EQ(median_of({4, 1, 2, 3}), 2.5);
    const auto stages = median_stages({{{"solve", 1, 10}, {"light", 5, 1}, {"solve", 2, 40}}, {{"solve", 9, 20}, {"light", 1, 1}}, {{"solve", 4, 30}, {"light", 2, 1}}});
    EXPECT_EQ(stages, (std::vector<StageCost>{{"solve", 4, 40}, {"light", 2, 1}}));
}

TEST(SweepTables, HaveEveryPointInThreeForms) {
    SweepResult result;
    result.points = {made("draft"), made("me, \"dium\" <b>"), made("broken")};
    result.points[1].seconds = 2, result.points[1].error.relative_rmse = 0.01;
    result.points[2].failed = true, result.points[2].message = "no <i>memory</i>";
    SweepSummary summary{"luxel test", "hall.glb", {{"seed", "3"}}, {.error = 0.05, .seconds = {}, .disk_bytes = {}}, &result.points[1]};
    const auto json = nlohmann::json::parse(sweep_json(result, summary));
    EXPECT_EQ(json["points"].size(), 3u);
    EXPECT_EQ(json["chosen"], "me, \"dium\" <b>");
    EXPECT_EQ(json["points"][2]["failed"], "no <i>memory</i>");
    EXPECT_TRUE(json["points"][0]["on_front"]["seconds"]);
    const std::string csv = sweep_csv(result);
    EXPECT_EQ(std::ranges::count(csv, '\n'), 4);
    EXPECT_NE(csv.find("\r\n\"me, \"\"dium\"\" <b>\",1,--quality draft --draco,,1,2,0.25,77,88,99,"), std::string::npos) << csv;
    // A failed line has as many fields as the head.
    const std::string head = csv.substr(0, csv.find('\r')), last = csv.substr(csv.find("broken"));
    EXPECT_EQ(std::ranges::count(head, ','), std::ranges::count(last, ','));
    const std::string page = sweep_page(result, summary);
    EXPECT_EQ(page.find("<b>\""), std::string::npos);
    EXPECT_NE(page.find("me, &quot;dium&quot; &lt;b&gt;"), std::string::npos);
    EXPECT_NE(page.find("failed: no &lt;i&gt;memory"), std::string::npos);
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_EQ(page.find("http"), std::string::npos) << "no network";
}

}  // namespace
}  // namespace luxel
