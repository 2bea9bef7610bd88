#include "baker/bake/folder_listing.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "formats/base/error.h"
#include "formats/base/file.h"

namespace luxel {
namespace {

/// Names of the files in a stage's folder: "chunk-<n>.lxe" and so on.
struct Numbered {
    std::string_view stage, prefix, ending;
};
constexpr std::array<Numbered, 4> numbered{
    {{"evidence", "chunk-", ".lxe"}, {"strips", "strip-", ".lxs"}, {"hot", "strip-", ".lxs"}, {"lightmaps", "page-", ".lxp"}}};

std::optional<std::uint64_t> number_of(const std::string& name, const std::string& stage) {
    for (const Numbered& n : numbered) {
        if (n.stage != stage || !name.starts_with(n.prefix) || !name.ends_with(n.ending)) continue;
        if (name.size() <= n.prefix.size() + n.ending.size()) return {};
        const std::string digits = name.substr(n.prefix.size(), name.size() - n.prefix.size() - n.ending.size());
        if (digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos) return {};
        if (digits.size() > 1 && digits[0] == '0') return {};
        return std::stoull(digits);
    }
    return {};
}

std::uint64_t bytes_of(const std::filesystem::path& path) {
    std::error_code failed;
    const auto bytes = std::filesystem::file_size(path, failed);
    return failed ? 0 : bytes;
}

void list_files(StageEntry& entry) {
    std::vector<std::pair<std::uint64_t, std::filesystem::path>> files;
    std::error_code failed;
    for (const auto& file : std::filesystem::directory_iterator(entry.path, failed)) {
        const auto number = number_of(file.path().filename().string(), entry.stage);
        if (number && file.is_regular_file(failed))
            files.emplace_back(*number, file.path());
        else if (is_temporary(file.path()))
            entry.temporary.push_back(file.path());
        else
            entry.foreign.push_back(file.path());
    }
    std::sort(files.begin(), files.end());
    std::sort(entry.foreign.begin(), entry.foreign.end());
    std::sort(entry.temporary.begin(), entry.temporary.end());
    for (auto& [number, path] : files) {
        entry.bytes += bytes_of(path);
        entry.files.push_back(std::move(path));
    }
}

bool is_folder_stage(const std::string& stage) {
    return std::any_of(numbered.begin(), numbered.end(), [&](const Numbered& n) { return n.stage == stage; });
}

[[noreturn]] void refuse(const std::filesystem::path& root, const std::string& what) {
    throw Error(ErrorCode::bad_input, root.string(), what, "name the folder that was given to luxel bake --work");
}

void sort_bakes(FolderListing& listing) {
    std::vector<std::pair<std::filesystem::file_time_type, Key>> bakes;
    for (const StageEntry& entry : listing.entries) {
        if (entry.stage != "patches") continue;
        std::error_code failed;
        bakes.emplace_back(std::filesystem::last_write_time(entry.path, failed), entry.key);
    }
    std::sort(bakes.begin(), bakes.end(), [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first > b.first : a.second.text() < b.second.text();
    });
    for (const auto& [time, key] : bakes) listing.bakes.push_back(key);
}

}  // namespace

const StageEntry* FolderListing::find(const std::string& stage, const Key& key) const {
    for (const StageEntry& entry : entries)
        if (entry.stage == stage && entry.key == key) return &entry;
    return nullptr;
}

FolderListing list_folder(const std::filesystem::path& root) {
    std::error_code failed;
    if (!std::filesystem::exists(root, failed)) refuse(root, "no such folder");
    if (!std::filesystem::is_directory(root, failed)) refuse(root, "expected a bake folder, found a file");
    FolderListing listing;
    listing.root = root;
    auto at = std::filesystem::directory_iterator(root, failed);
    if (failed) refuse(root, "cannot be read: " + failed.message());
    for (const auto& item : at) {
        const auto name = BakeFolder::stage_of(item.path());
        std::error_code ignored;
        if (!name || item.is_directory(ignored) != is_folder_stage(name->stage)) {
            (is_temporary(item.path()) ? listing.temporary : listing.foreign).push_back(item.path());
            continue;
        }
        StageEntry entry{name->stage, name->key, item.path(), {}, {}, {}, 0};
        if (is_folder_stage(entry.stage)) {
            list_files(entry);
        } else {
            entry.files.push_back(entry.path);
            entry.bytes = bytes_of(entry.path);
        }
        listing.entries.push_back(std::move(entry));
    }
    if (listing.entries.empty()) refuse(root, "nothing of a bake is in this folder");
    std::sort(listing.entries.begin(), listing.entries.end(), [](const StageEntry& a, const StageEntry& b) {
        return std::pair(a.stage, a.key.text()) < std::pair(b.stage, b.key.text());
    });
    std::sort(listing.foreign.begin(), listing.foreign.end());
    std::sort(listing.temporary.begin(), listing.temporary.end());
    sort_bakes(listing);
    return listing;
}

Key choose_bake(const FolderListing& listing, const std::string& prefix) {
    if (listing.bakes.empty())
        throw Error(ErrorCode::bad_input, listing.root.string(), "no finished matrix (no file patches-<key>.lxp)",
                    "the bake was stopped before its rays were pooled; run it again to the end");
    std::vector<Key> fitting;
    for (const Key& key : listing.bakes)
        if (key.text().starts_with(prefix)) fitting.push_back(key);
    if (fitting.empty())
        throw Error(ErrorCode::bad_input, listing.root.string(), "no bake with a key that begins with " + prefix,
                    "luxel inspect without --key lists them");
    if (!prefix.empty() && fitting.size() > 1)
        throw Error(ErrorCode::bad_input, listing.root.string(), std::to_string(fitting.size()) + " bakes have a key that begins with " + prefix,
                    "give more digits");
    return fitting.front();
}

}  // namespace luxel
