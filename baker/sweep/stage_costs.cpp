#include "baker/sweep/stage_costs.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "formats/base/error.h"
#include "formats/base/file.h"

namespace luxel {
namespace {

constexpr const char* choice_stage = "importance";
constexpr const char* round_stage = "evidence";

/// Everything since the last round of rays.
std::vector<StageCost> since_round(const std::vector<StageCost>& stages) {
    const auto last = std::find_if(stages.rbegin(), stages.rend(), [](const StageCost& stage) { return stage.name == round_stage; });
    return {last.base(), stages.end()};
}

}  // namespace

std::vector<StageCost> StageCosts::whole(const BakeRun& run) {
    std::vector<StageCost> costs;
    std::set<std::string> own;
    for (const RunStage& stage : run.stages) {
        const auto is_own = [&](const auto& result) { return own.contains(result.first); };
        const bool from_before = stage.reused && !std::ranges::any_of(stage.kept, is_own);
        if (from_before) {
            const auto known = std::ranges::find_if(stage.kept, [&](const auto& result) { return made_.contains(result.first); });
            if (known == stage.kept.end())
                throw Error(ErrorCode::internal, "sweep", "stage \"" + stage.name + "\" was reused, but nobody knows what it took");
            const auto& made = made_.at(known->first);
            costs.insert(costs.end(), made.begin(), made.end());
        } else {
            costs.push_back({stage.name, stage.seconds, stage.peak_bytes, stage.processor_seconds});
        }
        for (const auto& [name, bytes] : stage.kept) {
            if (!stage.reused) made_[name] = stage.name == choice_stage ? since_round(costs) : std::vector{costs.back()};
            own.insert(name);
        }
    }
    return costs;
}

void StageCosts::save(const std::filesystem::path& path) const {
    auto json = nlohmann::json::object();
    for (const auto& [name, stages] : made_)
        for (const StageCost& stage : stages) json[name].push_back(nlohmann::json::array({stage.name, stage.seconds, stage.peak_bytes, stage.processor_seconds}));
    const std::string text = json.dump();
    publish_file(path, {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

StageCosts StageCosts::load(const std::filesystem::path& path) {
    const Bytes bytes = read_file(path);
    try {
        StageCosts costs;
        const auto json = nlohmann::json::parse(bytes.begin(), bytes.end());
        for (const auto& [name, stages] : json.items())
            for (const auto& stage : stages) costs.made_[name].push_back({stage.at(0).get<std::string>(), stage.at(1).get<double>(), stage.at(2).get<std::uint64_t>(), stage.at(3).get<double>()});
        return costs;
    } catch (const nlohmann::json::exception& error) {
        throw Error(ErrorCode::bad_input, path.string(), std::string("damaged: ") + error.what(), "remove the file and run the same command again");
    }
}

double total_seconds(const std::vector<StageCost>& stages) {
    double sum = 0;
    for (const StageCost& stage : stages) sum += stage.seconds;
    return sum;
}

double total_processor_seconds(const std::vector<StageCost>& stages) {
    double sum = 0;
    for (const StageCost& stage : stages) sum += stage.processor_seconds;
    return sum;
}

std::uint64_t highest_peak(const std::vector<StageCost>& stages) {
    std::uint64_t most = 0;
    for (const StageCost& stage : stages) most = std::max(most, stage.peak_bytes);
    return most;
}

}  // namespace luxel
