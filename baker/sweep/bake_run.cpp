#include "baker/sweep/bake_run.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"

namespace luxel {

BakeRun parse_bake_run(ByteView report, const std::string& where) {
    try {
        const auto json = nlohmann::json::parse(report.begin(), report.end());
        BakeRun run;
        RunFigures& figures = run.figures;
        for (const auto& stage : json.at("stages")) {
            RunStage& entry = run.stages.emplace_back(RunStage{stage.at("name").get<std::string>(), stage.at("seconds").get<double>(), stage.at("peak_bytes").get<std::uint64_t>(), stage.at("reused").get<bool>(), {}, stage.at("processor_seconds").get<double>()});
            for (const auto& result : stage.at("kept")) entry.kept[result.at("name").get<std::string>()] = result.at("bytes").get<std::uint64_t>();
        }
        const auto &counts = json.at("counts"), &evidence = json.at("evidence");
        counts.at("pages").get_to(run.pages);
        counts.at("texels").get_to(figures.texels);
        counts.at("patches").get_to(figures.patches);
        evidence.at("rays").get_to(figures.evidence_rays);
        if (const auto& error = evidence.at("standard_error"); !error.is_null()) error.get_to(figures.patch_error);
        if (json.contains("gathering")) json.at("gathering").at("rays_per_texel").get_to(figures.rays_per_texel);
        figures.is_whole = json.at("stopped").is_null() && json.at("solve").at("converged").get<bool>();
        for (const auto& output : json.at("outputs"))
            if (output.contains("error")) {
                figures.picture_median = std::max(figures.picture_median, output.at("error").at("median").get<double>());
                figures.picture_p95 = std::max(figures.picture_p95, output.at("error").at("p95").get<double>());
            }
        return run;
    } catch (const nlohmann::json::exception& error) {
        throw Error(ErrorCode::bad_input, where, std::string("not a report of this version of luxel: ") + error.what(), "run the same command again");
    }
}

std::uint64_t disk_bytes(const BakeRun& run) {
    std::map<std::string, std::uint64_t> kept;
    for (const RunStage& stage : run.stages)
        for (const auto& [name, bytes] : stage.kept) kept[name] = bytes;
    std::uint64_t sum = 0;
    for (const auto& [name, bytes] : kept) sum += bytes;
    return sum;
}

}  // namespace luxel
