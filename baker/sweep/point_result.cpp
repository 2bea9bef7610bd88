#include "baker/sweep/point_result.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "formats/base/base64.h"
#include "formats/base/error.h"

namespace luxel {
namespace {

using Json = nlohmann::ordered_json;

/// -1 stands for what is not known.
Json known(double value) { return value < 0 ? Json() : Json(value); }
double value_of(const Json& json) { return json.is_null() ? -1 : json.get<double>(); }

Json error_json(const ErrorFigures& e) {
    return {{"relative_rmse", e.relative_rmse},
            {"channel_rmse", e.channel_rmse},
            {"bias", e.bias},
            {"median", e.median},
            {"p95", e.p95},
            {"worst", {{"error", e.worst.error}, {"page", e.worst.page}, {"x", e.worst.x}, {"y", e.worst.y}, {"lux", e.worst.lux}, {"reference_lux", e.worst.reference_lux}}},
            {"predicted", known(e.predicted)},
            {"reference_noise", e.noise},
            {"below_noise", e.is_below_noise},
            {"texels", e.texels},
            {"area_m2", e.area_m2},
            {"mean_lux", e.mean_lux}};
}

ErrorFigures parse_error(const Json& json) {
    ErrorFigures e;
    json.at("relative_rmse").get_to(e.relative_rmse);
    json.at("channel_rmse").get_to(e.channel_rmse);
    json.at("bias").get_to(e.bias);
    json.at("median").get_to(e.median);
    json.at("p95").get_to(e.p95);
    const Json& worst = json.at("worst");
    worst.at("error").get_to(e.worst.error);
    worst.at("page").get_to(e.worst.page);
    worst.at("x").get_to(e.worst.x);
    worst.at("y").get_to(e.worst.y);
    worst.at("lux").get_to(e.worst.lux);
    worst.at("reference_lux").get_to(e.worst.reference_lux);
    e.predicted = value_of(json.at("predicted"));
    json.at("reference_noise").get_to(e.noise);
    json.at("below_noise").get_to(e.is_below_noise);
    json.at("texels").get_to(e.texels);
    json.at("area_m2").get_to(e.area_m2);
    json.at("mean_lux").get_to(e.mean_lux);
    return e;
}

Json settings_json(const std::vector<BakeSetting>& settings) {
    Json json = Json::object();
    for (const BakeSetting& s : settings) json[s.option] = s.has_value ? Json(s.value) : Json(true);
    return json;
}

PointResult parse_result(const Json& json) {
    PointResult r;
    json.at("name").get_to(r.point.name);
    json.at("preset").get_to(r.point.is_preset);
    for (const auto& [option, value] : json.at("settings").items())
        r.point.settings.push_back(value.is_boolean() ? BakeSetting{option, "", false} : BakeSetting{option, value.get<std::string>()});
    json.at("bake").get_to(r.bake_line);
    json.at("seconds").get_to(r.seconds);
    json.at("repeat_seconds").get_to(r.repeat_seconds);
    json.at("processor_seconds").get_to(r.processor_seconds);
    for (const Json& stage : json.at("stages"))
        r.stages.push_back({stage.at("name").get<std::string>(), stage.at("seconds").get<double>(), stage.at("peak_bytes").get<std::uint64_t>(), stage.at("processor_seconds").get<double>()});
    json.at("peak_bytes").get_to(r.peak_bytes);
    json.at("disk_bytes").get_to(r.disk_bytes);
    json.at("model_bytes").get_to(r.model_bytes);
    json.at("texels").get_to(r.run.texels);
    json.at("patches").get_to(r.run.patches);
    json.at("evidence_rays").get_to(r.run.evidence_rays);
    json.at("rays_per_texel").get_to(r.run.rays_per_texel);
    r.run.patch_error = value_of(json.at("patch_error"));
    json.at("picture").at("median").get_to(r.run.picture_median);
    json.at("picture").at("p95").get_to(r.run.picture_p95);
    json.at("converged").get_to(r.run.is_whole);
    r.error = parse_error(json.at("error"));
    return r;
}

}  // namespace

nlohmann::ordered_json point_json(const PointResult& r) {
    Json json{{"name", r.point.name}, {"preset", r.point.is_preset}, {"settings", settings_json(r.point.settings)}, {"bake", r.bake_line}};
    if (r.failed) {
        json["failed"] = r.message;
        return json;
    }
    Json stages = Json::array();
    for (const StageCost& stage : r.stages) stages.push_back({{"name", stage.name}, {"seconds", stage.seconds}, {"peak_bytes", stage.peak_bytes}, {"processor_seconds", stage.processor_seconds}});
    json["seconds"] = r.seconds;
    json["repeat_seconds"] = r.repeat_seconds;
    json["processor_seconds"] = r.processor_seconds;
    json["stages"] = std::move(stages);
    json["peak_bytes"] = r.peak_bytes;
    json["disk_bytes"] = r.disk_bytes;
    json["model_bytes"] = r.model_bytes;
    json["texels"] = r.run.texels;
    json["patches"] = r.run.patches;
    json["evidence_rays"] = r.run.evidence_rays;
    json["rays_per_texel"] = r.run.rays_per_texel;
    json["patch_error"] = known(r.run.patch_error);
    json["picture"] = {{"median", r.run.picture_median}, {"p95", r.run.picture_p95}};
    json["converged"] = r.run.is_whole;
    json["error"] = error_json(r.error);
    return json;
}

std::string point_file(const PointResult& result) {
    Json json = point_json(result);
    json["error_map"] = encode_base64(result.error_map_png);
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

PointResult parse_point_file(ByteView bytes, const std::string& where) {
    try {
        const Json json = Json::parse(bytes.begin(), bytes.end());
        PointResult result = parse_result(json);
        auto picture = decode_base64(json.at("error_map").get<std::string>());
        if (!picture) throw Error(ErrorCode::bad_input, where, "\"error_map\" is not base64", "remove the file and run the same command again");
        result.error_map_png = std::move(*picture);
        return result;
    } catch (const nlohmann::json::exception& error) {
        throw Error(ErrorCode::bad_input, where, std::string("damaged: ") + error.what(), "remove the file and run the same command again");
    }
}

double median_of(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
}

std::vector<StageCost> median_stages(const std::vector<std::vector<StageCost>>& runs) {
    std::vector<StageCost> result;
    for (const StageCost& first : runs.front())
        if (std::ranges::find(result, first.name, &StageCost::name) == result.end()) result.push_back({first.name});
    for (StageCost& stage : result) {
        std::vector<double> seconds, processor_seconds;
        for (const auto& run : runs) {
            double sum = 0, processor_sum = 0;
            for (const StageCost& cost : run)
                if (cost.name == stage.name)
                    sum += cost.seconds, processor_sum += cost.processor_seconds, stage.peak_bytes = std::max(stage.peak_bytes, cost.peak_bytes);
            seconds.push_back(sum);
            processor_seconds.push_back(processor_sum);
        }
        stage.seconds = median_of(seconds);
        stage.processor_seconds = median_of(processor_seconds);
    }
    return result;
}

}  // namespace luxel
