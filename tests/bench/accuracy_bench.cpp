/// What pooling, closure and importance are worth: errors of the patches' radiosity against the same patches with many
/// rays, compared with rows alone (each patch believes only its own rays) at equal rays; bias; calibration of the
/// standard error.
///
/// usage: accuracy_bench [--scene NAME] [--rays N] [--reference N] [--seeds N] [--density T] [--patch-texels K] [--albedo R] [--closure N]
/// Prints per method: mean squared error, its ratio to rows alone, also in the dimmer half of the patches, bias of the light;
/// share of patches within two sigma.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "baker/bake/bake.h"
#include "baker/bake/bake_folder.h"
#include "baker/bake/geometry_stages.h"
#include "baker/bake/stage_files.h"
#include "formats/bake/evidence_file.h"

using namespace luxel;
namespace fs = std::filesystem;

namespace {

struct Settings {
    std::string scene = "two_rooms";
    std::uint64_t rays = 256, reference = 65536;
    std::uint32_t seeds = 4, patch_texels = 4, closure = 0;
    double density = 4, albedo = 0;
};

fs::path only(const fs::path& folder, const std::string& stem) {
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().filename().string().starts_with(stem)) return entry.path();
    throw std::runtime_error("no " + stem + " in " + folder.string());
}

std::vector<double> column(const fs::path& path, std::size_t index, FileKind kind) {
    return read_column<double>(BlockFileReader(path, kind, 1), index);
}

/// The sample, with all base colours replaced by a grey if asked.
fs::path scene_file(const Settings& s, const fs::path& folder) {
    const fs::path sample = fs::path(LUXEL_BENCH_SOURCE_DIR) / "samples" / s.scene / (s.scene + ".gltf");
    if (s.albedo <= 0) return sample;
    auto document = nlohmann::json::parse(std::ifstream(sample));
    for (auto& material : document["materials"]) {
        auto& pbr = material["pbrMetallicRoughness"];
        pbr.erase("baseColorTexture");
        pbr["baseColorFactor"] = {s.albedo, s.albedo, s.albedo, 1};
    }
    fs::copy_file(sample.parent_path() / (s.scene + ".bin"), folder / (s.scene + ".bin"), fs::copy_options::overwrite_existing);
    std::ofstream(folder / (s.scene + ".gltf")) << document.dump();
    return folder / (s.scene + ".gltf");
}

BakeOptions options_of(const Settings& s, const fs::path& input, const fs::path& folder, const std::string& name) {
    BakeOptions o;
    o.input = input;
    o.output = folder / (name + ".glb");
    o.work = folder / name;
    o.unwrap.texels_per_metre = s.density;
    o.unwrap.page_size = 512;
    o.patch_texels = s.patch_texels;
    o.chunk_patches = 1024;
    o.gather_rays = 0;
    o.tolerance = 1e-4;
    if (s.closure) o.closure_iterations = s.closure;
    return o;
}

fs::path run(const Settings& s, const fs::path& input, const fs::path& folder, const std::string& name, std::uint64_t rays,
             bool importance, std::uint64_t seed) {
    BakeOptions o = options_of(s, input, folder, name);
    o.rays = rays;
    o.importance = importance;
    o.seed = seed;
    const BakeReport report = bake(o);
    fmt::print(stderr, "{}: {} patches, {:.0f} rays per patch, predicted error {:.4f}\n", name, report.patches,
               static_cast<double>(report.evidence_rays) / static_cast<double>(report.patches), report.standard_error.value_or(0));
    return o.work;
}

/// Green radiosity and what goes with it.
struct Patches {
    std::vector<double> area_m2, reflectance, emission;
};

Patches patches_of(const BakeOptions& o, const std::vector<double>& radiosity, const std::vector<double>& irradiance,
                   std::map<PatchId, std::size_t>& number) {
    BakeReport report;
    StageClock clock(o, report);
    const BakeFolder folder(o.work, o.output);
    const auto geometry = prepare_geometry(o, folder, clock, report);
    Patches p;
    for (const Patch& patch : geometry->patches.patches) {
        const std::size_t k = p.area_m2.size();
        number[patch.id] = k;
        p.area_m2.push_back(static_cast<double>(patch.area_m2));
        p.reflectance.push_back(static_cast<double>(patch.reflectance[1]));
        p.emission.push_back(radiosity[k] - p.reflectance[k] * irradiance[k]);
    }
    return p;
}

/// B of rows alone: F_ij = n_ij / N_i, iterated until nothing changes.
std::vector<double> rows_alone(const fs::path& work, const Patches& patches, const std::map<PatchId, std::size_t>& number) {
    struct Entry {
        std::uint32_t patch, target;
        double count;
    };
    std::vector<Entry> entries;
    std::vector<double> rays(patches.area_m2.size());
    for (const auto& entry : fs::directory_iterator(only(work, "evidence-"))) {
        const BlockFileReader file(entry.path(), FileKind::evidence, evidence_version);
        for (std::size_t k = 0; k < file.blocks().size(); ++k) {
            const EvidenceBlock block = decode_evidence(file.read(k), file.name());
            for (const auto& row : block.rows) {
                const auto patch = static_cast<std::uint32_t>(number.at(row.patch_id));
                rays[patch] += static_cast<double>(row.open) + static_cast<double>(row.back);
                for (std::uint32_t e = row.first; e < row.first + row.count; ++e) {
                    rays[patch] += block.counts[e];
                    entries.push_back({patch, static_cast<std::uint32_t>(number.at(block.targets[block.target_index[e]])),
                                       static_cast<double>(block.counts[e])});
                }
            }
        }
    }
    std::vector<double> b = patches.emission;
    for (int sweep = 0; sweep < 2000; ++sweep) {
        std::vector<double> next = patches.emission;
        for (const Entry& e : entries) next[e.patch] += patches.reflectance[e.patch] * e.count / rays[e.patch] * b[e.target];
        double change = 0, sum = 0;
        for (std::size_t p = 0; p < b.size(); ++p) change += std::abs(next[p] - b[p]), sum += next[p];
        b.swap(next);
        if (change < 1e-7 * sum) break;
    }
    return b;
}

