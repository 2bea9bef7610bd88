// The light of a scene while it is being solved: how good it is after how much work, and lightmaps of it. For the figures of
// docs/claims.md (tools/scripts/claims.py).
//
// usage: partial_light SCENE --out DIR [--solver NAME ...] [--row-by-row] [--at READS ...] [--error E] [--density T]
//                      [--patch-texels K] [--chunk-patches N] [--rays N] [--interpolation NAME] [--work DIR]
//
// Writes DIR/course.csv, one line per step of each solver:
//   solver, reads, seconds, error, error_ambient, light, light_ambient, bound
//   reads     matrix entries asked for over those of the half matrix; nothing is cached
//   seconds   processor time of the solve, all threads, without looks at it from here
//   error     sum A |H - H*| / sum A H* over patches and channels, H* solved to 1e-9; with the ambient term
//   light     sum A H / sum A H*, the same two ways
//   bound     what the solver says of its own error (of B)
// --row-by-row   every patch is a chunk, so that gathering and shooting read one row of the matrix at a time, as they were first
// --at           lightmaps of the first step at or after so many reads: DIR/SOLVER-READS[-ambient].glb; and DIR/exact.glb
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <ctime>
#include <fstream>

#include "baker/bake/write_stage.h"
#include "baker/core/parallel.h"
#include "baker/formfactors/memory_blocks.h"
#include "baker/solver/solve.h"
#include "tests/support/baked_problem.h"
#include "tests/support/temporary_folder.h"

using namespace luxel;
namespace fs = std::filesystem;

namespace {

/// Of all threads of this process: whoever else uses the machine, it stays the same.
double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Settings {
    BakeOptions bake;
    fs::path out;
    std::vector<std::string> solvers{"gather", "shoot-patch"}, at;
    bool row_by_row = false;
    double error = 1e-3;
};

/// The same matrix in memory, in its own chunks or with every patch as one; read_bytes are 4096 for each entry then.
MemoryBlocks in_memory(const test::BakedProblem& p, bool row_by_row) {
    ClosedMatrix source(*p.matrix.strips, p.matrix.area_m2, p.matrix.closure);
    const ChunkLayout& layout = source.layout();
    std::vector<ExchangePair> pairs;
    Block block;
    for (std::size_t k = 0; k < source.blocks().size(); ++k) {
        source.load(k, block);
        for (std::size_t row = 0; row + 1 < block.row_begin.size(); ++row)
            for (std::size_t e = block.row_begin[row]; e < block.row_begin[row + 1]; ++e)
                pairs.push_back({layout.first_patch[block.a] + static_cast<PatchNumber>(row),
                                 layout.first_patch[block.b] + block.columns[e], block.areas_m2[e]});
    }
    ChunkLayout own = layout;
    if (row_by_row) {
        own.first_patch.clear();
        for (PatchNumber i = 0; i <= layout.patch_count(); ++i) own.first_patch.push_back(i);
    }
    return {own, p.matrix.area_m2, p.matrix.closure.diagonal_m2, std::move(pairs)};
}

struct Figures {
    double error = 0, light = 0;
};

Figures compare(const test::BakedProblem& p, std::span<const Channels> found, std::span<const Channels> exact) {
    double off = 0, sum = 0, all = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            off += p.matrix.area_m2[i] * std::abs(found[i][c] - exact[i][c]);
            sum += p.matrix.area_m2[i] * found[i][c];
            all += p.matrix.area_m2[i] * exact[i][c];
        }
    return {off / all, sum / all};
}

void write_maps(const Settings& s, const test::BakedProblem& p, std::span<const Channels> irradiance, const std::string& name) {
    BakeOptions options = s.bake;
    options.output = s.out / (name + ".glb");
    BakedLight light;
    light.patch_irradiance = add_lamps(irradiance, p.sources.lamp_irradiance);
    light.state = "preview";
    write_lightmaps(options, *p.geometry, light, {}, {});
}

