#include "baker/sweep/sweep_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

namespace luxel {
namespace {

std::vector<bool> on_front(const std::vector<PointResult>& points, const std::function<double(const PointResult&)>& cost) {
    std::vector<std::size_t> measured;
    std::vector<CostAndError> values;
    for (std::size_t k = 0; k < points.size(); ++k)
        if (!points[k].failed) measured.push_back(k), values.push_back({cost(points[k]), points[k].error.relative_rmse});
    std::vector<bool> flags(points.size());
    for (const std::size_t k : pareto_front(values)) flags[measured[k]] = true;
    return flags;
}

/// Shortest text that reads back as the same number.
std::string number(double value) { return fmt::format("{}", value); }

std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char letter : text) quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
    return quoted + "\"";
}

/// Every stage of any point, by first appearance.
std::vector<std::string> stage_names(const std::vector<PointResult>& points) {
    std::vector<std::string> names;
    for (const PointResult& point : points)
        for (const StageCost& stage : point.stages)
            if (std::ranges::find(names, stage.name) == names.end()) names.push_back(stage.name);
    return names;
}

std::vector<std::string> measured_fields(const PointResult& r, bool is_on_front) {
    const ErrorFigures& e = r.error;
    const auto known = [](double value) { return value < 0 ? std::string() : number(value); };
    return {is_on_front ? "1" : "0", number(r.seconds), number(r.processor_seconds), std::to_string(r.peak_bytes), std::to_string(r.disk_bytes), std::to_string(r.model_bytes),
            std::to_string(r.run.texels), std::to_string(r.run.patches), std::to_string(r.run.evidence_rays), number(r.run.rays_per_texel), r.run.is_whole ? "1" : "0",
            number(e.relative_rmse), number(e.channel_rmse[0]), number(e.channel_rmse[1]), number(e.channel_rmse[2]), number(e.bias), number(e.median), number(e.p95),
            number(e.worst.error), std::to_string(e.worst.page), std::to_string(e.worst.x), std::to_string(e.worst.y), number(e.worst.lux), number(e.worst.reference_lux),
            known(e.predicted), known(r.run.patch_error), number(e.noise), e.is_below_noise ? "1" : "0", number(r.run.picture_median), number(r.run.picture_p95)};
}

constexpr const char* measured_names =
    "on_front,seconds,processor_seconds,peak_bytes,disk_bytes,model_bytes,texels,patches,evidence_rays,rays_per_texel,converged,relative_rmse,rmse_r,rmse_g,rmse_b,bias,median,p95,"
    "worst,worst_page,worst_x,worst_y,worst_lux,worst_reference_lux,predicted,patch_error,reference_noise,below_noise,picture_median,picture_p95";

nlohmann::ordered_json targets_json(const SweepTargets& targets) {
    auto json = nlohmann::ordered_json::object();
    if (targets.error) json["error"] = *targets.error;
    if (targets.seconds) json["seconds"] = *targets.seconds;
    if (targets.disk_bytes) json["disk_bytes"] = *targets.disk_bytes;
    return json;
}

}  // namespace

Fronts find_fronts(const std::vector<PointResult>& points) {
    return {on_front(points, [](const PointResult& p) { return p.seconds; }), on_front(points, [](const PointResult& p) { return static_cast<double>(p.peak_bytes); }),
            on_front(points, [](const PointResult& p) { return static_cast<double>(p.disk_bytes); })};
}

std::string sweep_csv(const SweepResult& result) {
    const std::vector<bool> front = find_fronts(result.points).seconds;
    const std::vector<std::string> stages = stage_names(result.points);
    const std::string names = measured_names;
    std::string csv = "name,preset,settings,failed," + names;
    for (const std::string& stage : stages) csv.append(",seconds_").append(csv_field(stage));
    csv += ",bake\r\n";
    for (std::size_t k = 0; k < result.points.size(); ++k) {
        const PointResult& r = result.points[k];
        csv += csv_field(r.point.name) + (r.point.is_preset ? ",1," : ",0,") + csv_field(settings_text(r.point.settings)) + "," + csv_field(r.message);
        if (r.failed) csv += std::string(static_cast<std::size_t>(std::ranges::count(names, ',')) + 1 + stages.size(), ',');
        else {
            for (const std::string& field : measured_fields(r, front[k])) csv.append(",").append(field);
            for (const std::string& name : stages) {
                const auto stage = std::ranges::find(r.stages, name, &StageCost::name);
                csv.append(",").append(stage == r.stages.end() ? std::string() : number(stage->seconds));
            }
        }
        csv.append(",").append(csv_field(r.bake_line)).append("\r\n");
    }
    return csv;
}

std::string sweep_json(const SweepResult& result, const SweepSummary& summary) {
    using Json = nlohmann::ordered_json;
    const Fronts fronts = find_fronts(result.points);
    Json json{{"schema", 1}, {"software", summary.software}, {"scene", summary.scene}, {"reference", result.reference}, {"interrupted", result.interrupted}};
    json["common"] = Json::object();
    for (const auto& [name, value] : summary.common) json["common"][name] = value;
    json["targets"] = targets_json(summary.targets);
    json["chosen"] = summary.chosen ? Json(summary.chosen->point.name) : Json();
    json["points"] = Json::array();
    for (std::size_t k = 0; k < result.points.size(); ++k) {
        Json point = point_json(result.points[k]);
        if (!result.points[k].failed)
            point["on_front"] = {{"seconds", static_cast<bool>(fronts.seconds[k])}, {"memory", static_cast<bool>(fronts.memory[k])}, {"disk", static_cast<bool>(fronts.disk[k])}};
        json["points"].push_back(std::move(point));
    }
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace luxel
