// What gathering at texels costs for what it tells.
//
// usage: gather_bench [--scene FILE] [--texels-per-metre X] [--truth RAYS] [--threads N]
//
// Without --scene: two_rooms and corridor_4 of the samples, and staircase, which lies in the folder LUXEL_SCENES or in
// ../shared/scenes. For each scene the patches are solved once; then the light of its texels is gathered
//   plain   cosine rays alone, each texel for itself
//   aimed   the same with rays to emitters, combined by multiple importance sampling
//   guide   the same, bent to where the patch gets its light
//   luxel   as a bake does: first gathering, guided and aimed rays, control variates, sharing
// with more and more rays, and compared with a gathering of very many rays (guided, unshared, other random numbers; its own noise is
// subtracted). Errors are root mean squares of what a texel is off, relative to its own light (or to 1 % of the mean where that is
// more), and relative to the mean light; lamps are left out.
// "times" is how many times as many rays of those two have the same error, as their error falls with the root of
// their number. Rays are counted with all that follow from near hits, the first gathering included. Times are processor seconds.
//
// Then: rays per second of gathering against a bare Embree loop over cosine rays from the same texels.
#include <fmt/format.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdlib>

#include "baker/bake/memory_plan.h"
#include "baker/bake/page_lighter.h"
#include "baker/bake/solve_rounds.h"
#include "baker/core/parallel.h"
#include "baker/core/sampling.h"
#include "baker/core/sobol.h"
#include "baker/core/units.h"
#include "baker/light/share_light.h"
#include "baker/patches/patch_sampler.h"
#include "baker/core/ray_offset.h"
#include "tests/bench/bare_embree.h"
#include "tests/support/temporary_folder.h"

namespace luxel::bench {
namespace {

double processor_seconds() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Light of all texels of all pages without the lamps, luminance.
struct Gathered {
    std::vector<double> light, variance;  ///< variance: of the mean of both halves, as they differ
    double rays = 0, seconds = 0;
};

/// Of errors: of a texel's own light, of the mean.
constexpr std::size_t measures = 2;

/// A way whose error falls with the root of its rays.
struct Baseline {
    double square_rays = 0, seconds_per_ray = 0;
    [[nodiscard]] double rays_for(double error) const { return square_rays / (error * error); }
    [[nodiscard]] double seconds_for(double error) const { return rays_for(error) * seconds_per_ray; }
};

double luminance_of(const GatheredPage& page, int half, std::size_t k) {
    const auto h = static_cast<std::size_t>(half);
    return static_cast<double>(luminance(page.emitted.halves[h][k] + page.reflected.halves[h][k]));
}

class Bench {
  public:
    Bench(const std::filesystem::path& scene, double density) {
        options_.input = scene;
        options_.output = place_ / "none.glb";
        options_.work = (place_ / "work").string();
        options_.rays = 1024;
        options_.tolerance = 1e-4;
        options_.unwrap.texels_per_metre = density;
        options_.gather_rays = 128;
        folder_.emplace(options_.work, options_.output);
        StageClock clock(options_, report_);
        geometry_ = prepare_geometry(options_, *folder_, clock, report_);
        const MemoryPlan plan{0, std::uint64_t{512} << 20, std::uint64_t{512} << 20};
        solved_.emplace(solve_in_rounds(options_, *geometry_, *folder_, plan, clock, report_));
        name_ = scene.stem().string();
    }

