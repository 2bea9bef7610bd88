/// What small stages keep in the bake folder comes back bit for bit; absent is empty; damage and other sizes are
/// errors.
#include "baker/bake/stage_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
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

/// Damage and every other size or key are refused; an absent file is no value.
void expect_careful(const std::filesystem::path& path, const std::function<bool(const Key&, std::size_t)>& load,
                    std::size_t count) {
    EXPECT_TRUE(load(key, count));
    for (const std::size_t other : {count - 1, count + 1})
        EXPECT_TRUE(test::file_refused(path, [&] { load(key, other); })) << other;
    EXPECT_TRUE(test::file_refused(path, [&] { load(other_key, count); })) << "another key";
    test::expect_guarded(path, [&] { load(key, count); });
    test::expect_tags_guarded(path, [&] { load(key, count); });
    const auto loads = [&] { load(key, count); };
    const Bytes whole = read_file(path);
    for (std::size_t block = 0; block < test::contents_of(path).parts.size(); ++block) {
        test::rewrite(path,
                      [&](auto& file) { file.parts.erase(file.parts.begin() + static_cast<std::ptrdiff_t>(block)); });
        EXPECT_TRUE(test::file_refused(path, loads)) << "without block " << block;
        publish_file(path, whole);
    }
    std::filesystem::remove(path);
    EXPECT_FALSE(load(key, count));
}

/// The file with number `at` of column `block` replaced, all checksums right; then the file as it was.
template <class T>
bool refuses(const std::filesystem::path& path, std::size_t block, std::size_t at, T value,
             const std::function<void()>& load) {
    const Bytes whole = read_file(path);
    test::rewrite(path, [&](auto& file) { test::set_element<T>(file.parts[block], at, value); });
    const bool refused = test::file_refused(path, load);
    publish_file(path, whole);
    return refused;
}

/// No number of these columns may be infinite or not a number.
template <class T>
void expect_finite(const std::filesystem::path& path, std::initializer_list<std::size_t> columns,
                   const std::function<void()>& load) {
    for (const std::size_t block : columns)
        for (const T value : {std::numeric_limits<T>::infinity(), -std::numeric_limits<T>::infinity(),
                              std::numeric_limits<T>::quiet_NaN()})
            EXPECT_TRUE(refuses<T>(path, block, 0, value, load)) << value << " in column " << block;
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
    const auto load = [&] { load_closure(folder / "c", key, 20); };
    expect_finite<double>(folder / "c", {0, 1, 2, 3}, load);
    EXPECT_TRUE(refuses(folder / "c", 0, 3, -1e-300, load)) << "a negative mu";
    EXPECT_FALSE(refuses(folder / "c", 1, 3, -1e-300, load)) << "a remainder may be negative";
    for (const double count : {-1.0, -0.0, 0.5, 4294967296.0})
        EXPECT_TRUE(refuses(folder / "c", 3, 0, count, load)) << count << " iterations";
    for (const double count : {-1.0, 0.5, 1e300})
        EXPECT_TRUE(refuses(folder / "c", 3, 7, count, load)) << count << " short rows";
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
    const auto load = [&] { load_solution(folder / "s", key, 15); };
    const double infinite = std::numeric_limits<double>::infinity(), no_number = std::nan("");
    expect_finite<double>(folder / "s", {0, 1, 5}, load);
    for (const double bound : {-1.0, no_number}) {
        EXPECT_TRUE(refuses(folder / "s", 2, 0, bound, load)) << "bound " << bound;
        EXPECT_TRUE(refuses(folder / "s", 3, 3, bound, load)) << "bound " << bound << " of a step";
    }
    EXPECT_FALSE(refuses(folder / "s", 2, 0, infinite, load)) << "before there is a bound";
    EXPECT_FALSE(refuses(folder / "s", 3, 1, infinite, load)) << "before there is a bound";
    for (const double reads : {-1.0, infinite, no_number})
        EXPECT_TRUE(refuses(folder / "s", 2, 1, reads, load)) << "reads " << reads;
    for (const double flag : {-1.0, 0.5, 2.0, no_number})
        EXPECT_TRUE(refuses(folder / "s", 2, 2, flag, load)) << "converged " << flag;
    for (const double bytes : {-1.0, 0.5, 1e16, infinite, no_number})
        EXPECT_TRUE(refuses(folder / "s", 3, 2, bytes, load)) << bytes << " bytes";
    EXPECT_TRUE(refuses<std::uint8_t>(folder / "s", 4, 0, 7, load)) << "a name with a bell";
    expect_careful(
        folder / "s", [&](const Key& k, std::size_t n) { return load_solution(folder / "s", k, n).has_value(); }, 15);
}

