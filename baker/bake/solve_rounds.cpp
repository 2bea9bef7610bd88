#include "baker/bake/solve_rounds.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "baker/accuracy/ray_allocation.h"
#include "baker/accuracy/replicate_gain.h"
#include "baker/accuracy/row_mean.h"
#include "baker/bake/decisions.h"
#include "baker/bake/endless_light.h"
#include "baker/bake/estimator_choice.h"
#include "baker/bake/preview.h"
#include "baker/bake/stage_files.h"
#include "baker/bake/stopping.h"
#include "baker/bake/store_stage.h"
#include "baker/patches/neighbourhoods.h"
#include "baker/store/block_cache.h"
#include "formats/bake/patches_file.h"

namespace luxel {
namespace {

/// How much a round may add to the rays: what it learns must be worth a solve.
constexpr double most_growth = 4;
/// Beyond so many rays per patch on average a wanted error is given up.
constexpr std::uint64_t most_rays = 65536;
/// Patches along a side of a neighbourhood that shares one density of rays.
constexpr std::uint32_t neighbourhood_patches = 4;
/// Solving to choose rays need not be exact.
constexpr double loose_tolerance = 0.02;

class Rounds {
  public:
    Rounds(const BakeOptions& options, const BakedGeometry& geometry, const BakeFolder& folder, const MemoryPlan& plan,
           StageClock& clock, BakeReport& report)
        : options_(options), g_(geometry), folder_(folder), plan_(plan), clock_(clock), report_(report),
          evidence_(options, geometry, folder), is_needed_(needs_form_factors(options, geometry)),
          neighbourhood_(neighbourhoods(geometry.atlas, geometry.patches, neighbourhood_patches * options.patch_texels)) {}

    SolvedScene run() {
        scene_.sources = light_patches(options_, g_, folder_, clock_, report_);
        if (options_.preview_s > 0) preview_.emplace(options_, g_, scene_.sources, report_);
        if (!evidence_.add(first_plan(), clock_, report_)) refuse_without_light(options_, "stopped in the first round of rays");
        while (wants_more()) {
            const Key key = evidence_.plan_key(evidence_.rounds());
            auto next = load_plan(folder_.plan(key), key, g_.patches.count());
            if (next) {
                clock_.stage("importance", [&] {
                    clock_.keeps(folder_.plan(key));
                    return true;
                });
            } else if (!is_stopping(options_)) {
                solve(round_tolerance());
                if (!scene_.solution.is_whole) return finish();
                if (by_error() && judge()) return finish();
                if (!is_stopping(options_)) {
                    next = choose(folder_.plan(key));
                    if (is_empty(*next)) break;
                    save_plan(folder_.plan(key), key, *next);
                }
            }
            if (!next || !add_round(*next)) {
                note_stop(report_, "evidence", "rays end with round " + std::to_string(evidence_.rounds()) + ", " +
                                                   std::to_string(static_cast<std::uint64_t>(rays_per_patch())) + " a patch");
                break;
            }
        }
        solve(last_tolerance());
        if (scene_.solution.is_whole) judge();
        return finish();
    }

  private:
    [[nodiscard]] bool by_error() const { return options_.error > 0; }
    /// Of the solves between rounds.
    [[nodiscard]] double round_tolerance() const { return by_error() ? options_.tolerance : loose_tolerance; }
    /// Of the last solve: where the bake was stopped between rounds, the looser solution that is there serves better than the
    /// first step of a stricter one.
    [[nodiscard]] double last_tolerance() const {
        std::error_code ignored;
        const Key matrix = matrix_keys(options_, evidence_).closure;
        const auto is_there = [&](double tolerance) {
            return std::filesystem::exists(folder_.solution(solution_key(options_, g_, matrix, tolerance)), ignored);
        };
        return report_.stopped && !is_there(options_.tolerance) && is_there(round_tolerance()) ? round_tolerance() : options_.tolerance;
    }
    [[nodiscard]] double rays_per_patch() const {
        return static_cast<double>(evidence_.total_rays()) / std::max<double>(1, static_cast<double>(g_.patches.count()));
    }
    /// Rays per patch after `round` further rounds when no error is wanted.
    [[nodiscard]] std::uint64_t schedule(std::uint32_t round) const {
        double rays = static_cast<double>(thin_round_rays);
        for (std::uint32_t k = 0; k < round; ++k) rays *= most_growth;
        return std::min(options_.rays, static_cast<std::uint64_t>(std::min(rays, 1e12)));
    }
    [[nodiscard]] LevelPlan first_plan() const {
        const bool once = !options_.importance && !by_error() && is_needed_;
        const std::uint64_t rays = once ? options_.rays : std::min(by_error() ? thin_round_rays : options_.rays, thin_round_rays);
        return {std::vector<LevelRange>(g_.patches.count(), first_levels(options_, rays))};
    }
    [[nodiscard]] bool wants_more() const {
        if (!is_needed_ || !evidence_.extensible() || g_.patches.count() == 0) return false;
        if (by_error()) return rays_per_patch() < static_cast<double>(most_rays);
        return options_.importance && schedule(evidence_.rounds() - 1) < options_.rays;
    }
    static bool is_empty(const LevelPlan& plan) {
        return std::all_of(plan.levels.begin(), plan.levels.end(), [](LevelRange r) { return r.empty(); });
    }