/// Solves and notes the course; the lightmaps that --at asks for come on the way.
void follow(const Settings& s, const test::BakedProblem& p, MemoryBlocks& source, const std::string& solver,
            std::span<const Channels> exact, std::ofstream& csv) {
    const auto total = static_cast<double>(source.total_bytes());
    const std::uint64_t before = source.bytes_read();
    std::size_t next = 0;
    double seconds = 0;
    double begin = processor_seconds();
    SolveOptions options;
    options.tolerance = s.error;
    options.max_reads = 1'000'000;
    options.step = [&](const SolveView& view) {
        seconds += processor_seconds() - begin;
        const double reads = static_cast<double>(source.bytes_read() - before) / total;
        const auto plain = view.irradiance(false), ambient = view.irradiance(true);
        const Figures a = compare(p, plain, exact), b = compare(p, ambient, exact);
        csv << fmt::format("{},{:.6f},{:.6f},{:.6e},{:.6e},{:.6e},{:.6e},{:.6e}\n", solver, reads, seconds, a.error, b.error,
                           a.light, b.light, view.error_bound());
        for (; next < s.at.size() && reads >= std::stod(s.at[next]); ++next) {
            write_maps(s, p, plain, solver + "-" + s.at[next]);
            write_maps(s, p, ambient, solver + "-" + s.at[next] + "-ambient");
            flush_denormals();  // whatever the libraries did to this thread
        }
        begin = processor_seconds();
        return true;
    };
    const SolveResult result = solve(*solver_kind(solver), source, {p.reflectance, p.sources.emission}, options);
    fmt::print("{}: {} steps, {:.3f} reads, {:.3f} s, bound {:.1e}{}\n", solver, result.history.size(), result.reads, seconds,
               result.error_bound, result.converged ? "" : ", NOT CONVERGED");
}

void run(const Settings& s) {
    const test::BakedProblem problem = test::bake_to_matrix(s.bake);
    fs::create_directories(s.out);
    MemoryBlocks source = in_memory(problem, s.row_by_row);
    MemoryBlocks whole = in_memory(problem, false);
    SolveOptions options;
    options.tolerance = 1e-9;
    const SolveResult exact = solve(SolverKind::cg, whole, {problem.reflectance, problem.sources.emission}, options);
    fmt::print("{}: {} patches, {} chunks, {} pairs\n", s.bake.input.stem().string(), problem.report.patches,
               source.layout().chunk_count(), problem.report.pairs);
    if (!s.at.empty()) write_maps(s, problem, exact.irradiance, "exact");
    std::ofstream csv(s.out / "course.csv");
    csv << "solver,reads,seconds,error,error_ambient,light,light_ambient,bound\n";
    for (const std::string& solver : s.solvers) follow(s, problem, source, solver, exact.irradiance, csv);
    if (!csv.flush()) throw Error(ErrorCode::cannot_write, (s.out / "course.csv").string(), "cannot be written", "check the disk");
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("the light of a scene while it is being solved");
    Settings s;
    s.bake.rays = 1024;
    std::string interpolation = "linear";
    fs::path work;
    app.add_option("scene", s.bake.input)->required();
    app.add_option("--out", s.out)->required();
    app.add_option("--solver", s.solvers)
        ->check(CLI::IsMember(std::vector<std::string>(solver_names().begin(), solver_names().end())));
    app.add_flag("--row-by-row", s.row_by_row);
    app.add_option("--at", s.at)->check(CLI::NonNegativeNumber);
    app.add_option("--error", s.error)->check(CLI::Range(1e-9, 1.0));
    app.add_option("--density", s.bake.unwrap.texels_per_metre);
    app.add_option("--patch-texels", s.bake.patch_texels);
    app.add_option("--chunk-patches", s.bake.chunk_patches);
    app.add_option("--rays", s.bake.rays);
    app.add_option("--interpolation", interpolation);
    app.add_option("--work", work);
    CLI11_PARSE(app, argc, argv);
    const auto spread = interpolation_of(interpolation);
    const test::TemporaryFolder folder;
    s.bake.output = folder / "scene.glb";
    s.bake.work = work.empty() ? folder / "work" : work;
    try {
        if (!spread) throw Error(ErrorCode::usage, "--interpolation", "unknown: " + interpolation, "see luxel bake --help");
        s.bake.interpolation = *spread;
        run(s);
    } catch (const Error& error) {
        fmt::print(stderr, "partial_light: {}\n", error.what());
        return 1;
    }
    return 0;
}