TEST(StageFiles, Checkpoint) {
    const test::TemporaryFolder folder;
    const auto path = folder / "k";
    const double infinite = std::numeric_limits<double>::infinity(), no_number = std::nan("");
    const SolveState state{"shoot", 1ULL << 60, 3, {{4096, infinite}, {1ULL << 40, 1e-4}},
                           {numbers(40, 1), {}, {infinite, -0.0, 5e-324}, numbers(150000, 1)}};
    save_checkpoint(path, key, state);
    const auto found = load_checkpoint(path, key);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->solver, state.solver);
    EXPECT_EQ(found->bytes_read, state.bytes_read);
    EXPECT_EQ(found->requested_bytes, 3u);
    ASSERT_EQ(found->history.size(), 2u);
    EXPECT_EQ(found->history[0].error_bound, infinite);
    EXPECT_EQ(found->history[1].bytes_read, 1ULL << 40);
    EXPECT_EQ(found->numbers, state.numbers);
    EXPECT_TRUE(std::signbit(found->numbers[2][1]));
    const auto load = [&] { load_checkpoint(path, key); };
    EXPECT_TRUE(refuses(path, 3, 1, no_number, load));
    EXPECT_TRUE(refuses(path, 3, 1, -1.0, load)) << "a bound";
    EXPECT_TRUE(refuses(path, 5, 39, no_number, load));
    EXPECT_TRUE(refuses(path, 8, 18927, no_number, load)) << "the last number of the last piece";
    for (const std::uint64_t size : {std::uint64_t{0}, std::uint64_t{39}, std::uint64_t{41}, std::uint64_t{1} << 61})
        EXPECT_TRUE(refuses(path, 4, 0, size, load)) << "a first vector of " << size;
    EXPECT_TRUE(refuses<std::uint8_t>(path, 0, 0, 7, load)) << "a name with a bell";
    EXPECT_TRUE(test::file_refused(path, [&] { load_checkpoint(path, other_key); }));
    test::expect_tags_guarded(path, load);
    const Bytes whole = read_file(path);
    for (std::size_t block = 0; block < 9; ++block) {
        test::rewrite(path, [&](auto& file) { file.parts.erase(file.parts.begin() + static_cast<std::ptrdiff_t>(block)); });
        EXPECT_TRUE(test::file_refused(path, load)) << "without block " << block;
        publish_file(path, whole);
    }
    std::filesystem::remove(path);
    EXPECT_FALSE(load_checkpoint(path, key));
    BlockFileWriter(path, FileKind::checkpoint, 99, key).publish();
    EXPECT_FALSE(load_checkpoint(path, key)) << "of another version: begun again";
}

TEST(StageFiles, Plan) {
    const test::TemporaryFolder folder;
    const LevelPlan plan{{{0, 6}, no_levels, {7, 7}, {7, 6}, {21, 20}, {0, 20}, {3, 9}}};
    save_plan(folder / "p", key, plan);
    EXPECT_EQ(load_plan(folder / "p", key, 7), plan);
    const auto load = [&] { load_plan(folder / "p", key, 7); };
    EXPECT_TRUE(refuses<std::uint8_t>(folder / "p", 1, 5, 21, load)) << "a level above the highest";
    EXPECT_TRUE(refuses<std::uint8_t>(folder / "p", 0, 0, 8, load)) << "levels left out";
    EXPECT_TRUE(refuses<std::uint8_t>(folder / "p", 0, 0, 255, load)) << "levels out of order";
    expect_careful(
        folder / "p", [&](const Key& k, std::size_t n) { return load_plan(folder / "p", k, n).has_value(); }, 7);
}

TEST(StageFiles, Accuracy) {
    const test::TemporaryFolder folder;
    const StandardError error{channel_numbers(9, 8), channel_numbers(9, 9), 0.125};
    save_accuracy(folder / "a", key, error);
    const auto found = load_accuracy(folder / "a", key, 9);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->radiosity, error.radiosity);
    EXPECT_EQ(found->irradiance, error.irradiance);
    EXPECT_EQ(found->relative, 0.125);
    expect_finite<double>(folder / "a", {0, 1, 2}, [&] { load_accuracy(folder / "a", key, 9); });
    expect_careful(
        folder / "a", [&](const Key& k, std::size_t n) { return load_accuracy(folder / "a", k, n).has_value(); }, 9);
}

TEST(StageFiles, PageLight) {
    const test::TemporaryFolder folder;
    std::vector<TexelLight> light;
    const auto single = [](double value) { return static_cast<float>(std::ldexp(value, -60)); };  // within its range
    for (const Channels& c : channel_numbers(25, 7))
        light.push_back({{single(c[0]), single(c[1]), single(c[2])}, {single(c[2]), 0, single(c[1])}, single(c[0]), single(c[1]), static_cast<std::uint32_t>(light.size())});
    save_page_light(folder / "l", key, light);
    const auto found = load_page_light(folder / "l", key, 25);
    ASSERT_TRUE(found);
    for (std::size_t k = 0; k < 25; ++k) {
        EXPECT_EQ((*found)[k].direct, light[k].direct);
        EXPECT_EQ((*found)[k].indirect, light[k].indirect);
        EXPECT_EQ((*found)[k].error, light[k].error);
        EXPECT_EQ((*found)[k].rays, light[k].rays);
        EXPECT_EQ((*found)[k].bias, light[k].bias);
    }
    const auto irradiance = load_page_irradiance(folder / "l", key, 25);
    ASSERT_TRUE(irradiance);
    for (std::size_t k = 0; k < 25; ++k) EXPECT_EQ((*irradiance)[k], light[k].irradiance());
    expect_finite<float>(folder / "l", {0, 1}, [&] { load_page_irradiance(folder / "l", key, 25); });
    expect_finite<float>(folder / "l", {0, 1, 2, 4}, [&] { load_page_light(folder / "l", key, 25); });
    expect_careful(
        folder / "l", [&](const Key& k, std::size_t n) { return load_page_light(folder / "l", k, n).has_value(); }, 25);
    save_page_light(folder / "none", key, {});
    EXPECT_EQ(load_page_light(folder / "none", key, 0)->size(), 0u) << "a page without texels";
}

}  // namespace
}  // namespace luxel
