// The same solve with sums in double and in single precision, on the matrix of a closed grey room, whose light is known: for the
// table and curves of docs/extremes.md (tools/scripts/stability.py).
//
// usage: accumulation SCENE [--density T] [--patch-texels K] [--rays N] [--tolerance E]
//
// Conjugate gradients on (A - s G s) y = s G M, s = sqrt(rho), H = G (M + s y) / A, with the diagonal A as preconditioner. All numbers
// and sums are of one precision; nothing is scaled before. Expected: what is emitted is absorbed, mean H = sum A M / sum A (1 - rho).
// Prints one line of JSON: patches, expected, and for "double" and "single" the mean H, iterations and seconds (mean null: not finite).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>

#include "tests/support/baked_problem.h"
#include "tests/support/temporary_folder.h"

using namespace luxel;

namespace {

constexpr int most_iterations = 1000;

/// One channel of the problem with all its numbers in one precision.
template <class Real>
struct System {
    std::vector<Real> area, diagonal, root, emission;   ///< m2, m2, sqrt(rho), lm/m2
    struct Pair {
        PatchNumber i, j;
        Real area;
    };
    std::vector<Pair> pairs;
};

template <class Real>
System<Real> system_of(const test::BakedProblem& p) {
    System<Real> s;
    ClosedMatrix source(*p.matrix.strips, p.matrix.area_m2, p.matrix.closure);
    for (std::size_t i = 0; i < p.reflectance.size(); ++i) {
        s.area.push_back(static_cast<Real>(source.area_m2()[i]));
        s.diagonal.push_back(static_cast<Real>(source.diagonal_m2()[i]));
        s.root.push_back(static_cast<Real>(std::sqrt(static_cast<double>(p.reflectance[i].x))));
        s.emission.push_back(static_cast<Real>(p.sources.emission[i][0]));
    }
    const ChunkLayout& layout = source.layout();
    Block block;
    for (std::size_t k = 0; k < source.blocks().size(); ++k) {
        source.load(k, block);
        for (std::size_t row = 0; row + 1 < block.row_begin.size(); ++row)
            for (std::size_t e = block.row_begin[row]; e < block.row_begin[row + 1]; ++e)
                s.pairs.push_back({layout.first_patch[block.a] + static_cast<PatchNumber>(row), layout.first_patch[block.b] + block.columns[e],
                                   static_cast<Real>(block.areas_m2[e])});
    }
    return s;
}

template <class Real>
std::vector<Real> received_from(const System<Real>& s, const std::vector<Real>& x) {
    std::vector<Real> y(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) y[i] = s.diagonal[i] * x[i];
    for (const auto& pair : s.pairs) {
        y[pair.i] += pair.area * x[pair.j];
        y[pair.j] += pair.area * x[pair.i];
    }
    return y;
}

template <class Real>
Real dot(const std::vector<Real>& a, const std::vector<Real>& b) {
    Real sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

struct Solved {
    double mean = 0;
    int iterations = 0;
};

/// (A - s G s) x.
template <class Real>
std::vector<Real> multiplied(const System<Real>& s, const std::vector<Real>& x) {
    std::vector<Real> scaled(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) scaled[i] = s.root[i] * x[i];
    std::vector<Real> y = received_from(s, scaled);
    for (std::size_t i = 0; i < x.size(); ++i) y[i] = s.area[i] * x[i] - s.root[i] * y[i];
    return y;
}

template <class Real>
Solved solve_in(const System<Real>& s, double tolerance) {
    const std::size_t count = s.area.size();
    std::vector<Real> r = received_from(s, s.emission), y(count, Real(0)), z(count);
    for (std::size_t i = 0; i < count; ++i) r[i] *= s.root[i], z[i] = r[i] / s.area[i];
    std::vector<Real> direction = z;
    Real rz = dot(r, z);
    const Real first = rz;
    Solved result;
    while (rz > first * static_cast<Real>(tolerance * tolerance) && result.iterations < most_iterations) {
        const std::vector<Real> moved = multiplied(s, direction);
        const Real curvature = dot(direction, moved);
        if (!(curvature > 0)) break;   // rounding has made the matrix singular
        const Real step = rz / curvature;
        for (std::size_t i = 0; i < count; ++i) y[i] += step * direction[i], r[i] -= step * moved[i], z[i] = r[i] / s.area[i];
        const Real next = dot(r, z), share = next / rz;
        for (std::size_t i = 0; i < count; ++i) direction[i] = z[i] + share * direction[i];
        rz = next;
        ++result.iterations;
    }
    for (std::size_t i = 0; i < count; ++i) y[i] = s.emission[i] + s.root[i] * y[i];
    const std::vector<Real> received = received_from(s, y);
    Real light = 0, area = 0;
    for (std::size_t i = 0; i < count; ++i) light += received[i], area += s.area[i];
    result.mean = static_cast<double>(light / area);
    return result;
}

template <class Real>
std::string measure(const test::BakedProblem& p, double tolerance) {
    const System<Real> system = system_of<Real>(p);
    const auto begin = std::chrono::steady_clock::now();
    const Solved solved = solve_in(system, tolerance);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    return fmt::format(R"({{"mean": {}, "iterations": {}, "seconds": {:.6f}}})",
                       std::isfinite(solved.mean) ? fmt::format("{:.17g}", solved.mean) : "null", solved.iterations, seconds.count());
}

void run(const BakeOptions& options, double tolerance) {
    const test::BakedProblem p = test::bake_to_matrix(options);
    double emitted = 0, absorbing = 0;
    for (std::size_t i = 0; i < p.reflectance.size(); ++i) {
        emitted += p.matrix.area_m2[i] * p.sources.emission[i][0];
        absorbing += p.matrix.area_m2[i] * (1 - static_cast<double>(p.reflectance[i].x));
    }
    fmt::print("{{\"patches\": {}, \"expected\": {:.17g}, \"double\": {}, \"single\": {}}}\n", p.reflectance.size(), emitted / absorbing,
               measure<double>(p, tolerance), measure<float>(p, tolerance));
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("the same solve in double and in single precision");
    BakeOptions options;
    double tolerance = 1e-10;
    app.add_option("scene", options.input)->required();
    app.add_option("--density", options.unwrap.texels_per_metre);
    app.add_option("--patch-texels", options.patch_texels);
    app.add_option("--rays", options.rays);
    app.add_option("--tolerance", tolerance);
    CLI11_PARSE(app, argc, argv);
    const test::TemporaryFolder folder;
    options.output = folder / "scene.glb";
    options.work = folder / "work";
    try {
        run(options, tolerance);
    } catch (const Error& error) {
        fmt::print(stderr, "accumulation: {}\n", error.what());
        return 1;
    }
    return 0;
}
