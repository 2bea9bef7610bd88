#include "baker/sweep/sweep_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "formats/base/base64.h"
#include "baker/sweep/chart.h"
#include "baker/sweep/error_colour.h"

namespace luxel {
namespace {

constexpr const char* style = R"(
:root{color-scheme:light dark;--back:#fcfcfa;--text:#1c1c1a;--soft:#62625c;--line:#d9d8d2;--panel:#f3f2ee;--point:#4a6fa5;--preset:#c2410c;--chosen:#15803d;--front:#a8a69e}
@media (prefers-color-scheme:dark){:root{--back:#161617;--text:#e9e8e4;--soft:#a3a29b;--line:#37373a;--panel:#202022;--point:#8ab4f0;--preset:#fb923c;--chosen:#4ade80;--front:#6b6b68}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:1200px;padding:28px 24px 60px;background:var(--back);color:var(--text);font:15px/1.5 system-ui,sans-serif}
h1{font-size:24px;margin:0 0 4px}h2{font-size:17px;margin:34px 0 8px}p{margin:6px 0;max-width:80ch}.soft{color:var(--soft)}
code{font:13px/1.45 ui-monospace,monospace;background:var(--panel);padding:1px 5px;border-radius:4px;overflow-wrap:anywhere}
.charts{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,520px),1fr));gap:8px 28px}figure{margin:0;min-width:0}figcaption{font-weight:600;margin:18px 0 2px}
.chart{width:100%;height:auto;display:block}.chart text{font:12px system-ui,sans-serif;fill:var(--soft)}.chart .name{fill:var(--text)}
.grid{stroke:var(--line);stroke-width:1}.axis{stroke:var(--soft);stroke-width:1}.front{fill:none;stroke:var(--front);stroke-width:1.8;stroke-dasharray:5 4}
.point{fill:var(--point);stroke:var(--back);stroke-width:1.5}.preset{fill:var(--preset)}.chosen{stroke:var(--chosen);stroke-width:3}.uncertain{fill:var(--back);stroke:var(--point);stroke-width:2}.preset.uncertain{stroke:var(--preset)}.point:hover{stroke:var(--text)}
.key{display:flex;flex-wrap:wrap;gap:4px 22px;color:var(--soft);margin:8px 0 0}.key svg{width:14px;height:14px;vertical-align:-2px;margin-right:6px}
.scale{display:inline-block;width:180px;height:12px;border-radius:3px;vertical-align:-1px;margin:0 8px}
.wide{overflow-x:auto}table{border-collapse:collapse;width:100%;font-size:13.5px}th,td{text-align:right;padding:6px 9px;border-bottom:1px solid var(--line);vertical-align:top;white-space:nowrap;font-variant-numeric:tabular-nums}
th{color:var(--soft);font-weight:500;vertical-align:bottom;position:sticky;top:0;background:var(--back)}th:first-child,td:first-child{text-align:left;white-space:normal;min-width:260px}tr:target td{background:var(--panel)}
td img{display:block;width:150px;height:84px;object-fit:contain;object-position:left top;image-rendering:pixelated}th:last-child,td:last-child{text-align:left}td code{display:block;padding:0;background:none;color:var(--soft);font-size:12px}.whole{white-space:nowrap}summary{color:var(--soft);font-size:12px;cursor:pointer}.best{font-weight:700}.failed{color:var(--preset);text-align:left;white-space:normal}
)";

using Cost = std::function<double(const PointResult&)>;

class Page {
  public:
    Page(const SweepResult& result, const SweepSummary& summary) : result_(result), summary_(summary), fronts_(find_fronts(result.points)) {}

    std::string html() {
        const std::string title = "luxel sweep: " + escaped(summary_.scene);
        out_ = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>" + title +
               "</title>\n<style>" + style + "</style>\n</head>\n<body>\n<h1>" + title + "</h1>\n";
        add_head();
        add_charts();
        add_table();
        return std::move(out_) + "</body>\n</html>\n";
    }

  private:
    void paragraph(const std::string& html, const char* kind = "") { out_ += std::string("<p") + (*kind ? std::string(" class=\"") + kind + "\"" : "") + ">" + html + "</p>\n"; }

