// Charts: places on logarithmic axes, and text that cannot break out.
#include "baker/sweep/chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <regex>

namespace luxel {
namespace {

struct Circle {
    double x, y;
};

std::vector<Circle> circles(const std::string& svg) {
    const std::regex pattern("<circle [^>]*cx=\"([0-9.]+)\" cy=\"([0-9.]+)\"");
    std::vector<Circle> found;
    for (std::sregex_iterator at(svg.begin(), svg.end(), pattern), end; at != end; ++at) found.push_back({std::stod((*at)[1]), std::stod((*at)[2])});
    return found;
}

TEST(Chart, PlacesArePowers) {
    Chart chart{"time", "t", {"seconds", ChartUnit::seconds}, {"error", ChartUnit::share}, {{1, 0.1, "a", "", "#p1"}, {10, 0.01, "b", "", "#p2"}, {100, 0.001, "c", "", "#p3"}}, {0, 1, 2}, false};
    const auto at = circles(chart_svg(chart));
    ASSERT_EQ(at.size(), 3u);
    EXPECT_NEAR(at[1].x - at[0].x, at[2].x - at[1].x, 0.2);
    EXPECT_NEAR(at[1].y - at[0].y, at[2].y - at[1].y, 0.2);
    EXPECT_GT(at[1].x, at[0].x + 50);
    EXPECT_GT(at[1].y, at[0].y + 50) << "less error is lower";
}

TEST(Chart, NothingAndOneAndZeroAreDrawn) {
    Chart chart{"time", "t", {"seconds", ChartUnit::seconds}, {"error", ChartUnit::share}, {}, {}, true};
    EXPECT_NE(chart_svg(chart).find("</svg>"), std::string::npos);
    chart.points = {{1, 0, "right", "", "#p1"}, {1, 0.5, "other", "", "#p2"}};
    chart.front = {0};
    for (const Circle& circle : circles(chart_svg(chart))) EXPECT_TRUE(std::isfinite(circle.x) && std::isfinite(circle.y));
    EXPECT_EQ(chart_svg(chart).find("nan"), std::string::npos);
}

TEST(Chart, LabelsKeepOffEachOther) {
    Chart chart{"time", "t", {"seconds", ChartUnit::seconds}, {"error", ChartUnit::share}, {}, {}, false};
    for (int k = 0; k < 3; ++k) chart.points.push_back({1 + 0.01 * k, 0.1 + 0.001 * k, "p", "preset", "#p1", true});
    chart.points.push_back({100, 0.001, "far", "", "#p4"});
    const std::string svg = chart_svg(chart);
    const std::regex pattern("<text text-anchor=\"(start|end)\" x=\"([0-9.]+)\" y=\"([0-9.]+)\" class=\"name\"");
    std::vector<std::string> places;
    for (std::sregex_iterator at(svg.begin(), svg.end(), pattern), end; at != end; ++at) places.push_back((*at)[1].str() + std::to_string(static_cast<int>(std::stod((*at)[3]) / 12)));
    ASSERT_EQ(places.size(), 3u);
    EXPECT_NE(places[0], places[1]);
    EXPECT_NE(places[1], places[2]);
    EXPECT_NE(places[0], places[2]);
}

TEST(Chart, TextIsText) {
    Chart chart{"time", "t", {"seconds", ChartUnit::seconds}, {"error", ChartUnit::share}, {{1, 1, "<script>\"&", "</svg>", "#\"p"}}, {}, false};
    const std::string svg = chart_svg(chart);
    EXPECT_EQ(svg.find("<script"), std::string::npos);
    EXPECT_EQ(svg.find("</svg>"), svg.rfind("</svg>"));
}

TEST(Chart, ValuesHaveTwoDigits) {
    EXPECT_EQ(value_text(1, ChartUnit::share), "100 %");
    EXPECT_EQ(value_text(0.0123, ChartUnit::share), "1.2 %");
    EXPECT_EQ(value_text(12.3, ChartUnit::seconds), "12 s");
    EXPECT_EQ(value_text(123.4, ChartUnit::seconds), "123 s");
    EXPECT_EQ(value_text(0.0421, ChartUnit::seconds), "0.042 s");
    EXPECT_EQ(value_text(1536, ChartUnit::bytes), "1.5 KB");
    EXPECT_EQ(value_text(137.0 * 1024 * 1024, ChartUnit::bytes), "137 MB");
}

}  // namespace
}  // namespace luxel
