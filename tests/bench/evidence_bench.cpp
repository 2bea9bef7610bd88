// How much of Embree's speed the evidence stage keeps, and what pooling and closure cost.
//
// usage: evidence_bench [--rays N] [--threads N] [--repeat N] [--texels-per-metre X] [SCENE ...]
//
// For each scene, alternately and the best of `repeat` times each:
//   stage    the evidence stage as a bake runs it: choose rays, trace, find patches, count, compress, write
//   tracer   the same rays, ready in memory, through Tracer::first_hits alone
//   bare     the same rays through Embree alone
// Rates are rays per second of wall time; the ratio per second of processor time is printed as well, since it is the one
// that a busy machine disturbs less.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>

#include "baker/bake/matrix_stages.h"
#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/formfactors/evidence.h"
#include "baker/patches/patch_sampler.h"
#include "baker/core/ray_offset.h"
#include "tests/bench/bare_embree.h"
#include "tests/support/temporary_folder.h"

namespace luxel::bench {
namespace {

struct Times {
    double wall_s = 0, processor_s = 0;
};

Times now() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now().time_since_epoch();
    return {wall.count(), seconds(usage.ru_utime) + seconds(usage.ru_stime)};
}

Times since(const Times& start) {
    const Times end = now();
    return {end.wall_s - start.wall_s, end.processor_s - start.processor_s};
}

void keep_best(Times& best, const Times& found) {
    best.wall_s = best.wall_s == 0 ? found.wall_s : std::min(best.wall_s, found.wall_s);
    best.processor_s = best.processor_s == 0 ? found.processor_s : std::min(best.processor_s, found.processor_s);
}

struct StageTimes {
    Times evidence, pooling, closure;
    std::uint64_t rays = 0, pairs = 0, bytes = 0;
};

/// The stages exactly as bake() runs them, in a fresh bake folder.
StageTimes run_stages(BakeOptions options, const BakedGeometry& geometry) {
    const test::TemporaryFolder place;
    const BakeFolder folder(place / "work", place / "none.glb");
    StageTimes times;
    std::string running;
    Times started;
    const auto finish = [&] {
        if (running == "evidence") times.evidence = since(started);
        if (running == "pooling") times.pooling = since(started);
        if (running == "closure") times.closure = since(started);
    };
    options.progress = [&](const std::string& stage, std::uint64_t, std::uint64_t, const char*) {
        if (stage == running) return;
        finish();
        running = stage;
        started = now();
    };
    BakeReport report;
    StageClock clock(options, report);
    const MemoryPlan plan{0, std::uint64_t{512} << 20, std::uint64_t{512} << 20};
    EvidenceRounds evidence(options, geometry, folder);
    evidence.add(uniform_plan(geometry.patches.count(), options.replicates, options.rays), clock, report);
    build_matrix(options, geometry, evidence, folder, plan, clock, report);
    finish();
    times.rays = report.evidence_rays, times.pairs = report.pairs, times.bytes = report.store_bytes;
    return times;
}

/// The rays that the ray estimator casts from one patch, in its order.
void append_rays(const BakeOptions& options, const BakedGeometry& g, PatchNumber patch, std::uint64_t rays,
                 std::vector<TraceRay>& out) {
    const PatchSampler sampler(g.scene, g.atlas, g.patches, patch);
    for (std::uint32_t replicate = 0; replicate < options.replicates; ++replicate) {
        const SobolSequence sequence(mix(mix(g.patches.patches[patch].id, options.seed), replicate));
        for (std::uint32_t k = 0; k < rays / options.replicates; ++k) {
            const auto u = sequence.point(k);
            const SurfacePoint start = sampler.point(u[0], u[1]);
            out.push_back({offset_origin(start.position, start.normal, g.scene.corner_extent(start.triangle)),
                           Frame(start.normal).to_world(cosine_direction(u[2], u[3])), start.triangle});
        }
    }
}

constexpr std::size_t portion_rays = std::size_t{1} << 21;  // in memory at once: 56 MB
constexpr std::size_t task_patches = 16;

struct Loops {
    Times tracer, bare;
    std::uint64_t rays = 0, checksum = 0;
};

/// Both bare loops over all rays, portion by portion.
Loops run_loops(const BakeOptions& options, const BakedGeometry& g, const BareEmbree& embree, std::uint64_t rays) {
    Loops loops;
    const std::size_t portion = std::max<std::size_t>(1, portion_rays / rays / task_patches) * task_patches;
    for (std::size_t first = 0; first < g.patches.count(); first += portion) {
        const std::size_t end = std::min(g.patches.count(), first + portion);
        const std::size_t tasks = (end - first + task_patches - 1) / task_patches;
        std::vector<std::vector<TraceRay>> batches(tasks);
        parallel_for(tasks, 1, [&](std::size_t task) {
            const std::size_t begin = first + task * task_patches;
            for (std::size_t p = begin; p < std::min(end, begin + task_patches); ++p)
                append_rays(options, g, static_cast<PatchNumber>(p), rays, batches[task]);
        });
        std::atomic<std::uint64_t> sum{0};
        Times start = now();
        parallel_for(tasks, 1, [&](std::size_t task) { sum += embree.trace(batches[task]); });
        Times spent = since(start);
        loops.bare.wall_s += spent.wall_s, loops.bare.processor_s += spent.processor_s;
        start = now();
        parallel_for(tasks, 1, [&](std::size_t task) {
            std::array<TraceHit, 64> hits;
            std::uint64_t met = 0;
            for (std::size_t k = 0; k < batches[task].size(); k += hits.size()) {
                const std::size_t count = std::min(hits.size(), batches[task].size() - k);
                g.tracer->first_hits({&batches[task][k], count}, {hits.data(), count});
                for (std::size_t h = 0; h < count; ++h) met += hits[h].triangle;
            }
            sum += met;
        });
        spent = since(start);
        loops.tracer.wall_s += spent.wall_s, loops.tracer.processor_s += spent.processor_s;
        for (const auto& batch : batches) loops.rays += batch.size();
        loops.checksum += sum;
    }
    return loops;
}

void bench_scene(const std::filesystem::path& scene, BakeOptions options, int repeat) {
    const test::TemporaryFolder place;
    options.input = scene;
    options.output = place / "none.glb";
    BakeReport report;
    std::unique_ptr<BakedGeometry> geometry;
    {
        StageClock clock(options, report);
        const BakeFolder folder(place / "work", options.output);
        geometry = prepare_geometry(options, folder, clock, report);
    }
    const BareEmbree embree(geometry->scene);
    StageTimes stages;
    Loops loops;
    for (int k = 0; k < repeat; ++k) {
        const StageTimes run = run_stages(options, *geometry);
        const std::uint64_t rays_per_patch = run.rays / geometry->patches.count();
        const Loops loop = run_loops(options, *geometry, embree, rays_per_patch);
        if (loop.rays != run.rays) throw std::runtime_error("the loops do not cast the rays of the stage");
        keep_best(stages.evidence, run.evidence);
        keep_best(stages.pooling, run.pooling);
        keep_best(stages.closure, run.closure);
        keep_best(loops.tracer, loop.tracer);
        keep_best(loops.bare, loop.bare);
        stages.rays = run.rays, stages.pairs = run.pairs, stages.bytes = run.bytes;
        loops.checksum ^= loop.checksum;
    }
    const double rays = static_cast<double>(stages.rays);
    fmt::print("{}: {} triangles, {} patches, {} chunks, {:.1f} M rays, {:.1f} M pairs in {:.1f} MB\n",
               scene.filename().string(), geometry->scene.triangle_count(), geometry->patches.count(),
               geometry->layout.chunk_count(), rays / 1e6, static_cast<double>(stages.pairs) / 1e6,
               static_cast<double>(stages.bytes) / 0x1p20);
    const auto line = [&](const char* name, const Times& t) {
        fmt::print("  {:<8} {:7.2f} Mrays/s wall  {:7.2f} Mrays/s of processor   bare ratio {:.2f} wall, {:.2f} processor\n", name,
                   rays / t.wall_s / 1e6, rays / t.processor_s / 1e6, loops.bare.wall_s / t.wall_s,
                   loops.bare.processor_s / t.processor_s);
    };
    line("stage", stages.evidence);
    line("tracer", loops.tracer);
    line("bare", loops.bare);
    fmt::print("  bare {:.2f} s, evidence {:.2f} s, pooling {:.2f} s, closure {:.2f} s wall\n", loops.bare.wall_s,
               stages.evidence.wall_s, stages.pooling.wall_s, stages.closure.wall_s);
    fmt::print("  evidence + pooling = {:.2f} times bare by wall time, {:.2f} times by processor time\n",
               (stages.evidence.wall_s + stages.pooling.wall_s) / loops.bare.wall_s,
               (stages.evidence.processor_s + stages.pooling.processor_s) / loops.bare.processor_s);
    std::fflush(stdout);
}

std::vector<std::filesystem::path> default_scenes() {
    const std::filesystem::path root = LUXEL_BENCH_SOURCE_DIR;
    const char* scenes = std::getenv("LUXEL_SCENES");
    const std::filesystem::path foreign = scenes ? std::filesystem::path(scenes) : root / "../shared/scenes";
    return {root / "samples/corridor_64/corridor_64.gltf", foreign / "staircase/staircase.glb",
            root / "samples/cornell_box/cornell_box.gltf"};
}

int run(int count, char** words) {
    BakeOptions options;
    options.rays = 512;
    options.threads = 2;
    int repeat = 3;
    std::vector<std::filesystem::path> scenes;
    for (int k = 1; k < count; ++k) {
        const std::string word = words[k];
        const auto value = [&] {
            if (k + 1 >= count) throw std::runtime_error(word + " needs a value");
            return std::string(words[++k]);
        };
        if (word == "--rays") options.rays = std::stoull(value());
        else if (word == "--threads") options.threads = static_cast<unsigned>(std::stoul(value()));
        else if (word == "--repeat") repeat = std::stoi(value());
        else if (word == "--texels-per-metre") options.unwrap.texels_per_metre = std::stod(value());
        else scenes.emplace_back(word);
    }
    const ThreadLimit threads(options.threads);
    for (const auto& scene : scenes.empty() ? default_scenes() : scenes)
        if (std::filesystem::exists(scene)) bench_scene(scene, options, repeat);
        else fmt::print("{}: not here\n", scene.string());
    return 0;
}

}  // namespace
}  // namespace luxel::bench

int main(int count, char** words) {
    try {
        return luxel::bench::run(count, words);
    } catch (const std::exception& error) {
        fmt::print(stderr, "evidence_bench: {}\n", error.what());
        return 1;
    }
}