    void add_head() {
        const auto failed = static_cast<std::size_t>(std::ranges::count_if(result_.points, &PointResult::failed));
        std::string line = fmt::format("{} points", result_.points.size() - failed);
        if (failed) line += fmt::format(", {} failed", failed);
        if (result_.interrupted) line += ", interrupted: the same command goes on";
        line += "; error against " + escaped(result_.reference);
        double noise = 0;
        for (const PointResult& p : result_.points) noise = std::max(noise, p.error.noise);
        if (noise > 0) line += fmt::format(", whose own noise of {:.2g} % is taken out of the RMSE", 100 * noise);
        paragraph(line + "; " + escaped(summary_.software), "soft");
        std::string common;
        for (const auto& [name, value] : summary_.common) common += fmt::format("{}--{}{}{}", common.empty() ? "" : " ", name, value.empty() ? "" : " ", value.empty() ? value : shell_word(value));
        if (!common.empty()) paragraph("All points: <code>" + escaped(common) + "</code>", "soft");
        if (!summary_.targets.any()) return;
        if (summary_.chosen) paragraph("Meets the targets at least cost: <b>" + escaped(summary_.chosen->point.name) + "</b><br><code>" + escaped(summary_.chosen->bake_line) + "</code>");
        else paragraph("<b>No point meets the targets.</b>");
    }

    [[nodiscard]] Chart made_chart(const char* id, const char* title, ChartAxis x, const Cost& cost, const std::vector<bool>& front) const {
        Chart chart{id, title, std::move(x), {"relative RMSE", ChartUnit::share}, {}, {}, false};
        for (std::size_t k = 0; k < result_.points.size(); ++k) {
            const PointResult& p = result_.points[k];
            if (p.failed) continue;
            if (front[k]) chart.front.push_back(chart.points.size());
            chart.points.push_back({cost(p), p.error.relative_rmse, p.point.name, p.point.is_preset ? p.point.name : std::string(), fmt::format("#p{}", k + 1), p.point.is_preset,
                                    &p == summary_.chosen, p.error.is_below_noise});
        }
        std::stable_sort(chart.front.begin(), chart.front.end(), [&](std::size_t a, std::size_t b) { return chart.points[a].x < chart.points[b].x; });
        return chart;
    }

    [[nodiscard]] Chart prediction() const {
        Chart chart{"predicted", "predicted error", {"error as luxel predicts it", ChartUnit::share}, {"relative RMSE", ChartUnit::share}, {}, {}, true};
        for (std::size_t k = 0; k < result_.points.size(); ++k) {
            const PointResult& p = result_.points[k];
            if (p.failed || p.error.predicted < 0) continue;
            chart.points.push_back({p.error.predicted, p.error.relative_rmse, p.point.name, p.point.is_preset ? p.point.name : std::string(), fmt::format("#p{}", k + 1), p.point.is_preset,
                                    &p == summary_.chosen, p.error.is_below_noise});
        }
        return chart;
    }

    void figure(const Chart& chart, const char* caption) { out_ += std::string("<figure><figcaption>") + caption + "</figcaption>\n" + chart_svg(chart) + "</figure>\n"; }

    void add_charts() {
        out_ += "<div class=\"charts\">\n";
        figure(made_chart("time", "error against time", {"seconds from nothing", ChartUnit::seconds}, [](const PointResult& p) { return p.seconds; }, fronts_.seconds), "Error against time");
        figure(made_chart("memory", "error against memory", {"highest memory", ChartUnit::bytes}, [](const PointResult& p) { return static_cast<double>(p.peak_bytes); }, fronts_.memory), "Error against memory");
        figure(made_chart("disk", "error against disk", {"bake folder", ChartUnit::bytes}, [](const PointResult& p) { return static_cast<double>(p.disk_bytes); }, fronts_.disk), "Error against disk");
        if (const Chart predicted = prediction(); !predicted.points.empty()) figure(predicted, "Error found against error predicted");
        out_ += "</div>\n<div class=\"key\">";
        for (const auto& [kind, text] : {std::pair{"point", "a point; rest on it for its figures, click for its row"}, std::pair{"point preset", "a value of --quality"},
                                         std::pair{"point chosen", "meets the targets at least cost"}, std::pair{"point uncertain", "no more than the noise of the reference"}})
            out_ += std::string("<span><svg viewBox=\"0 0 14 14\"><circle class=\"") + kind + "\" cx=\"7\" cy=\"7\" r=\"5\"/></svg>" + text + "</span>";
        out_ += "<span><svg viewBox=\"0 0 14 14\"><path class=\"front\" d=\"M0 7H14\"/></svg>Pareto front: nothing measured has less of both; for predictions, where both agree</span></div>\n";
    }

