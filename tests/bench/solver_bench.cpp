/// What solvers read until the light is right, on the matrix of a scene: bytes read over bytes of the half matrix, true
/// error, bound.
///
/// usage: solver_bench SCENE [--albedo R ...] [--solver NAME ...] [--cache SHARE] [--chunk-patches N] [--rays N]
///                     [--density T] [--patch-texels K] [--error E] [--work DIR] [--csv FILE] [--repeat N]
///                     [--no-read-ahead]
/// Reflectances keep their contrasts and are moved so that their area-weighted mean is --albedo (0: as the scene has
/// them). The true error is area-weighted, relative L1, of radiosity, the worst channel, against conjugate gradients at
/// a bound of 1e-8. --cache is the share of all decoded blocks that a cache may hold. Seconds are of the whole solve
/// down to a bound of --error, without looks at it from outside; "decode" is the time to decode as many bytes with all
/// threads and nothing else, so that decode / seconds says how much of the store's speed a solver uses.
/// --csv: one line per step: scene, albedo, solver, reads, true error, bound.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>

#include "baker/core/parallel.h"
#include "baker/solver/solve.h"
#include "baker/store/block_cache.h"
#include "baker/store/closed_matrix.h"
#include "tests/support/baked_problem.h"
#include "tests/support/temporary_folder.h"

using namespace luxel;
namespace fs = std::filesystem;

namespace {

struct Settings {
    BakeOptions bake;
    std::vector<double> albedos{0.5, 0.8, 0.95, 0.99};
    std::vector<std::string> solvers{"shoot"};
    double cache = 0, error = 1e-3;
    int repeat = 1;
    bool reads_ahead = true;
    fs::path csv;
};

double seconds_of(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Grey levels of all channels moved towards 0 or 1 until the area-weighted mean is `mean`.
std::vector<Rgb> with_mean(std::vector<Rgb> values, std::span<const double> area_m2, double mean) {
    double sum = 0, area = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        for (int c = 0; c < 3; ++c) sum += area_m2[i] * std::clamp(static_cast<double>(values[i][c]), 0.0, 0.999) / 3;
        area += area_m2[i];
    }
    const double now = sum / area;
    for (Rgb& value : values)
        for (int c = 0; c < 3; ++c) {
            const double v = std::clamp(static_cast<double>(value[c]), 0.0, 0.999);
            value[c] = static_cast<float>(mean == 0    ? v
                                          : mean < now ? v * mean / now
                                                       : 1 - (1 - v) * (1 - mean) / (1 - now));
        }
    return values;
}

struct Problem : test::BakedProblem {
    std::uint64_t decoded_bytes = 0;
};

Problem prepare(const BakeOptions& o) {
    Problem p{test::bake_to_matrix(o)};
    std::uint64_t own = 0;
    for (const BlockInfo& block : p.matrix.strips->blocks()) {
        p.decoded_bytes += BlockCache::resident_bytes(block, p.geometry->layout);
        if (block.a == block.b) own += block.read_bytes;
    }
    ClosedMatrix source(*p.matrix.strips, p.matrix.area_m2, p.matrix.closure);
    fmt::print(
        "{}: {} patches, {} chunks of at most {}, {} blocks, {:.2f} M pairs, {:.1f} MB, own blocks {:.0f} % of it\n",
        o.input.stem().string(), p.report.patches, p.report.chunks, o.chunk_patches, p.report.blocks,
        static_cast<double>(p.report.pairs) * 1e-6, static_cast<double>(source.total_bytes()) * 1e-6,
        100.0 * static_cast<double>(own) / static_cast<double>(source.total_bytes()));
    return p;
}

double error_of(const Problem& p, const std::vector<Rgb>& reflectance, const std::vector<Channels>& irradiance,
                const std::vector<Channels>& exact) {
    double worst = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        double off = 0, sum = 0;
        for (std::size_t i = 0; i < exact.size(); ++i) {
            const double b =
                p.sources.emission[i][c] + static_cast<double>(reflectance[i][static_cast<int>(c)]) * irradiance[i][c];
            off += p.matrix.area_m2[i] * std::abs(b - exact[i][c]);
            sum += p.matrix.area_m2[i] * exact[i][c];
        }
        if (sum > 0) worst = std::max(worst, off / sum);
    }
    return worst;
}