    static Key accuracy_key(const Key& solution) { return KeyBuilder("accuracy 2").key(solution).finish(); }

    void solve(double tolerance) {
        scene_.matrix = build_matrix(options_, g_, evidence_, folder_, plan_, clock_, report_);
        scene_.solution = solve_patches(options_, g_, scene_.sources, scene_.matrix, tolerance, folder_, preview_ ? &*preview_ : nullptr,
                                         clock_, report_);
        if (scene_.solution.is_whole)
            forget_last_light();
        else
            serve_last_light();
    }

    /// A solve that was stopped before its bound said anything gives way to that of the round before.
    void serve_last_light() {
        SolveResult& result = scene_.solution.result;
        if (!last_ || result.error_bound < 1) return;
        for (const double tolerance : {options_.tolerance, round_tolerance()}) {
            const Key key = solution_key(options_, g_, last_->closure, tolerance);
            auto last = load_solution(folder_.solution(key), key, g_.patches.count());
            if (!last) continue;
            result = std::move(*last);
            char bound[32];
            std::snprintf(bound, sizeof bound, "%.1e", result.error_bound);
            return note_stop(report_, "solve", std::string("the light is that of the round before, with a bound of ") + bound);
        }
    }

    /// Removes what serve_last_light() would have taken.
    void forget_last_light() {
        if (!last_) return;
        for (const double tolerance : {loose_tolerance, options_.tolerance})
            folder_.discard_solution(solution_key(options_, g_, last_->closure, tolerance));
        last_.reset();
    }

    /// What the accuracy room needs to know: the light, and the matrix that made it.
    struct Judged {
        explicit Judged(const SolvedScene& scene)
            : strips(*scene.matrix.strips, scene.matrix.area_m2, scene.matrix.closure),
              cache(strips, scene.matrix.cache_bytes),
              means(row_means(cache, scene.solution.result.radiosity, scene.matrix.closure.mu, scene.matrix.closure.row_open_m2)) {}
        ClosedMatrix strips;
        BlockCache cache;
        std::vector<Channels> means;
    };
    [[nodiscard]] LightState light(const Judged& judged) const {
        return {evidence_.ids(), scene_.matrix.area_m2, scene_.solution.reflectance, scene_.solution.result.radiosity,
                judged.means, scene_.matrix.closure.mu, scene_.matrix.closure.row_open_m2, neighbourhood_, options_.forced.has(Part::colours)};
    }

    /// Luminance of all light that arrives, lamps included, area-weighted.
    [[nodiscard]] double mean_irradiance() const {
        double sum = 0, area = 0;
        for (std::size_t p = 0; p < g_.patches.count(); ++p) {
            const Channels& h = scene_.solution.result.irradiance[p];
            sum += scene_.matrix.area_m2[p] * (0.2126 * h[0] + 0.7152 * h[1] + 0.0722 * h[2] +
                                               static_cast<double>(luminance(scene_.sources.lamp_irradiance[p])));
            area += scene_.matrix.area_m2[p];
        }
        return area > 0 ? sum / area : 0;
    }

    /// Stage "accuracy". True if the wanted error is met.
    bool judge() {
        if (!evidence_.extensible()) {
            report_.skipped.push_back({"accuracy", "the counts of the hemicube do not scatter: no standard error can be found from them"});
            return true;
        }
        const Key key = accuracy_key(scene_.solution.key);
        bool is_known = true;
        clock_.stage("accuracy", [&] {
            const auto path = folder_.accuracy(key);
            clock_.keeps(path);
            if (auto error = load_accuracy(path, key, g_.patches.count())) {
                scene_.error = std::move(*error);
                return true;
            }
            if (is_stopping(options_)) {
                is_known = false;
                return false;
            }
            Judged judged(scene_);
            const ReplicateGains gains = replicate_gains(*evidence_.source(), light(judged), evidence_.replicates());
            if (scene_.matrix.rows) report_.rays_traced += evidence_.total_rays();
            scene_.error = standard_error(judged.cache, light(judged), gains, mean_irradiance());
            save_accuracy(path, key, scene_.error);
            return false;
        });
        if (!is_known) {
            note_stop(report_, "accuracy", "the standard error was not estimated");
            return false;
        }
        report_.standard_error = scene_.error.relative;
        return scene_.error.relative <= options_.error;
    }

