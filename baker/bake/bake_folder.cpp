#include "baker/bake/bake_folder.h"

#include <stdlib.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "formats/base/file.h"

namespace luxel {

BakeFolder::BakeFolder(const std::filesystem::path& work, const std::filesystem::path& output) : root_(work) {
    if (!work.empty()) {
        make_folder(root_);
        remove_leftovers(root_);
        std::error_code ignored;
        for (const auto& entry : std::filesystem::directory_iterator(root_, ignored))
            if (stage_of(entry.path()) && entry.is_directory(ignored)) remove_leftovers(entry.path());
        return;
    }
    std::string name = output.string() + ".luxel-XXXXXX";
    if (!::mkdtemp(name.data()))
        throw Error(ErrorCode::cannot_write, output.string(),
                    std::string("cannot make a temporary folder beside the output: ") + std::strerror(errno),
                    "check that the output's folder exists and can be written, or name a bake folder with --work");
    root_ = name;
    temporary_ = true;
}

BakeFolder::~BakeFolder() {
    std::error_code ignored;
    if (temporary_) std::filesystem::remove_all(root_, ignored);
}

std::filesystem::path BakeFolder::atlas(const Key& key) const { return root_ / ("atlas-" + key.text() + ".lxa"); }
std::filesystem::path BakeFolder::directory(const Key& strips) const { return root_ / ("directory-" + strips.text() + ".lxd"); }
std::filesystem::path BakeFolder::patches(const Key& strips) const { return root_ / ("patches-" + strips.text() + ".lxp"); }
std::filesystem::path BakeFolder::plan(const Key& key) const { return root_ / ("plan-" + key.text() + ".lxl"); }
std::filesystem::path BakeFolder::accuracy(const Key& key) const { return root_ / ("accuracy-" + key.text() + ".lxv"); }
std::filesystem::path BakeFolder::closure(const Key& key) const { return root_ / ("closure-" + key.text() + ".lxc"); }
std::filesystem::path BakeFolder::sky_view(const Key& key) const { return root_ / ("sky-" + key.text() + ".lxy"); }
std::filesystem::path BakeFolder::solution(const Key& key) const { return root_ / ("solution-" + key.text() + ".lxr"); }
std::filesystem::path BakeFolder::checkpoint(const Key& solution) const { return root_ / ("checkpoint-" + solution.text() + ".lxk"); }

std::filesystem::path BakeFolder::evidence(const Key& key) const {
    const auto folder = root_ / ("evidence-" + key.text());
    make_folder(folder);
    return folder;
}
std::filesystem::path BakeFolder::strips(const Key& key) const {
    const auto folder = root_ / ("strips-" + key.text());
    make_folder(folder);
    return folder;
}
std::filesystem::path BakeFolder::hot(const Key& strips) const {
    const auto folder = root_ / ("hot-" + hot_key(strips).text());
    make_folder(folder);
    return folder;
}
std::filesystem::path BakeFolder::lightmaps(const Key& key) const {
    const auto folder = root_ / ("lightmaps-" + key.text());
    make_folder(folder);
    return folder;
}

std::uint64_t BakeFolder::bytes_of(const std::string& name) const {
    std::error_code ignored;
    const auto path = root_ / name;
    std::uint64_t bytes = 0;
    const auto add = [&](const std::filesystem::path& file) {
        const auto size = std::filesystem::file_size(file, ignored);
        if (!ignored) bytes += size;
    };
    if (!std::filesystem::is_directory(path, ignored)) add(path);
    else
        for (const auto& entry : std::filesystem::directory_iterator(path, ignored)) add(entry.path());
    return bytes;
}

Key BakeFolder::hot_key(const Key& strips) { return KeyBuilder("hot 1").key(strips).finish(); }

void BakeFolder::discard(const Key& strips, const Key& closure_key) const {
    std::error_code ignored;
    std::filesystem::remove(patches(strips), ignored);
    discard_strips(strips);
    discard_directory(strips);
    std::filesystem::remove(closure(closure_key), ignored);
}

void BakeFolder::discard_solution(const Key& key) const {
    std::error_code ignored;
    std::filesystem::remove(solution(key), ignored);
    discard_checkpoint(key);
}

void BakeFolder::discard_checkpoint(const Key& solution) const {
    std::error_code ignored;
    std::filesystem::remove(checkpoint(solution), ignored);
}

void BakeFolder::discard_strips(const Key& strips) const {
    std::error_code ignored;
    std::filesystem::remove_all(root_ / ("strips-" + strips.text()), ignored);
}

void BakeFolder::discard_evidence(const Key& evidence) const {
    std::error_code ignored;
    std::filesystem::remove_all(root_ / ("evidence-" + evidence.text()), ignored);
}

void BakeFolder::discard_hot(const Key& strips) const {
    std::error_code ignored;
    std::filesystem::remove_all(root_ / ("hot-" + hot_key(strips).text()), ignored);
}

void BakeFolder::discard_directory(const Key& strips) const {
    std::error_code ignored;
    std::filesystem::remove(directory(strips), ignored);
    discard_hot(strips);
}

std::optional<BakeFolder::StageName> BakeFolder::stage_of(const std::filesystem::path& name) {
    static constexpr std::array<std::pair<const char*, const char*>, 13> stages{
        {{"atlas", ".lxa"}, {"evidence", ""}, {"strips", ""}, {"directory", ".lxd"}, {"hot", ""}, {"patches", ".lxp"}, {"plan", ".lxl"}, {"closure", ".lxc"}, {"sky", ".lxy"},
         {"solution", ".lxr"}, {"checkpoint", ".lxk"}, {"accuracy", ".lxv"}, {"lightmaps", ""}}};
    const std::string text = name.filename().string();
    for (const auto& [stage, ending] : stages) {
        const std::string prefix = std::string(stage) + "-";
        if (!text.starts_with(prefix) || text.size() != prefix.size() + 32 + std::strlen(ending) ||
            !text.ends_with(ending))
            continue;
        if (const auto key = parse_key(text.substr(prefix.size(), 32))) return StageName{stage, *key};
    }
    return {};
}

std::filesystem::path BakeFolder::evidence_file(const std::filesystem::path& folder, std::uint32_t chunk) {
    return folder / ("chunk-" + std::to_string(chunk) + ".lxe");
}
std::filesystem::path BakeFolder::lightmap_file(const std::filesystem::path& folder, std::uint32_t page) {
    return folder / ("page-" + std::to_string(page) + ".lxp");
}

}  // namespace luxel
