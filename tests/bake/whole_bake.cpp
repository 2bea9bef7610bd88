#include "tests/bake/whole_bake.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>

#include "baker/bake/bake_folder.h"
#include "baker/bake/stage_files.h"
#include "formats/base/file.h"
#include "formats/image/image_file.h"

namespace luxel::test {
namespace {

std::filesystem::path environment_folder(const char* name, const char* otherwise) {
    const char* value = std::getenv(name);
    return value ? value : otherwise;
}

}  // namespace

std::filesystem::path source_folder() { return environment_folder("LUXEL_SOURCE_DIR", LUXEL_TEST_SOURCE_DIR); }

std::filesystem::path luxel_program() {
    return environment_folder("LUXEL_BINARY_DIR", LUXEL_TEST_BINARY_DIR) / "tools/luxel/luxel";
}

std::filesystem::path sample(const std::string& name) { return source_folder() / "samples" / name / (name + ".gltf"); }

std::filesystem::path edited_sample(const std::string& name, const std::filesystem::path& folder,
                                    const std::function<void(nlohmann::json&)>& edit) {
    nlohmann::json document = nlohmann::json::parse(std::ifstream(sample(name)));
    edit(document);
    std::filesystem::create_directories(folder);
    const std::string buffer = name + ".bin";
    std::filesystem::copy_file(sample(name).parent_path() / buffer, folder / buffer,
                               std::filesystem::copy_options::overwrite_existing);
    const auto path = folder / (name + ".gltf");
    std::ofstream(path) << document.dump();
    return path;
}

BakeOptions small_options(const std::filesystem::path& input, const std::filesystem::path& output) {
    BakeOptions options;
    options.input = input;
    options.output = output;
    options.unwrap.texels_per_metre = 4;
    options.unwrap.page_size = 64;
    options.patch_texels = 2;
    options.chunk_patches = 64;
    options.rays = 256;
    options.gather_rays = 16;
    options.threads = 2;
    return options;
}

FileBytes files_below(const std::filesystem::path& folder) {
    FileBytes files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const std::string name = std::filesystem::relative(entry.path(), folder).string();
        if (!entry.is_regular_file() || name.find(".tmp-") != std::string::npos) continue;
        std::ifstream file(entry.path(), std::ios::binary);
        files[name] = std::string(std::istreambuf_iterator<char>(file), {});
    }
    return files;
}

std::string differences(const FileBytes& expected, const FileBytes& found) {
    std::string text;
    for (const auto& [name, bytes] : expected) {
        const auto other = found.find(name);
        if (other == found.end()) text += name + " is missing\n";
        else if (other->second != bytes) text += name + " differs\n";
    }
    for (const auto& [name, bytes] : found)
        if (!expected.contains(name)) text += name + " was not expected\n";
    return text;
}

FileBytes FinishedBake::files(const std::string& stem) const {
    FileBytes found;
    for (const auto& [name, bytes] : stored)
        if (name.starts_with(stem)) found[name] = bytes;
    return found;
}

FinishedBake bake_in(const std::filesystem::path& folder, BakeOptions options) {
    options.output = folder / "out" / "scene.glb";
    options.work = folder / "work";
    FinishedBake result;
    result.report = bake(options);
    result.outputs = files_below(folder / "out");
    result.stored = files_below(options.work);
    return result;
}

Key key_in_name(const std::string& name) {
    std::smatch digits;
    if (!std::regex_search(name, digits, std::regex("-([0-9a-f]{16})([0-9a-f]{16})")))
        throw std::runtime_error(name + ": no key in this name");
    Key key;
    key.high = std::stoull(digits[1], nullptr, 16);
    key.low = std::stoull(digits[2], nullptr, 16);
    return key;
}

std::filesystem::path stored_file(const std::filesystem::path& work, const std::string& stem) {
    std::filesystem::path found;
    for (const auto& entry : std::filesystem::directory_iterator(work)) {
        const std::string name = entry.path().filename().string();
        if (name.rfind(stem, 0) != 0 || name.find(".tmp-") != std::string::npos) continue;
        if (!found.empty()) throw std::runtime_error("more than one " + stem + " in " + work.string());
        found = entry.path();
    }
    if (found.empty()) throw std::runtime_error("no " + stem + " in " + work.string());
    return found;
}

SolveResult stored_solution(const std::filesystem::path& work, std::size_t patch_count) {
    const auto path = stored_file(work, "solution-");
    auto solution = load_solution(path, key_in_name(path.filename().string()), patch_count);
    if (!solution) throw std::runtime_error(path.string() + " is gone");
    return std::move(*solution);
}

std::vector<PagePixels> lightmap_pages(const BakeReport& report) {
    std::vector<PagePixels> pages;
    for (const OutputReport& output : report.outputs) {
        if (!output.path.ends_with(".exr")) continue;
        ImagePixels image = decode_image(read_file(output.path), output.path);
        pages.push_back({image.width, image.height, std::move(image.pixels)});
    }
    return pages;
}

std::vector<float> stored_irradiance(const std::filesystem::path& work) {
    const auto folder = stored_file(work, "lightmaps-");
    std::vector<float> values;
    for (std::uint32_t page = 0;; ++page) {
        const auto path = BakeFolder::lightmap_file(folder, page);
        if (!std::filesystem::exists(path)) return values;
        const BlockFileReader file(path, FileKind::lightmap, 2);
        std::vector<float> sum = read_column<float>(file, 0);
        const auto indirect = read_column<float>(file, 1);
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += indirect.at(k);
        values.insert(values.end(), sum.begin(), sum.end());
    }
}

double energy_imbalance(const BakeReport& report) {
    double worst = 0;
    for (std::size_t c = 0; c < 3; ++c)
        if (report.emitted_lm[c] > 0)
            worst = std::max(worst, std::fabs(report.emitted_lm[c] - report.absorbed_lm[c] - report.lost_lm[c]) /
                                        report.emitted_lm[c]);
    return worst;
}

std::uint64_t smallest_memory(BakeOptions options) {
    options.memory_bytes = 1;
    try {
        bake(options);
    } catch (const Error& error) {
        std::smatch megabytes;
        if (error.code == ErrorCode::budget_too_small &&
            std::regex_search(error.hint, megabytes, std::regex("--memory ([0-9]+)M")))
            return std::stoull(megabytes[1]) << 20;
        throw;
    }
    throw std::runtime_error("a budget of one byte was accepted");
}

}  // namespace luxel::test