std::vector<double> green(const std::vector<double>& all) {
    std::vector<double> values;
    for (std::size_t k = 1; k < all.size(); k += 3) values.push_back(all[k]);
    return values;
}

/// Area-weighted squared error of all patches, and of those that are darker than half of them.
struct Score {
    double square = 0, dim_square = 0, runs = 0;
    std::vector<double> sum;
    void add(const std::vector<double>& found, const std::vector<double>& truth, double middle, const Patches& p) {
        sum.resize(found.size());
        double error = 0, area = 0, dim_error = 0, dim_area = 0;
        for (std::size_t k = 0; k < found.size(); ++k) {
            const double of_patch = p.area_m2[k] * (found[k] - truth[k]) * (found[k] - truth[k]);
            error += of_patch, area += p.area_m2[k];
            if (truth[k] < middle) dim_error += of_patch, dim_area += p.area_m2[k];
            sum[k] += found[k];
        }
        square += error / area;
        dim_square += dim_error / dim_area;
        ++runs;
    }
    [[nodiscard]] double bias(const std::vector<double>& truth, const Patches& p) const {
        double difference = 0, total = 0;
        for (std::size_t k = 0; k < truth.size(); ++k) {
            difference += p.area_m2[k] * (sum[k] / runs - truth[k]);
            total += p.area_m2[k] * (truth[k] - p.emission[k]);
        }
        return difference / total;
    }
};

/// How errors compare with the standard error that was predicted for them.
struct Calibration {
    double inside = 0, count = 0, sum = 0, square = 0;
    void add(double z) {
        ++count;
        inside += std::abs(z) < 2 ? 1 : 0;
        sum += z;
        square += z * z;
    }
};

void compare(const Settings& s) {
    const fs::path folder = fs::temp_directory_path() / fmt::format("luxel_accuracy_{}", ::getpid());
    fs::create_directories(folder);
    const fs::path input = scene_file(s, folder);
    const fs::path reference = run(s, input, folder, "reference", s.reference, false, 12345);
    const std::vector<double> truth = green(column(only(reference, "solution-"), 0, FileKind::solution));
    std::map<PatchId, std::size_t> number;
    const Patches p = patches_of(options_of(s, input, folder, "reference"), truth,
                                 green(column(only(reference, "solution-"), 5, FileKind::solution)), number);
    Score rows, plain, importance;
    Calibration bright, dim;
    std::vector<double> sorted = truth;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
    const double middle = sorted[sorted.size() / 2];
    for (std::uint32_t seed = 1; seed <= s.seeds; ++seed) {
        const fs::path even = run(s, input, folder, "even", s.rays, false, seed), best = run(s, input, folder, "best", s.rays, true, seed);
        rows.add(rows_alone(even, p, number), truth, middle, p);
        plain.add(green(column(only(even, "solution-"), 0, FileKind::solution)), truth, middle, p);
        const auto found = green(column(only(best, "solution-"), 0, FileKind::solution));
        importance.add(found, truth, middle, p);
        const auto sigma = green(column(only(best, "accuracy-"), 0, FileKind::accuracy));
        for (std::size_t k = 0; k < found.size(); ++k) {
            if (sigma[k] <= 0) continue;
            (truth[k] < middle ? dim : bright).add((found[k] - truth[k]) / sigma[k]);
        }
        if (seed == s.seeds)
            for (const auto& [name, score] : {std::pair{"rows alone", &rows}, {"pooled, closed", &plain}, {"with importance", &importance}})
                fmt::print("{:<16} mse {:.3e}  {:6.1f} times better, {:6.1f} times in the dimmer half alone  bias {:+.3f} %\n", name,
                           score->square / score->runs, rows.square / score->square, rows.dim_square / score->dim_square,
                           100 * score->bias(truth, p));
        fs::remove_all(even);
        fs::remove_all(best);
    }
    for (const auto& [name, c] : {std::pair{"brighter", &bright}, {"dimmer", &dim}})
        fmt::print("{} half: within two sigma {:.1f} %, error / sigma: mean {:+.2f}, rms {:.2f} ({} patches)\n", name,
                   100 * c->inside / c->count, c->sum / c->count, std::sqrt(c->square / c->count), c->count);
    fs::remove_all(folder);
}

}  // namespace

int main(int argc, char** argv) {
    Settings s;
    CLI::App app("accuracy of the patches' light");
    app.add_option("--scene", s.scene);
    app.add_option("--rays", s.rays);
    app.add_option("--reference", s.reference);
    app.add_option("--seeds", s.seeds);
    app.add_option("--density", s.density);
    app.add_option("--patch-texels", s.patch_texels);
    app.add_option("--albedo", s.albedo);
    app.add_option("--closure", s.closure, "iterations");
    CLI11_PARSE(app, argc, argv);
    compare(s);
}
