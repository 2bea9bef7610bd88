#include "baker/sweep/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "baker/sweep/bake_child.h"
#include "baker/sweep/bake_run.h"
#include "baker/sweep/work_folder.h"
#include "formats/base/error.h"
#include "formats/base/file.h"

namespace luxel {
namespace {

const BakeSetting reference_quality{"quality", "reference"};

/// Thrown through the loops where the user wants to end.
struct Interrupted {};

void forget(const std::filesystem::path& path) {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
}

/// Of a bake folder, by the settings that decide what stays in it: bakes with different ones would take each other's files away.
std::string work_name(const std::vector<BakeSetting>& settings) {
    std::string name;
    for (const BakeSetting& s : settings)
        if (s.option == "store" || s.option == "store-bytes") name += (name.empty() ? "" : "-") + s.value;
    return name.empty() ? "all" : name;
}

class Sweep {
  public:
    explicit Sweep(const SweepOptions& options)
        : options_(options), runs_(options.folder / "runs"), model_(runs_ / "scene.glb"), report_(runs_ / "report.json"), log_(runs_ / "messages.txt") {
        for (const char* name : {"points", "runs", "work", "reference"}) make_folder(options_.folder / name);
    }

    SweepResult run() {
        SweepResult result;
        try {
            const SweepReference reference = options_.reference_pages.empty() ? baked_reference() : user_reference(options_.reference_pages);
            result.reference = reference.name();
            for (const GridPoint& point : options_.points) {
                ++number_;
                if (options_.stop && options_.stop->is_asked()) throw Interrupted();
                result.points.push_back(result_of(point, reference, result.found));
            }
            const bool all_well = std::ranges::none_of(result.points, &PointResult::failed);
            if (!options_.keep_work && all_well) forget(options_.folder / "work");
        } catch (const Interrupted&) {
            result.interrupted = true;
        }
        forget(runs_);
        return result;
    }

  private:
    void tell(const std::string& line) const {
        if (options_.progress) options_.progress(line);
    }

    /// One bake to runs/scene.glb. Throws Interrupted.
    ChildResult bake(const std::vector<BakeSetting>& settings, const std::filesystem::path& work, const char* layers) const {
        forget(runs_);
        make_folder(runs_);
        std::vector<std::string> arguments{"bake", options_.scene.string(), "-o", model_.string()};
        for (std::string& word : settings_arguments(settings)) arguments.push_back(std::move(word));
        for (const std::string& word : {std::string("--aov"), std::string(layers), std::string("--work"), work.string(), std::string("--report"), report_.string(), std::string("-q")})
            arguments.push_back(word);
        ChildResult child = run_child(options_.program, arguments, log_, options_.stop);
        if (child.interrupted) throw Interrupted();
        return child;
    }

    [[nodiscard]] BakeRun read_report() const { return parse_bake_run(read_file(report_), report_.string()); }

    SweepReference baked_reference() const {
        const std::vector<BakeSetting> settings = merged_settings(options_.reference_common, {reference_quality});
        std::vector<BakeSetting> deciding = settings;
        std::erase_if(deciding, [](const BakeSetting& s) { return s.option == "memory" || s.option == "threads"; });  // they never change the light
        const Key key = KeyBuilder("sweep reference 1").key(options_.inputs).text(settings_text(deciding)).finish();
        const auto place = options_.folder / "reference" / key.text().substr(0, 16);
        make_folder(place);
        std::vector<std::vector<std::filesystem::path>> pages;
        for (std::size_t k = 0; k < reference_seeds.size(); ++k) {
            const std::string letter(1, static_cast<char>('a' + k));
            const auto done = place / (letter + ".json");
            if (!std::filesystem::exists(done)) bake_reference(settings, reference_seeds[k], place / letter, done);
            pages.push_back(pages_of(place / letter / "scene.glb", parse_bake_run(read_file(done), done.string()).pages));
        }
        forget(reference_work());
        return {pages[0], pages[1], key, "two bakes at --quality reference"};
    }

    [[nodiscard]] std::filesystem::path reference_work() const { return options_.folder / "work" / "reference"; }

