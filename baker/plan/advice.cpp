#include "baker/plan/advice.h"

#include <cmath>
#include <cstdio>

namespace luxel {
namespace {

constexpr std::uint32_t smallest_chunk = 256, smallest_page = 256;

std::string megabytes(std::uint64_t bytes) { return std::to_string((bytes + (1 << 20) - 1) >> 20) + "M"; }

std::string rounded(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", number);
    return text;
}

struct Change {
    std::string options, cost;
    MemoryDemand demand;
};

/// Ever more of them, the harmless ones first.
std::vector<Change> memory_changes(MemoryDemand demand) {
    std::vector<Change> changes;
    std::string options;
    while (demand.chunk_patches > smallest_chunk) {
        demand.chunk_patches /= 2;
        changes.push_back({"--chunk-patches " + std::to_string(demand.chunk_patches), "none in error; the solve reads smaller blocks", demand});
    }
    if (!changes.empty()) options = changes.back().options + " ";
    const std::size_t by_chunks = changes.size();
    while (demand.page_size > smallest_page) {
        demand.page_size /= 2;
        demand.page_count *= 4;  // at most
        changes.push_back({options + "--atlas-size " + std::to_string(demand.page_size), "none in error; more pages, and room between charts on each", demand});
    }
    if (changes.size() > by_chunks) options = changes.back().options + " ";
    if (demand.gathers) {
        demand.gathers = demand.refines = false;
        changes.push_back({options + "--gather off", "light is spread from the patches: softer shadows, errors as in docs/drafts.md", demand});
    }
    return changes;
}

}  // namespace

std::vector<Advice> advise_memory(std::uint64_t budget_bytes, const MemoryDemand& demand) {
    const std::uint64_t floor = memory_floor(demand);
    if (floor <= budget_bytes) return {};
    Advice advice{.budget = "--memory", .problem = megabytes(budget_bytes) + " is less than the " + megabytes(floor) + " that are needed", .change = {}, .effect = {}, .cost = {}};
    for (const Change& change : memory_changes(demand)) {
        const std::uint64_t with = memory_floor(change.demand);
        if (with > budget_bytes) continue;
        advice.change = change.options;
        advice.effect = megabytes(with) + " are enough";
        advice.cost = change.cost;
        break;
    }
    return {advice};
}

std::vector<Advice> advise_disk(std::uint64_t budget_bytes, const Forecast& f) {
    if (budget_bytes == 0 || f.matrix_bytes <= budget_bytes) return {};
    // What is not kept is traced again in each of some ten reads, blocks that are dear to trace are kept first.
    const double missing = 1 - static_cast<double>(budget_bytes) / static_cast<double>(f.matrix_bytes);
    return {{.budget = "--target-disk", .problem = megabytes(budget_bytes) + " is less than the " + megabytes(f.matrix_bytes) + " of the form factors",
             .change = "--store hot --store-bytes " + std::to_string(budget_bytes),
             .effect = "blocks that are dear to trace are kept, " + rounded(100 * missing) + " % is traced again when it is read",
             .cost = "none in error; time: docs/store-modes.md"}};
}

std::vector<Advice> advise_time(double budget_s, const Forecast& fastest, double texels_per_metre) {
    const double seconds = fastest.seconds.total();
    if (budget_s <= 0 || seconds <= budget_s) return {};
    // All of it grows with the texels, which are as the square of the density.
    const double density = texels_per_metre * std::sqrt(budget_s / seconds);
    return {{.budget = "--target-seconds", .problem = rounded(budget_s) + " s is less than the " + rounded(seconds) + " s of --quality " + fastest.name,
             .change = "--texels-per-metre " + rounded(density), .effect = "as many fewer texels as there is less time",
             .cost = "details of light smaller than " + rounded(1 / density) + " m"}};
}

}  // namespace luxel