    void run(std::uint32_t truth_rays) {
        const double start = processor_seconds();
        PageLighter lighter(options_, *geometry_, solved_->sources, solved_->matrix, solved_->solution);
        const GatherInput input = *lighter.gather_input();
        const double first_seconds = processor_seconds() - start;
        fmt::print("{}: {} triangles, {} texels, {} patches; first gathering and guides {:.2f} s\n", name_, geometry_->scene.triangle_count(),
                   geometry_->texels.texel_count(), geometry_->patches.count(), first_seconds);
        const Gathered truth = gather(input, truth_rays, 77, true);
        double mean = 0;
        for (const double light : truth.light) mean += light / static_cast<double>(truth.light.size());
        GatherInput plain{input.scene, input.atlas, input.texels, input.patches, input.tracer, input.emitters, input.radiosity, none_, input.sky};
        const auto baseline = [&](const char* name, const GatherInput& with, bool aim) {
            std::array<Baseline, measures> last;
            for (const std::uint32_t rays : {64u, 256u, 1024u}) {
                const Gathered found = gather(with, rays, 5, aim);
                const auto errors = errors_of(found, truth, mean);
                for (std::size_t m = 0; m < measures; ++m) last[m] = {errors[m] * errors[m] * found.rays, found.seconds / found.rays};
                fmt::print("  {} {:5} rays  {:7.1f} per texel  {:7.2f} s  error of own light {:6.2f} %, of the mean {:6.2f} %\n", name, rays, per_texel(found),
                           found.seconds, 100 * errors[0], 100 * errors[1]);
                std::fflush(stdout);
            }
            return last;
        };
        const auto cosine = baseline("plain", plain, false), aimed = baseline("aimed", plain, true);
        baseline("guide", input, true);
        for (const std::uint32_t rays : {16u, 64u, 128u, 256u, 512u}) {
            Gathered found = gather(input, rays, 5, true, options_.share_texels);
            found.rays += static_cast<double>(lighter.first_rays());
            found.seconds += first_seconds;
            const auto errors = errors_of(found, truth, mean);
            fmt::print("  luxel {:5} rays  {:7.1f} per texel  {:7.2f} s\n", rays, per_texel(found), found.seconds);
            for (std::size_t m = 0; m < measures; ++m)
                fmt::print("      of {:9} {:6.2f} %  rays of plain {:6.1f} times, aimed {:5.1f}; time {:6.1f}, {:5.1f}\n", m ? "the mean" : "own light",
                           100 * errors[m], cosine[m].rays_for(errors[m]) / found.rays, aimed[m].rays_for(errors[m]) / found.rays,
                           cosine[m].seconds_for(errors[m]) / found.seconds, aimed[m].seconds_for(errors[m]) / found.seconds);
            std::fflush(stdout);
        }
        compare_with_embree(input);
    }

  private:
    static double per_texel(const Gathered& found) { return found.rays / static_cast<double>(found.light.size()); }

    /// `share`: radius; 0: not.
    [[nodiscard]] Gathered gather(const GatherInput& input, std::uint32_t rays, std::uint64_t seed, bool aim, std::uint32_t share = 0) const {
        Gathered all;
        GatherOptions gathering{.rays = rays, .aim_at_emitters = aim, .lamp_points = 1, .seed = seed};
        gathering.near_m = patch_side_m(options_, geometry_->atlas);
        for (std::uint32_t page = 0; page < geometry_->atlas.page_count; ++page) {
            const PageTexels& texels = geometry_->texels.pages[page];
            const double start = processor_seconds();
            const auto found = gather_page(input, page, gathering, nullptr);
            std::vector<Rgb> shared(texels.texels.size(), Rgb(0, 0, 0));
            if (share)
                for (const GatheredLight* light : {&found->emitted, &found->reflected}) {
                    const SharedLight part = share_light(texels, geometry_->texels.page_size, *light, share);
                    for (std::size_t k = 0; k < shared.size(); ++k) shared[k] += part.irradiance[k];
                }
            all.seconds += processor_seconds() - start;
            for (std::size_t k = 0; k < shared.size(); ++k) {
                if (!texels.can_send(texels.texels[k])) continue;
                const double a = luminance_of(*found, 0, k), b = luminance_of(*found, 1, k);
                all.light.push_back(share ? static_cast<double>(luminance(shared[k])) : (a + b) / 2);
                all.variance.push_back((a - b) * (a - b) / 4);
                all.rays += found->rays[k];
            }
        }
        return all;
    }

    /// Root mean squares: relative to each texel's own light, and over the mean light.
    static std::array<double, measures> errors_of(const Gathered& found, const Gathered& truth, double mean) {
        double own_sum = 0, sum = 0;
        for (std::size_t k = 0; k < truth.light.size(); ++k) {
            const double off = found.light[k] - truth.light[k], own = std::max(truth.light[k], 0.01 * mean);
            const double square = off * off - truth.variance[k];
            own_sum += square / (own * own), sum += square / (mean * mean);
        }
        const auto root = [&](double squares) { return std::sqrt(std::max(squares, 0.0) / static_cast<double>(truth.light.size())); };
        return {root(own_sum), root(sum)};
    }

