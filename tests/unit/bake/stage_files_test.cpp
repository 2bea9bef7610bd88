/// What small stages keep in the bake folder comes back bit for bit; absent is empty; damage and other sizes are
/// errors.
#include "baker/bake/stage_files.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/damage.h"
#include "tests/support/temporary_folder.h"

namespace luxel {
namespace {

const Key key{5, 6}, other_key{5, 7};

std::vector<double> numbers(std::size_t count, unsigned seed) {
    std::mt19937_64 random(seed);
    std::vector<double> values(count);
    for (double& value : values)
        value = std::ldexp(static_cast<double>(random()), static_cast<int>(random() % 200) - 100);
    return values;
}

std::vector<Channels> channel_numbers(std::size_t count, unsigned seed) {
    const auto flat = numbers(3 * count, seed);
    std::vector<Channels> values(count);
    for (std::size_t k = 0; k < count; ++k) values[k] = {flat[3 * k], flat[3 * k + 1], -flat[3 * k + 2]};
    return values;
}

/// Every flipped byte and every other size or key is refused; an absent file is no value.
void expect_careful(const std::filesystem::path& path, const std::function<bool(const Key&, std::size_t)>& load,
                    std::size_t count) {
    EXPECT_TRUE(load(key, count));
    for (const std::size_t other : {count - 1, count + 1})
        EXPECT_TRUE(test::refused({}, [&](ByteView) { load(key, other); })) << other;
    EXPECT_TRUE(test::refused({}, [&](ByteView) { load(other_key, count); })) << "another key";
    const Bytes whole = read_file(path);
    for (std::size_t at = 0; at < whole.size(); at += 11) {
        Bytes bytes = whole;
        bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ 4);
        publish_file(path, bytes);
        EXPECT_TRUE(test::refused({}, [&](ByteView) { load(key, count); })) << "byte " << at;
    }
    std::filesystem::remove(path);
    EXPECT_FALSE(load(key, count));
}

TEST(StageFiles, Closure) {
    const test::TemporaryFolder folder;
    Closure closure;
    closure.mu = numbers(20, 1), closure.diagonal_m2 = numbers(20, 2), closure.row_open_m2 = numbers(20, 3);
    closure.report = {7, 0.5, 0.25, 1e-9, 1e-12, 0.1, 1e-16, 3, 1e-5, 0.75, 0.125};
    save_closure(folder / "c", key, closure);
    const auto found = load_closure(folder / "c", key, 20);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->mu, closure.mu);
    EXPECT_EQ(found->diagonal_m2, closure.diagonal_m2);
    EXPECT_EQ(found->row_open_m2, closure.row_open_m2);
    EXPECT_EQ(found->report.iterations, 7u);
    EXPECT_EQ(found->report.max_row_error_before, 0.5);
    EXPECT_EQ(found->report.mean_row_error_before, 0.25);
    EXPECT_EQ(found->report.max_row_error_after, 1e-9);
    EXPECT_EQ(found->report.mean_row_error_after, 1e-12);
    EXPECT_EQ(found->report.diagonal_share, 0.1);
    EXPECT_EQ(found->report.remainder_share, 1e-16);
    EXPECT_EQ(found->report.short_rows, 3u);
    EXPECT_EQ(found->report.short_share, 1e-5);
    EXPECT_EQ(found->report.largest_change, 0.75);
    EXPECT_EQ(found->report.mean_change, 0.125);
    expect_careful(
        folder / "c", [&](const Key& k, std::size_t n) { return load_closure(folder / "c", k, n).has_value(); }, 20);
}

TEST(StageFiles, Solution) {
    const test::TemporaryFolder folder;
    for (const bool converged : {false, true}) {
        SolveResult result;
        result.solver = "shooting";
        result.radiosity = channel_numbers(15, 4);
        result.unshot = channel_numbers(15, 5);
        result.irradiance = channel_numbers(15, 6);
        result.error_bound = 1e-4;
        result.converged = converged;
        result.reads = 2.5;
        result.history = {{4096, 1}, {1ULL << 40, 1e-4}};
        save_solution(folder / "s", key, result);
        const auto found = load_solution(folder / "s", key, 15);
        ASSERT_TRUE(found);
        EXPECT_EQ(found->solver, result.solver);
        EXPECT_EQ(found->radiosity, result.radiosity);
        EXPECT_EQ(found->unshot, result.unshot);
        EXPECT_EQ(found->irradiance, result.irradiance);
        EXPECT_EQ(found->error_bound, result.error_bound);
        EXPECT_EQ(found->converged, converged);
        EXPECT_EQ(found->reads, 2.5);
        ASSERT_EQ(found->history.size(), 2u);
        EXPECT_EQ(found->history[1].bytes_read, 1ULL << 40);
        EXPECT_EQ(found->history[1].error_bound, 1e-4);
    }
    expect_careful(
        folder / "s", [&](const Key& k, std::size_t n) { return load_solution(folder / "s", k, n).has_value(); }, 15);
}

TEST(StageFiles, Lightmap) {
    const test::TemporaryFolder folder;
    std::vector<Rgb> irradiance;
    for (const Channels& c : channel_numbers(25, 7))
        irradiance.emplace_back(static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]));
    save_lightmap(folder / "l", key, irradiance);
    EXPECT_EQ(load_lightmap(folder / "l", key, 25), irradiance);
    expect_careful(
        folder / "l", [&](const Key& k, std::size_t n) { return load_lightmap(folder / "l", k, n).has_value(); }, 25);
    save_lightmap(folder / "none", key, {});
    EXPECT_EQ(load_lightmap(folder / "none", key, 0), std::vector<Rgb>()) << "a page without texels";
}

}  // namespace
}  // namespace luxel