/// Time to decode `bytes` of blocks, over and over, by all threads.
double decode_seconds(const Problem& p, double bytes) {
    ClosedMatrix source(*p.matrix.strips, p.matrix.area_m2, p.matrix.closure);
    const double once = seconds_of([&] {
        parallel_for(source.blocks().size(), 1, [&](std::size_t k) {
            Block block;
            source.load(k, block);
        });
    });
    return once * bytes / static_cast<double>(source.total_bytes());
}

void measure(const Settings& s, const Problem& p, double albedo, std::ofstream& csv) {
    const auto reflectance = with_mean(p.reflectance, p.matrix.area_m2, albedo);
    ClosedMatrix source(*p.matrix.strips, p.matrix.area_m2, p.matrix.closure);
    const SolveInput input{reflectance, p.sources.emission};
    SolveOptions exact_options;
    exact_options.tolerance = 1e-8;
    BlockCache whole(source, p.decoded_bytes * 2);
    const SolveResult exact = solve(SolverKind::cg, whole, input, exact_options);
    for (const std::string& name : s.solvers) {
        double reads = -1, bound = 0, error = 0;
        std::size_t steps = 0;
        SolveOptions options;
        options.tolerance = s.error;
        const auto run = [&] {
            BlockCache cache(source, static_cast<std::uint64_t>(s.cache * static_cast<double>(p.decoded_bytes)),
                             s.reads_ahead);
            return solve(*solver_kind(name), cache, input, options);
        };
        double worst_tightness = 0;
        options.step = [&](const SolveView& view) {
            const double now = error_of(p, reflectance, view.irradiance(false), exact.radiosity);
            const double at = static_cast<double>(view.bytes_read()) / static_cast<double>(source.total_bytes());
            ++steps;
            if (csv)
                csv << fmt::format("{},{},{},{:.6f},{:.6e},{:.6e}\n", s.bake.input.stem().string(), albedo, name, at,
                                   now, view.error_bound());
            if (reads < 0 && now <= s.error) reads = at, bound = view.error_bound(), error = now;
            return true;
        };
        const SolveResult result = run();
        const double last = error_of(p, reflectance, result.irradiance, exact.radiosity);
        worst_tightness = result.error_bound / last;
        options.step = {};
        double seconds = 1e30;
        for (int k = 0; k < s.repeat; ++k) seconds = std::min(seconds, seconds_of(run));
        const double decode = decode_seconds(p, result.reads * static_cast<double>(source.total_bytes()));
        fmt::print(
            "  albedo {:.2f} {:<11} error {:.0e} after {:.2f} reads (bound there {:.1e}, {:.1f} times); bound met "
            "after {:.2f} reads, "
            "{} steps: {:.1e} is {:.1f} times {:.1e}; {:.2f} s, decode / all {:.2f}{}\n",
            albedo, name, s.error, reads, bound, bound / error, result.reads, steps, result.error_bound,
            worst_tightness, last, seconds, decode / seconds, result.converged ? "" : ", NOT CONVERGED");
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("solvers on the matrix of a scene");
    Settings s;
    s.bake.rays = 256;
    fs::path work;
    app.add_option("scene", s.bake.input)->required();
    app.add_option("--albedo", s.albedos);
    app.add_option("--solver", s.solvers);
    app.add_option("--cache", s.cache);
    app.add_option("--error", s.error);
    app.add_option("--repeat", s.repeat);
    app.add_flag("!--no-read-ahead", s.reads_ahead);
    app.add_option("--csv", s.csv);
    app.add_option("--chunk-patches", s.bake.chunk_patches);
    app.add_option("--rays", s.bake.rays);
    app.add_option("--density", s.bake.unwrap.texels_per_metre);
    app.add_option("--patch-texels", s.bake.patch_texels);
    app.add_option("--work", work);
    CLI11_PARSE(app, argc, argv);
    const test::TemporaryFolder folder;
    s.bake.output = folder / "scene.glb";
    s.bake.work = work.empty() ? folder / "work" : work;
    try {
        const Problem problem = prepare(s.bake);
        std::ofstream csv;
        if (s.csv.empty())
            csv.setstate(std::ios::failbit);
        else
            csv.open(s.csv);
        for (const double albedo : s.albedos) measure(s, problem, albedo, csv);
    } catch (const Error& error) {
        fmt::print(stderr, "solver_bench: {}\n", error.what());
        return 1;
    }
    return 0;
}
