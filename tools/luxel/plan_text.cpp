#include "tools/luxel/plan_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/luxel/printable.h"

namespace luxel {

std::string plan_text(const PlanReport& plan) {
    std::string text = fmt::format("{} triangles in {} charts, {} texels at {:.4g} per metre on {} page{}, {} patches in {} chunk{}; geometry takes {} MB, and --memory {}M or more is needed beside it\n\n", plan.triangles,
                                   plan.charts, plan.texels, plan.texels_per_metre, plan.pages, plan.pages == 1 ? "" : "s", plan.patches, plan.chunks,
                                   plan.chunks == 1 ? "" : "s", plan.geometry_bytes >> 20, (plan.floor_bytes + (1 << 20) - 1) >> 20);
    for (const Decision& decision : plan.decisions) text += fmt::format("  {:<4} {:<16} {}\n", decision.runs ? "runs" : "skip", decision.part, printable(decision.why));
    text += plan.findings.empty() ? "\nnothing found that should be mended\n" : "\n";
    for (const SceneFinding& finding : plan.findings) {
        text += fmt::format("{} [{}]\n", finding.text, finding.code);
        for (const std::string& where : finding.where) text += fmt::format("    {}\n", printable(where));
        if (finding.count > finding.where.size() && !finding.where.empty()) text += fmt::format("    and more, {} in all\n", finding.count);
    }
    return text;
}

std::string plan_json(const PlanReport& plan, const std::vector<std::pair<std::string, std::string>>& settings) {
    using json = nlohmann::ordered_json;
    json out;
    out["schema"] = 1;
    out["software"] = "luxel " LUXEL_VERSION;
    for (const auto& [name, value] : settings) out["settings"][name] = value;
    out["counts"] = {{"triangles", plan.triangles}, {"charts", plan.charts}, {"pages", plan.pages}, {"texels", plan.texels}, {"patches", plan.patches}, {"chunks", plan.chunks}};
    out["texels_per_metre"] = plan.texels_per_metre;
    out["memory"] = {{"geometry_bytes", plan.geometry_bytes}, {"floor_bytes", plan.floor_bytes}};
    out["decisions"] = json::array();
    for (const Decision& d : plan.decisions) out["decisions"].push_back({{"part", d.part}, {"runs", d.runs}, {"why", d.why}});
    out["findings"] = json::array();
    for (const SceneFinding& f : plan.findings) out["findings"].push_back({{"code", f.code}, {"count", f.count}, {"text", f.text}, {"where", f.where}});
    out["stages"] = json::array();
    for (const StageReport& s : plan.stages) out["stages"].push_back({{"name", s.name}, {"seconds", s.seconds}, {"reused", s.reused}});
    out["warnings"] = json::array();
    for (const Warning& w : plan.warnings) out["warnings"].push_back({{"code", w.code}, {"where", w.where}, {"text", w.text}});
    return out.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace luxel
