#include "tools/luxel/report_json.h"

#include <nlohmann/json.hpp>

#include "tools/luxel/inspect_text.h"

namespace luxel {

std::string report_json(const BakeReport& r) {
    using json = nlohmann::ordered_json;
    json out;
    out["schema"] = 1;
    json& settings = out["settings"] = json::object();
    for (const auto& [name, value] : r.settings) settings[name] = value;
    out["counts"] = {{"triangles", r.triangles}, {"charts", r.charts},   {"pages", r.pages},   {"texels", r.texels},
                     {"patches", r.patches},     {"chunks", r.chunks},   {"blocks", r.blocks}, {"pairs", r.pairs}};
    out["atlas"] = {{"texels_per_metre", r.texels_per_metre}};
    out["store"] = {{"kind", r.store},
                    {"bytes", r.store_bytes},
                    {"bytes_per_pair", r.pairs ? static_cast<double>(r.store_bytes) / static_cast<double>(r.pairs) : 0}};
    out["evidence"] = {
        {"rays", r.evidence_rays},
        {"rays_traced", r.rays_traced},
        {"rays_per_second", r.evidence_seconds > 0 ? static_cast<double>(r.evidence_rays) / r.evidence_seconds : 0},
        {"rounds", r.evidence_rounds},
        {"least_rays", r.least_rays},
        {"most_rays", r.most_rays},
        {"standard_error", r.standard_error ? json(*r.standard_error) : json()}};
    out["closure"] = {{"iterations", r.closure.iterations},
                      {"max_row_error_before", r.closure.max_row_error_before},
                      {"mean_row_error_before", r.closure.mean_row_error_before},
                      {"max_row_error_after", r.closure.max_row_error_after},
                      {"mean_row_error_after", r.closure.mean_row_error_after},
                      {"diagonal_share", r.closure.diagonal_share},
                      {"remainder_share", r.closure.remainder_share},
                      {"short_rows", r.closure.short_rows},
                      {"short_share", r.closure.short_share},
                      {"largest_change", r.closure.largest_change},
                      {"mean_change", r.closure.mean_change}};
    json history = json::array();
    for (const auto& [bytes, bound] : r.history) history.push_back({{"bytes_read", bytes}, {"error_bound", bound}});
    out["solve"] = {{"solver", r.solver},
                    {"reads", r.reads},
                    {"error_bound", r.error_bound},
                    {"converged", r.converged},
                    {"path", r.solve_path},
                    {"path_why", r.solve_path_why},
                    {"checkpoint_resumed", r.checkpoint_resumed},
                    {"history", history}};
    if (r.gathering)
        out["gathering"] = {{"rays_per_texel", r.gathering->rays_per_texel},
                            {"median_error", r.gathering->median_error},
                            {"p95_error", r.gathering->p95_error}};
    out["dark_fronts"] = {{"charts", r.dark_fronts.charts}, {"area_m2", r.dark_fronts.area_m2}, {"area_share", r.dark_fronts.area_share}, {"turned", r.dark_fronts.turned}};
    out["seams"] = {{"joined", r.seams.joined},
                    {"stretches", r.seams.seams},
                    {"length_m", r.seams.length_m},
                    {"points", r.seams.points},
                    {"left_out", {{"blocked", r.seams.blocked}, {"hidden", r.seams.hidden}, {"crowded", r.seams.crowded}}},
                    {"texels", r.seams.texels},
                    {"jump_before", r.seams.jump_before},
                    {"jump_after", r.seams.jump_after}};
    if (r.unlit) out["unlit"] = {{"exposure", r.unlit->exposure}, {"white_nits", 1 / r.unlit->exposure}, {"cut_share", r.unlit->cut_share}};
    out["stopped"] = r.stopped ? json(r.stopped->where) : json();
    out["previews"] = {{"written", r.previews}, {"seconds", r.preview_seconds}};
    out["energy"] = {{"unit", "lm"}, {"emitted", r.emitted_lm}, {"absorbed", r.absorbed_lm}, {"lost", r.lost_lm}};
    json& stages = out["stages"] = json::array();
    for (const StageReport& s : r.stages) {
        json kept = json::array();
        for (const KeptResult& result : s.kept) kept.push_back({{"name", result.name}, {"bytes", result.bytes}});
        stages.push_back({{"name", s.name}, {"seconds", s.seconds}, {"processor_seconds", s.processor_seconds}, {"peak_bytes", s.peak_bytes}, {"reused", s.reused}, {"kept", kept}});
    }
    out["memory"] = {{"budget_bytes", r.budget_bytes},
                     {"peak_bytes", r.peak_bytes},
                     {"geometry_bytes", r.geometry_bytes},
                     {"floor_bytes", r.floor_bytes}};
    if (r.verification) out["verify"] = verify_json(*r.verification);
    json& warnings = out["warnings"] = json::array();
    for (const Warning& w : r.warnings) warnings.push_back({{"code", w.code}, {"where", w.where}, {"text", w.text}});
    json& skipped = out["skipped"] = json::array();
    for (const auto& [part, why] : r.skipped) skipped.push_back({{"part", part}, {"why", why}});
    json& outputs = out["outputs"] = json::array();
    for (const OutputReport& o : r.outputs) {
        outputs.push_back({{"path", o.path}, {"kind", o.kind}, {"quantity", o.quantity}, {"unit", o.unit},
                           {"encoding", o.encoding}, {"intensity", o.intensity}});
        if (o.error) outputs.back()["error"] = {{"median", o.error->median}, {"p95", o.error->p95}, {"largest", o.error->largest}};
    }
    return out.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace luxel
