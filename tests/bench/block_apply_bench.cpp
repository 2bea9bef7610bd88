/// Pairs per second of the inner loops: one block of 4096 x 4096 patches at two densities.
#include <benchmark/benchmark.h>

#include <random>

#include "baker/formfactors/block_apply.h"
#include "baker/formfactors/closure.h"

namespace luxel {
namespace {

constexpr std::size_t patches = 4096;

Block make_block(double density, bool diagonal) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    Block block;
    block.row_begin.push_back(0);
    for (std::size_t r = 0; r < patches; ++r) {
        for (std::size_t c = diagonal ? r + 1 : 0; c < patches; ++c)
            if (uniform(random) < density) {
                block.columns.push_back(static_cast<std::uint16_t>(c));
                block.areas_m2.push_back(static_cast<float>(uniform(random)));
            }
        block.row_begin.push_back(static_cast<std::uint32_t>(block.columns.size()));
    }
    return block;
}

void report(benchmark::State& state, const Block& block) {
    state.counters["pairs/s"] =
        benchmark::Counter(static_cast<double>(block.columns.size()) * static_cast<double>(state.iterations()),
                           benchmark::Counter::kIsRate);
}

double density(const benchmark::State& state) { return static_cast<double>(state.range(0)) / 1000; }

void gather(benchmark::State& state) {
    const Block block = make_block(density(state), false);
    std::vector<Lanes> x(patches), y(patches);
    for (auto _ : state) gather_rows(block, x, y);
    report(state, block);
}

void scatter(benchmark::State& state) {
    const Block block = make_block(density(state), false);
    std::vector<Lanes> x(patches), y(patches);
    for (auto _ : state) scatter_columns(block, x, y);
    report(state, block);
}

void both(benchmark::State& state) {
    const Block block = make_block(density(state), false);
    std::vector<Lanes> x_a(patches), x_b(patches), y_a(patches), y_b(patches);
    for (auto _ : state) apply_both(block, x_a, x_b, y_a, y_b);
    report(state, block);
}

void diagonal(benchmark::State& state) {
    const Block block = make_block(density(state), true);
    std::vector<Lanes> x(patches), y(patches);
    for (auto _ : state) apply_diagonal(block, 0, patches, x, y);
    report(state, block);
}

void close_counts(benchmark::State& state) {
    const Block block = make_block(density(state), false);
    const std::vector<double> mu(patches, 1000.0);
    double sum = 0;
    for (auto _ : state)
        for (std::size_t r = 0; r < patches; ++r)
            for (std::size_t k = block.row_begin[r]; k < block.row_begin[r + 1]; ++k)
                sum += static_cast<double>(exchange_area(3, mu[r], mu[block.columns[k]]));
    benchmark::DoNotOptimize(sum);
    report(state, block);
}

BENCHMARK(gather)->Arg(20)->Arg(200);
BENCHMARK(scatter)->Arg(20)->Arg(200);
BENCHMARK(both)->Arg(20)->Arg(200);
BENCHMARK(diagonal)->Arg(20)->Arg(200);
BENCHMARK(close_counts)->Arg(20)->Arg(200);

}  // namespace
}  // namespace luxel
