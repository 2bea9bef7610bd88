// Which sample sequence finds form factors with the fewest rays.
//
// usage: sequence_bench [--patches N] [--seeds N] [--texels-per-metre X] [SCENE ...]
//
// On a scene's own geometry, for N patches spread over it and every sequence, at several numbers of rays:
//   light   error of the light that a patch gathers, sum_j F_ij B_j, relative to the mean of it
//   rows    error of the row of form factors, root of sum_j (F_ij - true)^2, relative to the same root of the true rows
// Both are root mean squares over patches and seeds. The rays of a patch are split over 4 replicates, as the estimator does;
// "one" is the same number of rays as one sequence. True values come from 2^18 rays of another seed and sequence; B from a few
// bounces over a thin set of rows. The last lines say how many independent rays one ray of each sequence is worth for
// light.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <stdexcept>

#include "baker/bake/geometry_stages.h"
#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/trace/surface_map.h"
#include "baker/patches/patch_sampler.h"
#include "baker/core/ray_offset.h"
#include "tests/bench/sequences.h"
#include "tests/support/temporary_folder.h"

namespace luxel::bench {
namespace {

constexpr std::uint32_t replicates = 4, reference_rays = 1u << 18;

using Row = std::map<PatchNumber, double>;

/// Adds a share of 1 / rays for every ray of one sequence.
void cast(const BakedGeometry& g, const PatchSampler& sampler, const Sequence& sequence, std::uint64_t seed, std::uint32_t rays,
          double share, std::vector<double>& row, std::vector<PatchNumber>& met) {
    constexpr std::size_t batch = 64;
    std::array<TraceRay, batch> queries;
    std::array<TraceHit, batch> hits;
    for (std::uint32_t begin = 0; begin < rays; begin += batch) {
        const std::size_t count = std::min<std::size_t>(batch, rays - begin);
        for (std::size_t k = 0; k < count; ++k) {
            const Point4 u = sequence.point(seed, begin + static_cast<std::uint32_t>(k));
            const SurfacePoint at = sampler.point(u[0], u[1]);
            queries[k] = {offset_origin(at.position, at.normal, g.scene.corner_extent(at.triangle)),
                          Frame(at.normal).to_world(cosine_direction(u[2], u[3])), at.triangle};
        }
        g.tracer->first_hits({queries.data(), count}, {hits.data(), count});
        for (std::size_t k = 0; k < count; ++k) {
            const Landing at = landing(g.scene, g.atlas, g.patches, hits[k]);
            if (at.end != RayEnd::patch) continue;
            if (row[at.patch] == 0) met.push_back(at.patch);
            row[at.patch] += share;
        }
    }
}

/// A row of form factors from `split` sequences of rays / split each. Seeds are those of (patch, seed).
Row find_row(const BakedGeometry& g, const Sequence& sequence, PatchNumber patch, std::uint64_t seed, std::uint32_t rays,
             std::uint32_t split) {
    const PatchSampler sampler(g.scene, g.atlas, g.patches, patch);
    thread_local std::vector<double> row;
    std::vector<PatchNumber> met;
    row.assign(g.patches.count(), 0);
    for (std::uint32_t part = 0; part < split; ++part)
        cast(g, sampler, sequence, mix(mix(g.patches.patches[patch].id, seed), part), rays / split, 1.0 / rays, row, met);
    Row found;
    for (const PatchNumber p : met) found[p] = row[p];
    return found;
}

double gathered(const Row& row, const std::vector<double>& radiosity) {
    double sum = 0;
    for (const auto& [patch, share] : row) sum += share * radiosity[patch];
    return sum;
}

/// Luminance of every patch after some bounces over rows of 256 rays: light as it is distributed in the scene.
std::vector<double> radiosity_of(const BakedGeometry& g, const Sequence& sequence) {
    const std::size_t count = g.patches.count();
    std::vector<Row> rows(count);
    parallel_for(count, 16, [&](std::size_t p) { rows[p] = find_row(g, sequence, static_cast<PatchNumber>(p), 1000, 256, 1); });
    std::vector<double> emission, light;
    for (const Patch& patch : g.patches.patches) emission.push_back(static_cast<double>(luminance(patch.emission)));
    light = emission;
    for (int bounce = 0; bounce < 30; ++bounce) {
        std::vector<double> next = emission;
        for (std::size_t p = 0; p < count; ++p)
            next[p] += static_cast<double>(luminance(g.patches.patches[p].reflectance)) * gathered(rows[p], light);
        light = std::move(next);
    }
    return light;
}

struct Errors {
    double light = 0, rows = 0;
};

/// What is compared with: patches, their true rows, light.
struct Truth {
    std::vector<PatchNumber> patches;
    std::vector<Row> rows;
    std::vector<double> radiosity;
    double mean_light = 0, mean_square_row = 0;
};

Truth find_truth(const BakedGeometry& g, std::size_t patch_count) {
    const auto all = sequences();
    Truth truth;
    truth.radiosity = radiosity_of(g, all.front());
    const std::size_t count = std::min(patch_count, g.patches.count());
    for (std::size_t k = 0; k < count; ++k)
        truth.patches.push_back(static_cast<PatchNumber>(k * g.patches.count() / count));
    truth.rows.resize(count);
    parallel_for(count, 1, [&](std::size_t k) { truth.rows[k] = find_row(g, all.front(), truth.patches[k], 999, reference_rays, 1); });
    for (const Row& row : truth.rows) {
        truth.mean_light += gathered(row, truth.radiosity) / static_cast<double>(count);
        for (const auto& [patch, share] : row) truth.mean_square_row += share * share / static_cast<double>(count);
    }
    return truth;
}

Errors measure(const BakedGeometry& g, const Truth& truth, const Sequence& sequence, std::uint32_t rays, std::uint32_t split,
               std::uint64_t seeds) {
    std::vector<Errors> each(truth.patches.size());
    parallel_for(each.size(), 1, [&](std::size_t k) {
        const double light = gathered(truth.rows[k], truth.radiosity);
        for (std::uint64_t seed = 0; seed < seeds; ++seed) {
            const Row row = find_row(g, sequence, truth.patches[k], seed, rays, split);
            const double difference = gathered(row, truth.radiosity) - light;
            each[k].light += difference * difference;
            for (const auto& [patch, share] : row) {
                const auto at = truth.rows[k].find(patch);
                const double known = at == truth.rows[k].end() ? 0 : at->second;
                // Of patches that were not met the whole square counts; it is added below for all and taken back here.
                each[k].rows += (share - known) * (share - known) - known * known;
            }
            for (const auto& [patch, known] : truth.rows[k]) each[k].rows += known * known;
        }
    });
    Errors sum;
    for (const Errors& e : each) sum.light += e.light, sum.rows += e.rows;
    const double count = static_cast<double>(each.size()) * static_cast<double>(seeds);
    return {std::sqrt(sum.light / count) / truth.mean_light, std::sqrt(sum.rows / count / truth.mean_square_row)};
}

void bench_scene(const std::filesystem::path& scene, BakeOptions options, std::size_t patches, std::uint64_t seeds) {
    const test::TemporaryFolder place;
    options.input = scene;
    options.output = place / "none.glb";
    BakeReport report;
    StageClock clock(options, report);
    const BakeFolder folder(place / "work", options.output);
    const auto g = prepare_geometry(options, folder, clock, report);
    const Truth truth = find_truth(*g, patches);
    fmt::print("{}: {} patches, {} of them measured, {} seeds\n", scene.filename().string(), g->patches.count(),
               truth.patches.size(), seeds);
    constexpr std::array<std::uint32_t, 4> counts{64, 256, 1024, 4096};
    fmt::print("  {:<22}{:>32}  {:>32}  {:>10}\n", "rays", "light 64 / 256 / 1024 / 4096", "rows 64 / 256 / 1024 / 4096", "one 1024");
    std::map<std::string, std::array<Errors, 4>> found;
    for (const Sequence& sequence : sequences()) {
        auto& errors = found[sequence.name];
        for (std::size_t k = 0; k < counts.size(); ++k) errors[k] = measure(*g, truth, sequence, counts[k], replicates, seeds);
        const Errors one = measure(*g, truth, sequence, 1024, 1, seeds);
        fmt::print("  {:<22}", sequence.name);
        for (const Errors& e : errors) fmt::print("{:8.4f}", e.light);
        fmt::print("  ");
        for (const Errors& e : errors) fmt::print("{:8.4f}", e.rows);
        fmt::print("  {:10.4f}\n", one.light);
        std::fflush(stdout);
    }
    fmt::print("  worth in independent rays (light)\n");
    for (const Sequence& sequence : sequences()) {
        fmt::print("  {:<22}", sequence.name);
        for (std::size_t k = 0; k < counts.size(); ++k) {
            const double ratio = found["independent"][k].light / found[sequence.name][k].light;
            fmt::print("{:8.2f}", ratio * ratio);
        }
        fmt::print("\n");
    }
}

int run(int count, char** words) {
    BakeOptions options;
    options.threads = 2;
    std::size_t patches = 200;
    std::uint64_t seeds = 8;
    std::vector<std::filesystem::path> scenes;
    for (int k = 1; k < count; ++k) {
        const std::string word = words[k];
        const auto value = [&] {
            if (k + 1 >= count) throw std::runtime_error(word + " needs a value");
            return std::string(words[++k]);
        };
        if (word == "--patches") patches = std::stoull(value());
        else if (word == "--seeds") seeds = std::stoull(value());
        else if (word == "--texels-per-metre") options.unwrap.texels_per_metre = std::stod(value());
        else scenes.emplace_back(word);
    }
    const std::filesystem::path samples = std::filesystem::path(LUXEL_BENCH_SOURCE_DIR) / "samples";
    if (scenes.empty()) scenes = {samples / "cornell_box/cornell_box.gltf", samples / "two_rooms/two_rooms.gltf"};
    const ThreadLimit threads(options.threads);
    for (const auto& scene : scenes) bench_scene(scene, options, patches, seeds);
    return 0;
}

}  // namespace
}  // namespace luxel::bench

int main(int count, char** words) {
    try {
        return luxel::bench::run(count, words);
    } catch (const std::exception& error) {
        fmt::print(stderr, "sequence_bench: {}\n", error.what());
        return 1;
    }
}