    /// Guided rays without what follows from near hits, against Embree alone on rays from the same texels, twice in turns.
    void compare_with_embree(const GatherInput& input) const {
        constexpr std::uint32_t rays = 128;
        const BareEmbree embree(geometry_->scene);
        double gathering = 0, bare = 0, count = 0;
        std::atomic<std::uint64_t> checksum{0};
        for (int turn = 0; turn < 2; ++turn)
            for (std::uint32_t page = 0; page < geometry_->atlas.page_count; ++page) {
                double start = processor_seconds();
                const auto found = gather_page(input, page, {.rays = rays, .aim_at_emitters = false, .lamp_points = 1, .seed = 3}, nullptr);
                gathering += processor_seconds() - start;
                for (const std::uint32_t own : found->rays) count += own;
                // As many at a time as fit into memory; only the tracing counts.
                const PageTexels& texels = geometry_->texels.pages[page];
                constexpr std::size_t portion = 1 << 14;
                for (std::size_t first = 0; first < texels.texels.size(); first += portion) {
                    const std::size_t end = std::min(texels.texels.size(), first + portion), tasks = (end - first + 63) / 64;
                    std::vector<std::vector<TraceRay>> batches(tasks);
                    parallel_for(tasks, 1, [&](std::size_t task) {
                        for (std::size_t k = first + task * 64; k < std::min(end, first + task * 64 + 64); ++k) append(input, page, k, rays, batches[task]);
                    });
                    start = processor_seconds();
                    parallel_for(tasks, 1, [&](std::size_t task) { checksum += embree.trace(batches[task]); });
                    bare += processor_seconds() - start;
                }
            }
        fmt::print("  gathering {:.2f} Mrays/s, bare Embree {:.2f} Mrays/s of processor on the same rays: {:.2f} of it\n", count / gathering / 1e6, count / bare / 1e6,
                   bare / gathering);
        std::fflush(stdout);
    }

    static void append(const GatherInput& input, std::uint32_t page, std::size_t index, std::uint32_t rays, std::vector<TraceRay>& out) {
        const PageTexels& content = input.texels.pages[page];
        const Texel& texel = content.texels[index];
        if (!content.can_send(texel)) return;
        const SurfaceSampler sampler(input.scene, input.atlas, {content.fragments.data() + texel.first_fragment, texel.fragment_count}, false);
        const PatchNumber patch = input.patches.page_patch[page][std::size_t{texel.y} * input.patches.page_size + texel.x];
        const GuideWarp warp = patch != no_patch && !input.guides.empty() ? GuideWarp(input.guides.of(patch)) : GuideWarp();
        const Frame frame(patch != no_patch ? input.patches.patches[patch].normal : Vec3f(0, 0, 1));
        const SobolSequence sequence(mix(index, page));
        for (std::uint32_t k = 0; k < rays; ++k) {
            const auto u = sequence.point(k);
            const SurfacePoint at = sampler.point(u[0], u[1]);
            const GuideWarp::Point bent = warp.bend(u[2], u[3]);
            const Vec3f direction = guide_frame(frame, sampler.shading_normal(at)).to_world(cosine_direction(bent.u, bent.v));
            out.push_back({offset_origin(at.position, at.normal, input.scene.corner_extent(at.triangle)), direction, at.triangle});
        }
    }

    test::TemporaryFolder place_;
    BakeOptions options_;
    BakeReport report_;
    std::optional<BakeFolder> folder_;
    std::unique_ptr<BakedGeometry> geometry_;
    std::optional<SolvedScene> solved_;
    LightGuides none_;
    std::string name_;
};

}  // namespace
}  // namespace luxel::bench

int main(int argc, char** argv) {
    using namespace luxel;
    CLI::App app("What gathering at texels costs for what it tells");
    std::string scene;
    double density = 0;
    std::uint32_t truth = 8192;
    unsigned threads = 0;
    app.add_option("--scene", scene, "a scene of your own");
    app.add_option("--texels-per-metre", density, "of it");
    app.add_option("--truth", truth, "rays of what is compared with")->capture_default_str();
    app.add_option("--threads", threads, "0: all cores");
    CLI11_PARSE(app, argc, argv);
    const ThreadLimit limit(threads);
    const std::filesystem::path root = LUXEL_BENCH_SOURCE_DIR;
    const char* given = std::getenv("LUXEL_SCENES");
    const std::filesystem::path foreign = given ? std::filesystem::path(given) : root / "../shared/scenes";
    std::vector<std::pair<std::filesystem::path, double>> scenes{
        {root / "samples/two_rooms/two_rooms.gltf", 8}, {root / "samples/corridor_4/corridor_4.gltf", 6}, {foreign / "staircase/staircase.glb", 6}};
    if (!scene.empty()) scenes = {{scene, density}};
    for (const auto& [file, texels_per_metre] : scenes) {
        if (!std::filesystem::exists(file)) {
            fmt::print("{}: not there, left out\n", file.string());
            continue;
        }
        bench::Bench(file, texels_per_metre).run(truth);
    }
    return 0;
}