    /// Stage "importance": the plan of the next round.
    LevelPlan choose(const std::filesystem::path& path) {
        LevelPlan next;
        clock_.stage("importance", [&] {
            clock_.keeps(path);
            double goal = static_cast<double>(schedule(evidence_.rounds()));
            if (by_error()) {
                // The error falls with the root of the rays; a little more than that, to be done with it.
                const double ratio = scene_.error.relative / options_.error;
                goal = rays_per_patch() * std::clamp(1.1 * ratio * ratio, 1.5, most_growth);
            }
            const double total = goal * static_cast<double>(g_.patches.count());
            std::vector<double> wanted(g_.patches.count(), 1.0);
            if (options_.importance) {
                Judged judged(scene_);
                wanted = best_rays(judged.cache, light(judged), total, static_cast<double>(thin_round_rays));
            }
            next = plan_by_want(wanted, evidence_.reached(), evidence_.replicates(), static_cast<std::uint64_t>(total));
            return false;
        });
        return next;
    }

    /// Traces one more round in the place of the last matrix, which serves on when that is stopped.
    bool add_round(const LevelPlan& plan) {
        if (scene_.matrix.rows) report_.rays_traced += scene_.matrix.rows->rays_traced();
        scene_.matrix = {};
        scene_.solution = {};
        const MatrixKeys last = matrix_keys(options_, evidence_);
        if (!evidence_.add(plan, clock_, report_)) return false;
        forget_last_light();
        forget_matrix(last);
        last_ = last;
        return true;
    }

    /// Removes the files of a matrix but for its light, also those of a run that was killed before it came to that, or stopped there.
    void forget_matrix(const MatrixKeys& keys) {
        folder_.discard(keys.strips, keys.closure);
        for (const double tolerance : {loose_tolerance, options_.tolerance}) {
            std::error_code ignored;
            std::filesystem::remove(folder_.accuracy(accuracy_key(solution_key(options_, g_, keys.closure, tolerance))), ignored);
        }
    }

    /// What a reader of the bake folder needs beside the matrix itself.
    void describe_matrix() const {
        const MatrixKeys keys = matrix_keys(options_, evidence_);
        const auto path = folder_.patches(keys.strips);
        if (block_file_is_whole(path, FileKind::patches, patches_version, keys.strips)) return;
        PatchesFile patches;
        patches.ids.assign(evidence_.ids().begin(), evidence_.ids().end());
        patches.area_m2 = scene_.matrix.area_m2;
        patches.first_patch = g_.layout.first_patch;
        patches.evidence.assign(evidence_.round_keys().begin(), evidence_.round_keys().end());
        patches.closure = keys.closure;
        patches.estimator = options_.estimator == EstimatorKind::hemicube ? "hemicube" : "ray";
        save_patches(path, keys.strips, patches);
    }

    /// What only the matrix and its light tell of parts that were not needed.
    void report_skipped() const {
        const bool is_listed = std::ranges::any_of(report_.skipped, [](const auto& entry) { return entry.first == part_name(Part::solve); });
        if (!is_listed && std::ranges::all_of(scene_.sources.emission, [](const Channels& m) { return m == Channels{0, 0, 0}; }))
            report_.skipped.emplace_back(part_name(Part::solve), "no light arrives anywhere");
        if (report_.solve_path == "in memory") report_.skipped.emplace_back(part_name(Part::disk), report_.solve_path_why);
    }

    SolvedScene finish() {
        report_skipped();
        judge_endless_light(options_, g_, scene_.matrix, scene_.solution, report_);
        describe_matrix();
        remove_other_store(options_, folder_, scene_.matrix.strip_key, evidence_.round_keys());
        // Drafts read the matrix once more for their texels; nobody else does.
        if (scene_.matrix.rows && options_.gather_rays) scene_.matrix.rows->forget();
        const auto [least, most] = std::minmax_element(evidence_.reached().begin(), evidence_.reached().end());
        if (least != evidence_.reached().end()) {
            report_.least_rays = evidence_.rays_at(*least);
            report_.most_rays = evidence_.rays_at(*most);
        }
        const SolveResult& result = scene_.solution.result;
        if (report_.stopped) return std::move(scene_);
        if (!result.converged)
            report_.warnings.push_back({"not-converged", "solve",
                                        "stopped at an error bound of " + std::to_string(result.error_bound) +
                                            " before the tolerance was met"});
        if (by_error() && scene_.error.relative > options_.error)
            report_.warnings.push_back({"error-not-reached", "evidence",
                                        "standard error " + std::to_string(scene_.error.relative) + " after " +
                                            std::to_string(static_cast<std::uint64_t>(rays_per_patch())) + " rays per patch"});
        return std::move(scene_);
    }

    const BakeOptions& options_;
    const BakedGeometry& g_;
    const BakeFolder& folder_;
    const MemoryPlan& plan_;
    StageClock& clock_;
    BakeReport& report_;
    EvidenceRounds evidence_;
    bool is_needed_;  ///< more than a thin first round
    std::vector<std::uint32_t> neighbourhood_;
    SolvedScene scene_;
    std::optional<Preview> preview_;
    std::optional<MatrixKeys> last_;  ///< of the round before, whose solution is kept until there is another
};

}  // namespace

SolvedScene solve_in_rounds(const BakeOptions& options, const BakedGeometry& geometry, const BakeFolder& folder,
                            const MemoryPlan& plan, StageClock& clock, BakeReport& report) {
    return Rounds(options, geometry, folder, plan, clock, report).run();
}

}  // namespace luxel
