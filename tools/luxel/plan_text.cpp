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
    if (!plan.forecasts.empty()) text += fmt::format("\n  {:<8} {:>12} {:>12} {:>12} {:>12} {:>10}\n", "quality", "rays", "pairs", "on disk", "memory", "seconds");
    for (const Forecast& f : plan.forecasts)
        text += fmt::format("  {:<8} {:>10.3f} M {:>10.3f} M {:>9.1f} MB {:>9.0f} MB {:>10.1f}\n", f.name, static_cast<double>(f.evidence_rays + f.gather_rays) * 1e-6,
                            static_cast<double>(f.pairs) * 1e-6, static_cast<double>(f.matrix_bytes) * 1e-6, static_cast<double>(f.peak_bytes) * 1e-6, f.seconds.total());
    if (plan.choice) text += fmt::format("\n--target-seconds takes --quality {}, foreseen to take {:.3g} s\n", plan.choice->name, plan.choice->seconds.total());
    for (const Advice& a : plan.advice)
        text += a.change.empty() ? fmt::format("\n{}: {}, and no option here changes that\n", a.budget, a.problem)
                                 : fmt::format("\n{}: {}. Try {}: {}. Cost: {}\n", a.budget, a.problem, a.change, a.effect, a.cost);
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
    out["forecasts"] = json::array();
    for (const Forecast& f : plan.forecasts)
        out["forecasts"].push_back({{"quality", f.name}, {"evidence_rays", f.evidence_rays}, {"gather_rays", f.gather_rays}, {"pairs", f.pairs}, {"matrix_bytes", f.matrix_bytes},
                                    {"peak_bytes", f.peak_bytes}, {"seconds", f.seconds.total()},
                                    {"seconds_of", {{"geometry", f.seconds.geometry}, {"matrix", f.seconds.matrix}, {"light", f.seconds.light}, {"write", f.seconds.write}}}});
    if (plan.choice) out["choice"] = {{"quality", plan.choice->name}, {"seconds", plan.choice->seconds.total()}};
    out["advice"] = json::array();
    for (const Advice& a : plan.advice) out["advice"].push_back({{"budget", a.budget}, {"problem", a.problem}, {"change", a.change}, {"effect", a.effect}, {"cost", a.cost}});
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
