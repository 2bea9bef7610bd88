// The Pareto front, and the choice of a point that meets targets.
#include "baker/sweep/front.h"

#include <gtest/gtest.h>

namespace luxel {
namespace {

TEST(Front, HasWhatNoOtherBeats) {
    //                                   0       1       2       3 worse than 1  4 as dear as 2, worse  5 as 0
    const std::vector<CostAndError> points{{1, 9}, {3, 5}, {8, 1}, {4, 6}, {8, 2}, {1, 9}};
    EXPECT_EQ(pareto_front(points), (std::vector<std::size_t>{0, 1, 2}));
    EXPECT_EQ(pareto_front(std::vector<CostAndError>{}), (std::vector<std::size_t>{}));
    EXPECT_EQ(pareto_front(std::vector<CostAndError>{{2, 2}, {1, 2}, {3, 2}}), (std::vector<std::size_t>{1}));
}

/// Against the definition, on points in no order.
TEST(Front, IsWhatItsDefinitionSays) {
    std::vector<CostAndError> points;
    for (std::uint32_t k = 0; k < 200; ++k) points.push_back({static_cast<double>(k * 2654435761u % 97), static_cast<double>(k * 40503u % 89)});
    std::vector<bool> on_front(points.size());
    for (const std::size_t k : pareto_front(points)) on_front[k] = true;
    for (std::size_t a = 0; a < points.size(); ++a) {
        bool is_beaten = false;
        for (std::size_t b = 0; b < points.size(); ++b) {
            const bool is_as_good = points[b].cost <= points[a].cost && points[b].error <= points[a].error;
            const bool is_better = points[b].cost < points[a].cost || points[b].error < points[a].error || b < a;
            is_beaten |= b != a && is_as_good && is_better;
        }
        EXPECT_EQ(on_front[a], !is_beaten) << a;
    }
}

PointResult point(const char* name, double seconds, double error, std::uint64_t disk) {
    PointResult result;
    result.point.name = name;
    result.seconds = seconds;
    result.error.relative_rmse = error;
    result.disk_bytes = disk;
    return result;
}

TEST(Front, ChoosesTheCheapestThatMeetsAllTargets) {
    std::vector<PointResult> points{point("draft", 1, 0.2, 10), point("medium", 5, 0.05, 50), point("small", 9, 0.04, 5), point("high", 20, 0.01, 200)};
    const auto chosen = [&](const SweepTargets& targets) {
        const PointResult* found = choose_point(points, targets);
        return found ? found->point.name : std::string("none");
    };
    EXPECT_EQ(chosen({.error = 0.05, .seconds = {}, .disk_bytes = {}}), "medium");
    EXPECT_EQ(chosen({.error = 0.05, .seconds = {}, .disk_bytes = 20}), "small");
    EXPECT_EQ(chosen({.error = {}, .seconds = 10, .disk_bytes = {}}), "small") << "the best light in the time";
    EXPECT_EQ(chosen({.error = {}, .seconds = {}, .disk_bytes = 100}), "small");
    EXPECT_EQ(chosen({.error = 0.01, .seconds = 10, .disk_bytes = {}}), "none");
    points[1].failed = true;
    EXPECT_EQ(chosen({.error = 0.05, .seconds = {}, .disk_bytes = {}}), "small");
    points[2].run.is_whole = false;
    EXPECT_EQ(chosen({.error = 0.05, .seconds = {}, .disk_bytes = {}}), "high");
}

}  // namespace
}  // namespace luxel
