#include "tools/luxel/inspect_text.h"

#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

namespace luxel {
namespace {

using json = nlohmann::ordered_json;

std::string bytes_text(std::uint64_t bytes) {
    const char* units[] = {"B", "KB", "MB", "GB", "TB"};
    double value = static_cast<double>(bytes);
    std::size_t unit = 0;
    while (value >= 1000 && unit < 4) value /= 1000, ++unit;
    return unit ? fmt::format("{:.3g} {}", value, units[unit]) : fmt::format("{} B", bytes);
}

std::string short_key(const Key& key) { return key.text().substr(0, 8); }

std::string name_of(const std::filesystem::path& path) { return path.filename().string(); }

std::string matrix_text(const MatrixInspection& m, const FolderListing& listing) {
    std::string text;
    const auto line = [&](const char* name, const std::string& value) { text += fmt::format("  {:<12} {}\n", name, value); };
    text += fmt::format("matrix {}{}\n", m.key.text(), listing.bakes.size() > 1 && listing.bakes.front() == m.key ? " (newest)" : "");
    line("patches", fmt::format("{}, {:.6g} m2, in {} chunks of {} to {}", m.patches, m.area_m2, m.chunks, m.smallest_chunk, m.largest_chunk));
    line("pairs", fmt::format("{} in {} blocks, {} of all possible; {:.1f} per patch", m.pairs, m.blocks, fmt::format("{:.2f} %", 100 * m.density()), m.pairs_per_patch));
    if (m.is_whole())
        line("strips", fmt::format("{}, {:.3f} bytes per pair", bytes_text(m.strip_bytes), m.bytes_per_pair()));
    else
        line("strips", fmt::format("--store {}: {} of {} blocks kept, {} on disk instead of {}; the others are traced again when needed", m.store,
                                   m.kept_blocks, m.blocks, bytes_text(m.strip_bytes), bytes_text(m.all_bytes)));
    line("evidence", fmt::format("{} rays ({}), {} to {} per patch, {} round{}", m.rays, m.estimator, m.least_rays, m.most_rays, m.rounds.size(), m.rounds.size() == 1 ? "" : "s"));
    for (std::size_t k = 0; k < m.rounds.size(); ++k)
        line("", m.is_whole() ? fmt::format("round {}: {} in {} files, evidence-{}", k + 1, bytes_text(m.rounds[k].bytes), m.rounds[k].files, short_key(m.rounds[k].key))
                              : fmt::format("round {}: not stored", k + 1));
    if (m.is_whole()) line("row sums", fmt::format("{:.6f} to {:.6f}, mean {:.6f}; off by {:.1e} at most with the open share", m.least_row, m.most_row, m.mean_row, m.row_error));
    line("closure", fmt::format("{} iterations; largest row error {:.2e} before, {:.2e} after; {:.2e} of the area moved to the diagonal",
                                m.closure.iterations, m.closure.max_row_error_before, m.closure.max_row_error_after, m.closure.remainder_share));
    if (!m.largest_rows.empty()) text += "  largest rows\n";
    for (const StoredRow& row : m.largest_rows)
        text += fmt::format("    patch {:<8} id {:016x}  chunk {:<6} {:>8} pairs  {:.4g} m2\n", row.patch, row.id, row.chunk, row.pairs, row.area_m2);
    return text;
}

std::size_t temporary_files(const FolderListing& listing) {
    std::size_t count = listing.temporary.size();
    for (const StageEntry& entry : listing.entries) count += entry.temporary.size();
    return count;
}

std::string listing_text(const FolderListing& listing) {
    std::string text;
    std::uint64_t bytes = 0;
    for (const StageEntry& entry : listing.entries) bytes += entry.bytes;
    text += fmt::format("{}: {} matri{}, {}\n", listing.root.string(), listing.bakes.size(), listing.bakes.size() == 1 ? "x" : "ces", bytes_text(bytes));
    for (const StageEntry& entry : listing.entries)
        text += fmt::format("  {:<12} {}  {:>5} file{}  {}\n", entry.stage, entry.key.text(), entry.files.size(), entry.files.size() == 1 ? " " : "s", bytes_text(entry.bytes));
    for (const auto& path : listing.foreign) text += fmt::format("  not of a bake: {}\n", name_of(path));
    const std::size_t temporary = temporary_files(listing);
    if (temporary) text += fmt::format("  {} temporary file{} of stopped runs: the next bake removes them\n", temporary, temporary == 1 ? "" : "s");
    return text;
}

std::string verify_text(const Verification& v) {
    std::string text = fmt::format("verify\n  files        {} files, {} blocks, {} read\n", v.files, v.blocks, bytes_text(v.bytes));
    if (v.recounted) text += fmt::format("  recount      strips against evidence; rows off by {:.1e} at most\n", v.row_error);
    if (v.flux_checked)
        text += fmt::format("  flux         {} patches ({} left out): out and in differ by {:.2g} on average; chance of a right sampler {:.2g} (all), {:.2g} (worst patch)\n",
                            v.flux.patches, v.flux.skipped, v.flux.mean_difference, v.flux.probability_all, v.flux.probability_each);
    if (!v.not_checked.empty()) text += fmt::format("  not checked  {}\n", v.not_checked);
    text += v.passed() ? "  result       no problems\n" : fmt::format("  result       {} problem{}\n", v.findings.size(), v.findings.size() == 1 ? "" : "s");
    return text;
}

json flux_json(const FluxCheck& flux) {
    json worst = json::array();
    for (const FluxSuspect& s : flux.worst)
        worst.push_back({{"patch", s.patch}, {"id", fmt::format("{:016x}", s.id)}, {"out_m2", s.out_m2}, {"in_m2", s.in_m2},
                         {"standard_error_m2", s.standard_error_m2}, {"t", s.t}});
    return {{"passed", flux.passed},
            {"patches", flux.patches},
            {"skipped", flux.skipped},
            {"replicates", flux.replicates},
            {"mean_difference", flux.mean_difference},
            {"scatter", flux.scatter},
            {"probability_all", flux.probability_all},
            {"probability_each", flux.probability_each},
            {"worst", worst}};
}

json matrix_json(const MatrixInspection& m) {
    json rounds = json::array();
    for (const StoredRound& r : m.rounds) rounds.push_back({{"key", r.key.text()}, {"files", r.files}, {"bytes", r.bytes}});
    json rows = json::array();
    for (const StoredRow& r : m.largest_rows)
        rows.push_back({{"patch", r.patch}, {"id", fmt::format("{:016x}", r.id)}, {"chunk", r.chunk}, {"pairs", r.pairs}, {"area_m2", r.area_m2}});
    json out = {{"key", m.key.text()},
            {"patches", m.patches},
            {"area_m2", m.area_m2},
            {"chunks", {{"count", m.chunks}, {"smallest", m.smallest_chunk}, {"largest", m.largest_chunk}}},
            {"blocks", m.blocks},
            {"pairs", m.pairs},
            {"pairs_per_patch", m.pairs_per_patch},
            {"density", m.density()},
            {"bytes", m.strip_bytes},
            {"bytes_per_pair", m.bytes_per_pair()},
            {"store", {{"kind", m.store}, {"kept_blocks", m.kept_blocks}, {"kept_pairs", m.kept_pairs}}},
            {"evidence",
             {{"estimator", m.estimator}, {"rays", m.rays}, {"least_rays", m.least_rays}, {"most_rays", m.most_rays}, {"rounds", rounds}}},
            {"closure",
             {{"iterations", m.closure.iterations},
              {"max_row_error_before", m.closure.max_row_error_before},
              {"mean_row_error_before", m.closure.mean_row_error_before},
              {"max_row_error_after", m.closure.max_row_error_after},
              {"mean_row_error_after", m.closure.mean_row_error_after},
              {"diagonal_share", m.closure.diagonal_share},
              {"remainder_share", m.closure.remainder_share},
              {"short_rows", m.closure.short_rows},
              {"short_share", m.closure.short_share},
              {"largest_change", m.closure.largest_change},
              {"mean_change", m.closure.mean_change}}}};
    if (!m.is_whole()) return out;
    out["row_sums"] = {{"least", m.least_row}, {"mean", m.mean_row}, {"most", m.most_row}, {"error", m.row_error}};
    out["largest_rows"] = rows;
    return out;
}

}  // namespace

std::string inspect_text(const InspectReport& report) {
    std::string text = listing_text(report.listing);
    if (report.matrix) text += matrix_text(*report.matrix, report.listing);
    if (report.verify) text += verify_text(*report.verify);
    return text;
}

nlohmann::ordered_json verify_json(const Verification& v) {
    json findings = json::array();
    for (const Finding& f : v.findings) findings.push_back({{"where", f.where}, {"what", f.what}});
    json out = {{"passed", v.passed()}, {"files", v.files},         {"blocks", v.blocks},     {"bytes", v.bytes},
                {"recounted", v.recounted}, {"row_error", v.row_error}, {"not_checked", v.not_checked}};
    if (v.flux_checked) out["flux"] = flux_json(v.flux);
    out["findings"] = findings;
    return out;
}

std::string inspect_json(const InspectReport& report) {
    json out;
    out["schema"] = 1;
    out["folder"] = report.listing.root.string();
    json& stages = out["stages"] = json::array();
    for (const StageEntry& e : report.listing.entries)
        stages.push_back({{"stage", e.stage}, {"key", e.key.text()}, {"files", e.files.size()}, {"bytes", e.bytes}});
    json& foreign = out["foreign"] = json::array();
    for (const auto& path : report.listing.foreign) foreign.push_back(name_of(path));
    out["temporary_files"] = temporary_files(report.listing);
    json& bakes = out["bakes"] = json::array();
    for (const Key& key : report.listing.bakes) bakes.push_back(key.text());
    if (report.matrix) out["matrix"] = matrix_json(*report.matrix);
    if (report.verify) out["verify"] = verify_json(*report.verify);
    return out.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

void print_findings(const Verification& verify) {
    for (const Finding& f : verify.findings)
        std::fprintf(stderr, "luxel: error: %s: %s\n       remove the file and run the same bake again\n", f.where.c_str(), f.what.c_str());
}

}  // namespace luxel
