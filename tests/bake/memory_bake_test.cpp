// --memory is a promise: peak resident memory <= budget + the scene's geometry, with a matrix of four budgets and more.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>

#include "tests/bake/child_process.h"
#include "tests/bake/whole_bake.h"
#include "tests/support/temporary_folder.h"

namespace luxel::test {
namespace {

constexpr double bytes_per_pair = 8;  // 16 bits of column, 32 of count, and the row's share: a lecture's array of pairs

std::string text_of(const std::filesystem::path& path) {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

double number(const char* name, double otherwise) {
    const char* value = std::getenv(name);
    return value ? std::atof(value) : otherwise;
}

TEST(Memory, PeakStaysWithinBudgetAndGeometry) {
    const TemporaryFolder folder;
    std::ostringstream density, rays, atlas;
    atlas << number("LUXEL_ATLAS", 512);
    density << number("LUXEL_DENSITY", 22);
    rays << number("LUXEL_RAYS", 8192);  // by importance they meet few new pairs: so many make the matrix large
    std::vector<std::string> arguments{"bake", sample("corridor_64").string(), "-o", (folder / "out/scene.glb").string(),
                                       "--work", (folder / "work").string(), "--report", (folder / "report.json").string(),
                                       "--texels-per-metre", density.str(), "--rays", rays.str(), "--gather-rays", "0",
                                       "--tolerance", "1e-2", "--atlas-size", atlas.str(), "--threads", "2", "--memory", "1M"};
    // The refusal of one megabyte states the floor, and what it states must be enough.
    ASSERT_EQ(run_luxel(arguments, folder / "refusal").exit_code, static_cast<int>(ErrorCode::budget_too_small))
        << text_of(folder / "refusal");
    const std::string refusal = text_of(folder / "refusal");
    std::smatch smallest;
    ASSERT_TRUE(std::regex_search(refusal, smallest, std::regex("use --memory ([0-9]+M)"))) << refusal;
    arguments.back() = smallest[1];
    ASSERT_EQ(run_luxel(arguments, folder / "log").exit_code, 0) << text_of(folder / "log");

    const auto report = nlohmann::json::parse(text_of(folder / "report.json"));
    const double matrix = report["counts"]["pairs"].get<double>() * bytes_per_pair;
    const double budget = report["memory"]["budget_bytes"], geometry = report["memory"]["geometry_bytes"];
    const double peak = report["memory"]["peak_bytes"];
    std::printf("%s patches, %s pairs, matrix %.0f MB = %.2f budgets; budget %.0f + geometry %.0f MB, peak %.0f MB\n",
                report["counts"]["patches"].dump().c_str(), report["counts"]["pairs"].dump().c_str(), matrix / 0x1p20,
                matrix / budget, budget / 0x1p20, geometry / 0x1p20, peak / 0x1p20);
    for (const auto& stage : report["stages"])
        std::printf("  %-9s %7.1f s  peak %6.0f MB\n", stage["name"].get<std::string>().c_str(),
                    stage["seconds"].get<double>(), stage["peak_bytes"].get<double>() / 0x1p20);
    EXPECT_GE(matrix, 4 * budget);
    for (const auto& stage : report["stages"])
        EXPECT_LE(stage["peak_bytes"].get<double>(), budget + geometry) << stage["name"];
    EXPECT_LE(peak, budget + geometry);
}

}  // namespace
}  // namespace luxel::test