    void bake_reference(std::vector<BakeSetting> settings, std::uint64_t seed, const std::filesystem::path& place, const std::filesystem::path& done) const {
        tell(fmt::format("reference, seed {}", seed));
        settings = merged_settings(settings, {{"seed", std::to_string(seed)}});
        const ChildResult child = bake(settings, reference_work(), "valid,area");
        if (child.exit_code != 0)
            throw Error(ErrorCode::bad_input, options_.scene.string(), "the reference cannot be baked: " + child.message, "luxel bake " + shell_word(options_.scene.string()) + " -o OUT " + settings_text(settings) + " says more");
        const BakeRun run = read_report();
        forget(place);
        make_folder(place);
        for (std::uint32_t page = 0; page < run.pages; ++page)
            std::filesystem::rename(page_path(model_, page), page_path(place / "scene.glb", page));
        // Last, so that it is there only when everything is.
        publish_file(done, read_file(report_));
    }

    PointResult result_of(const GridPoint& point, const SweepReference& reference, std::size_t& found) {
        const std::string place = fmt::format("{} of {}: {}", number_, options_.points.size(), point.name);
        const Key key = KeyBuilder("sweep point 1")
                            .key(options_.inputs).key(reference.key()).text(settings_text(merged_settings(options_.common, point.settings)))
                            .integer(options_.repeats).integer(point.has_texel_errors).finish();
        const auto path = options_.folder / "points" / (key.text().substr(0, 16) + ".json");
        if (std::filesystem::exists(path)) {
            PointResult known = parse_point_file(read_file(path), path.string());
            known.point = point;  // its name is that of this grid
            known.bake_line = bake_line(options_, point);
            ++found;
            tell(place + ": measured before");
            return known;
        }
        PointResult result = measure(point, reference);
        if (result.failed) tell(place + ": failed: " + result.message);
        else {
            const std::string text = point_file(result);
            publish_file(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
            tell(fmt::format("{}: {:.2f} s, error {:.2f} %, {} MB, {:.1f} MB on disk", place, result.seconds, 100 * result.error.relative_rmse, result.peak_bytes >> 20,
                             static_cast<double>(result.disk_bytes) / 0x1p20));
        }
        return result;
    }

    PointResult measure(const GridPoint& point, const SweepReference& reference) {
        PointResult result;
        result.point = point;
        result.bake_line = bake_line(options_, point);
        std::vector<std::vector<StageCost>> costs;
        for (std::uint32_t repeat = 0; repeat < options_.repeats; ++repeat) {
            const std::vector<BakeSetting> settings = merged_settings(options_.common, point.settings);
            WorkFolder work(options_.folder / "work" / fmt::format("{}-{}", work_name(settings), repeat));
            const ChildResult child = bake(settings, work.path(), point.has_texel_errors ? "error,valid,area" : "valid,area");
            // 6: not converged, or --error not reached; there is a lightmap all the same.
            if (child.exit_code != 0 && child.exit_code != static_cast<int>(ErrorCode::stopped_early)) {
                result.failed = true;
                result.message = child.message;
                return result;
            }
            const BakeRun run = read_report();
            costs.push_back(work.whole(run));
            if (repeat == 0) add_figures(run, reference, result);
        }
        add_costs(costs, result);
        return result;
    }

    void add_figures(const BakeRun& run, const SweepReference& reference, PointResult& result) const {
        MeasuredBake measured = measure_bake(model_, run.pages, result.point.has_texel_errors, reference);
        result.error = measured.figures;
        result.error_map_png = std::move(measured.error_map_png);
        result.disk_bytes = disk_bytes(run);
        result.model_bytes = std::filesystem::file_size(model_);
        result.run = run.figures;
    }

    static void add_costs(const std::vector<std::vector<StageCost>>& costs, PointResult& result) {
        std::vector<double> processor_seconds;
        for (const auto& run : costs) {
            processor_seconds.push_back(total_processor_seconds(run));
            result.repeat_seconds.push_back(total_seconds(run));
            result.peak_bytes = std::max(result.peak_bytes, highest_peak(run));
        }
        result.seconds = median_of(result.repeat_seconds);
        result.processor_seconds = median_of(processor_seconds);
        result.stages = median_stages(costs);
    }

    const SweepOptions& options_;
    std::filesystem::path runs_, model_, report_, log_;
    std::size_t number_ = 0;
};

}  // namespace

SweepResult run_sweep(const SweepOptions& options) { return Sweep(options).run(); }

std::string bake_line(const SweepOptions& options, const GridPoint& point) {
    const std::string settings = settings_text(merged_settings(options.common, point.settings));
    const std::string output = "out/" + options.scene.stem().string() + ".glb";
    return "luxel bake " + shell_word(options.scene.string()) + " -o " + shell_word(output) + (settings.empty() ? "" : " ") + settings;
}

}  // namespace luxel
