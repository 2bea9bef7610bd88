#include "baker/sweep/work_folder.h"

#include "formats/base/error.h"
#include "formats/base/file.h"

namespace luxel {
namespace {

std::filesystem::path beside(const std::filesystem::path& folder, const char* ending) { return folder.parent_path() / (folder.filename().string() + ending); }

/// What stayed would be taken for whole.
void remove_whole(const std::filesystem::path& path) {
    std::error_code failed;
    std::filesystem::remove_all(path, failed);
    if (failed) throw Error(ErrorCode::cannot_write, path.string(), "cannot be removed: " + failed.message(), "remove it and run the same command again");
}

}  // namespace

WorkFolder::WorkFolder(std::filesystem::path folder) : folder_(std::move(folder)), mark_(beside(folder_, ".busy")), costs_path_(beside(folder_, ".costs.json")) {
    if (std::filesystem::exists(mark_) || !std::filesystem::exists(costs_path_)) {
        remove_whole(folder_);
        remove_whole(costs_path_);
    } else {
        costs_ = StageCosts::load(costs_path_);
    }
    make_folder(folder_);
    publish_file(mark_, {});
}

std::vector<StageCost> WorkFolder::whole(const BakeRun& run) {
    std::vector<StageCost> costs = costs_.whole(run);
    costs_.save(costs_path_);
    remove_whole(mark_);
    return costs;
}

}  // namespace luxel