    static std::string scale() {
        std::string stops;
        constexpr int steps = 12;
        for (int k = 0; k <= steps; ++k) stops += fmt::format(",{}", colour_text(error_colour(least_shown_error * std::pow(most_shown_error / least_shown_error, k / static_cast<double>(steps)))));
        return "0.1 %<span class=\"scale\" style=\"background:linear-gradient(90deg" + stops + ")\"></span>100 %";
    }

    void add_table() {
        out_ += "<h2>Points</h2>\n<p class=\"soft\">Error maps: root mean square of the relative error, " + scale() +
                ". Median, p95 and worst are of |difference| over the reference, or over 1 % of the mean light where that is more.</p>\n<div class=\"wide\"><table>\n<thead><tr>";
        for (const char* name : {"point", "seconds", "RMSE", "bias", "median", "p95", "worst", "predicted", "memory", "disk", "model", "error map"}) out_ += std::string("<th>") + name + "</th>";
        out_ += "</tr></thead>\n<tbody>\n";
        std::vector<std::size_t> order(result_.points.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            const PointResult &p = result_.points[a], &q = result_.points[b];
            return p.failed != q.failed ? q.failed : p.seconds < q.seconds;
        });
        for (const std::size_t k : order) add_row(k);
        out_ += "</tbody></table></div>\n";
    }

    void cell(const std::string& html, bool is_best = false) { out_ += (is_best ? "<td class=\"best\">" : "<td>") + html + "</td>"; }

    void add_row(std::size_t k) {
        const PointResult& p = result_.points[k];
        std::string settings;  // a line breaks between options only
        for (const BakeSetting& s : p.point.settings) settings += fmt::format("<span class=\"whole\">{}</span> ", escaped(settings_text({s})));
        out_ += fmt::format("<tr id=\"p{}\"><td><b>{}</b><code>{}</code><details><summary>bake line</summary><code>{}</code></details></td>", k + 1, escaped(p.point.name), settings,
                            escaped(p.bake_line));
        if (p.failed) {
            out_ += "<td class=\"failed\" colspan=\"11\">failed: " + escaped(p.message) + "</td></tr>\n";
            return;
        }
        const ErrorFigures& e = p.error;
        const auto share = [](double value) { return value_text(value, ChartUnit::share); };
        const auto bytes = [](std::uint64_t value) { return value_text(static_cast<double>(value), ChartUnit::bytes); };
        std::string stages;
        for (const StageCost& stage : p.stages) stages += fmt::format("{} {:.2f} s\n", stage.name, stage.seconds);
        out_ += fmt::format("<td{} title=\"{}\">{:.2f}</td>", fronts_.seconds[k] ? " class=\"best\"" : "", escaped(stages), p.seconds);
        cell((e.is_below_noise ? "&lt; " + share(std::max(e.noise, e.relative_rmse)) : share(e.relative_rmse)) + (p.run.is_whole ? "" : "<br>not converged"), fronts_.seconds[k]);
        cell(fmt::format("{:+.2f} %", 100 * e.bias));
        cell(share(e.median));
        cell(share(e.p95));
        cell(fmt::format("{}<br><span class=\"soft\">page {}: {}, {}</span>", share(e.worst.error), e.worst.page, e.worst.x, e.worst.y));
        cell(e.predicted < 0 ? "" : share(e.predicted));
        cell(bytes(p.peak_bytes), fronts_.memory[k]);
        cell(bytes(p.disk_bytes), fronts_.disk[k]);
        cell(bytes(p.model_bytes));
        cell("<img alt=\"error map of " + escaped(p.point.name) + "\" src=\"data:image/png;base64," + encode_base64(p.error_map_png) + "\">");
        out_ += "</tr>\n";
    }

    const SweepResult& result_;
    const SweepSummary& summary_;
    const Fronts fronts_;
    std::string out_;
};

}  // namespace

std::string sweep_page(const SweepResult& result, const SweepSummary& summary) { return Page(result, summary).html(); }

}  // namespace luxel
