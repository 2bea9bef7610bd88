// The hemicube and rays against exact form factors, on surfaces with nothing in between.
//
// usage: estimator_bench [--most-resolution N]
//
// Two surfaces, each cut into patches; every form factor from a patch of one to a patch of the other is compared with the
// closed form. Errors are root of sum (found - exact)^2 over root of sum exact^2, over all pairs of patches.
//   alias      hemicube against the exact form factor of its point: the error of the pixels alone
//   hemicube   against the exact form factor of the patches: alias, and one point in place of a whole patch
//   rays       as many rays as 2^k * 4 not above the hemicube's 3 N^2, against the same
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <stdexcept>

#include "baker/core/parallel.h"
#include "baker/formfactors/exact_form_factor.h"
#include "baker/formfactors/hemicube_estimator.h"
#include "baker/formfactors/hemicube_weights.h"
#include "baker/formfactors/ray_estimator.h"
#include "baker/patches/patch_sampler.h"
#include "tests/support/scenes.h"

namespace luxel::bench {
namespace {

struct Configuration {
    const char* name;
    test::MadeMesh from, to;
};

std::vector<Configuration> configurations() {
    using test::quad;
    const test::MadeMesh floor = quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0});
    return {{"facing squares, distance 1", floor, quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1})},
            {"facing squares, distance 1/8", floor, quad({0, 0.125f, 0}, {1, 0, 0}, {0, 0, 1})},
            {"facing squares, distance 8", floor, quad({0, 8, 0}, {1, 0, 0}, {0, 0, 1})},
            {"right angle, common edge", floor, quad({0, 0, 0}, {0, 1, 0}, {0, 0, 1})},
            {"tilted, apart", floor, quad({1.3f, 0.2f, 0.1f}, {0, 0, 1}, {-0.6f, 0.8f, 0})}};
}

/// The patch as a polygon, counter-clockwise from its front.
std::vector<Vec3d> polygon_of(const test::Prepared& made, PatchNumber patch) {
    const PatchSampler sampler(made.scene, made.atlas, made.patches, patch);
    const Parallelogram* flat = sampler.flat();
    if (!flat) throw std::runtime_error("a patch is not a parallelogram");
    const Vec3d at = to_double(flat->origin), u = to_double(flat->side_u), v = to_double(flat->side_v);
    if (u.cross(v).dot(to_double(flat->normal)) > 0) return {at, at + u, at + u + v, at + v};
    return {at, at + v, at + u + v, at + u};
}

using Row = std::map<PatchNumber, double>;

Row row_of(const Estimator& estimator, PatchNumber patch, LevelRange levels) {
    std::vector<Landings> out;
    estimator.cast(patch, levels, out);
    const double unit = 1 / static_cast<double>(ray_count(levels) * out.size());
    Row row;
    for (const Landings& landings : out)
        for (std::size_t k = 0; k < landings.patches.size(); ++k)
            row[landings.patches[k]] += unit * (landings.weights.empty() ? 1 : landings.weights[k]);
    return row;
}

struct Sides {
    std::vector<PatchNumber> from, to;
};

/// Root of sum of squares of found - exact over that of exact, over all pairs.
template <class Exact>
double relative_error(const Sides& sides, const std::map<PatchNumber, Row>& found, const Exact& exact) {
    double error = 0, size = 0;
    for (const PatchNumber i : sides.from)
        for (const PatchNumber j : sides.to) {
            const auto at = found.at(i).find(j);
            const double f = exact(i, j), difference = (at == found.at(i).end() ? 0 : at->second) - f;
            error += difference * difference;
            size += f * f;
        }
    return std::sqrt(error / size);
}

std::map<PatchNumber, Row> rows_of(const Sides& sides, const Estimator& estimator, LevelRange levels) {
    std::vector<Row> rows(sides.from.size());
    parallel_for(rows.size(), 1, [&](std::size_t k) { rows[k] = row_of(estimator, sides.from[k], levels); });
    std::map<PatchNumber, Row> all;
    for (std::size_t k = 0; k < rows.size(); ++k) all[sides.from[k]] = std::move(rows[k]);
    return all;
}

void bench_configuration(const Configuration& c, std::uint32_t most_resolution) {
    const auto made = test::prepare(test::SceneMaker().add("from", c.from).add("to", c.to).build(), {.texels_per_metre = 16});
    Sides sides;
    for (PatchNumber p = 0; p < made->patches.count(); ++p)
        (made->path_of(p) == "from" ? sides.from : sides.to).push_back(p);
    std::map<std::pair<PatchNumber, PatchNumber>, double> exact, of_point;
    double whole = 0, area = 0;
    for (const PatchNumber i : sides.from) {
        const auto polygon = polygon_of(*made, i);
        const HemicubePlace place = hemicube_place(made->scene, made->atlas, made->patches, i);
        area += polygon_area(polygon);
        for (const PatchNumber j : sides.to) {
            const auto target = polygon_of(*made, j);
            exact[{i, j}] = exact_form_factor(polygon, target);
            of_point[{i, j}] = exact_point_form_factor(to_double(place.position), to_double(place.normal), target);
            whole += polygon_area(polygon) * exact[{i, j}];
        }
    }
    fmt::print("{}: {} x {} patches, F = {:.5f}\n", c.name, sides.from.size(), sides.to.size(), whole / area);
    fmt::print("  {:>6} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "N", "pixels", "alias", "hemicube", "rays", "error");
    const auto rays = make_ray_estimator(made->scene, made->atlas, made->patches, *made->tracer, {});
    for (std::uint32_t resolution = 16; resolution <= most_resolution; resolution *= 2) {
        const auto hemicube = make_hemicube_estimator(made->scene, made->atlas, made->patches, *made->tracer, {0, resolution});
        const auto found = rows_of(sides, *hemicube, {0, hemicube_level});
        const std::uint64_t pixels = std::uint64_t{3} * resolution * resolution;
        std::uint8_t level = 0;
        while ((std::uint64_t{rays->replicate_count()} << (level + 1)) <= pixels) ++level;
        const auto by_rays = rows_of(sides, *rays, {0, level});
        const auto pair = [](const auto& table) { return [&table](PatchNumber i, PatchNumber j) { return table.at({i, j}); }; };
        fmt::print("  {:>6} {:>10} {:>9.3f}% {:>9.3f}% {:>10} {:>9.3f}%\n", resolution, pixels,
                   100 * relative_error(sides, found, pair(of_point)), 100 * relative_error(sides, found, pair(exact)),
                   rays->rays_of({0, level}), 100 * relative_error(sides, by_rays, pair(exact)));
        std::fflush(stdout);
    }
}

int run(int count, char** words) {
    std::uint32_t most_resolution = 1024;
    for (int k = 1; k < count; ++k) {
        const std::string word = words[k];
        if (word == "--most-resolution" && k + 1 < count) most_resolution = static_cast<std::uint32_t>(std::stoul(words[++k]));
        else throw std::runtime_error("unknown option " + word);
    }
    const ThreadLimit threads(2);
    for (const Configuration& c : configurations()) bench_configuration(c, most_resolution);
    return 0;
}

}  // namespace
}  // namespace luxel::bench

int main(int count, char** words) {
    try {
        return luxel::bench::run(count, words);
    } catch (const std::exception& error) {
        fmt::print(stderr, "estimator_bench: {}\n", error.what());
        return 1;
    }
}
