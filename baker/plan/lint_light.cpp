#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include "baker/light/lit_sides.h"
#include "baker/plan/lint.h"
#include "baker/plan/open_rays.h"

namespace luxel {
namespace {

/// Of the light of a room, lost to the open: less is a crack that no one sees, more is a door, a window, or no room.
constexpr double least_loss = 0.0005, most_loss = 0.25;
/// Smaller groups of patches are things, not rooms.
constexpr std::size_t least_patches = 16;

std::string percent(double share) {
    const double rounded = std::round(share * 10000) / 100;
    std::string text = std::to_string(rounded);
    text.resize(text.find('.') + 3);
    return text + " %";
}

std::string square_metres(double area_m2) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), area_m2 < 10 ? "%.2g m2" : "%.0f m2", area_m2);
    return text.data();
}

const std::string& object_name(const BakedGeometry& g, PatchNumber patch) { return g.scene.objects[g.atlas.charts[g.patches.patches[patch].chart].object].name; }

/// The objects of a room through which most is lost, beside what they lose.
std::string name_losers(const std::map<std::string, double>& lost_m2) {
    std::vector<std::pair<double, std::string>> sorted;
    for (const auto& [name, m2] : lost_m2) sorted.emplace_back(-m2, name);
    std::ranges::sort(sorted);
    std::string text;
    for (std::size_t k = 0; k < std::min<std::size_t>(3, sorted.size()); ++k) text += (k ? ", " : "") + sorted[k].second;
    return text;
}

void lint_open_rooms(const BakedGeometry& g, std::vector<SceneFinding>& all) {
    if (!g.scene.sky.empty()) return;  // what is open is lit from there
    const std::vector<std::uint32_t> open = count_open_rays(g);
    SceneFinding finding{"open-room", "rooms that lose a little of their light to the open, as through a gap between walls; seen most from the surfaces that are named", {}, 0};
    std::vector<std::pair<double, std::string>> rooms;
    for (std::uint32_t chunk = 0; chunk < g.layout.chunk_count(); ++chunk) {
        double area_m2 = 0, lost_m2 = 0;
        std::size_t count = 0;
        std::map<std::string, double> losers;
        for (PatchNumber p = g.layout.first_patch[chunk]; p < g.layout.first_patch[chunk + 1]; ++p) {
            // A surface that faces the open altogether is an outer one, and no part of the room.
            if (g.patches.patches[p].is_back || 2 * open[p] > open_rays_of_patch) continue;
            const auto area = static_cast<double>(g.patches.patches[p].area_m2);
            area_m2 += area, ++count;
            if (open[p] == 0) continue;
            lost_m2 += area * open[p] / open_rays_of_patch;
            losers[object_name(g, p)] += area * open[p] / open_rays_of_patch;
        }
        if (count < least_patches || lost_m2 < least_loss * area_m2 || lost_m2 > most_loss * area_m2) continue;
        rooms.emplace_back(-lost_m2 / area_m2, percent(lost_m2 / area_m2) + " of a room of " + square_metres(area_m2) + ", from " + name_losers(losers));
    }
    std::ranges::sort(rooms);
    finding.count = rooms.size();
    for (std::size_t k = 0; k < std::min(rooms.size(), SceneFinding::most_named); ++k) finding.where.push_back(rooms[k].second);
    if (finding.count) all.push_back(std::move(finding));
}

/// Objects of charts that are marked, those with most area first.
SceneFinding name_charts(const BakedGeometry& g, const std::vector<bool>& marked, std::string code, std::string text) {
    std::map<std::uint32_t, double> area_m2;
    double all_m2 = 0, marked_m2 = 0;
    for (std::uint32_t t = 0; t < g.scene.triangle_count(); ++t) {
        const double own = g.scene.area_m2(t);
        all_m2 += own;
        if (!marked[g.atlas.triangle_chart[t]]) continue;
        marked_m2 += own;
        area_m2[g.scene.triangle_object[t]] += own;
    }
    std::vector<std::pair<double, std::uint32_t>> sorted;
    for (const auto& [object, m2] : area_m2) sorted.emplace_back(-m2, object);
    std::ranges::sort(sorted);
    SceneFinding finding{std::move(code), percent(marked_m2 / all_m2) + " of the surface " + std::move(text), {}, sorted.size()};
    for (std::size_t k = 0; k < std::min(sorted.size(), SceneFinding::most_named); ++k) finding.where.push_back(g.scene.objects[sorted[k].second].name);
    return finding;
}

void lint_sides(const BakedGeometry& g, std::vector<SceneFinding>& all) {
    const DarkFronts sides = find_dark_fronts(g.scene, g.atlas, *g.tracer, true);
    std::vector<bool> unlit = sides.unlit;
    for (std::size_t c = 0; c < unlit.size(); ++c) unlit[c] = unlit[c] && !sides.charts[c];
    SceneFinding dark = name_charts(g, sides.charts, "dark-fronts", "is two-sided with its front in the dark and its back in the light: viewers will show it black. Use --two-sided lit, or turn the faces");
    SceneFinding without = name_charts(g, unlit, "unlit-surfaces", "gets no light: it is inside of things, or in rooms without any. Leave it out, set \"lightmap\": false, or light it");
    if (dark.count) all.push_back(std::move(dark));
    if (without.count) all.push_back(std::move(without));
}

}  // namespace

std::vector<SceneFinding> lint_light(const BakedGeometry& g) {
    std::vector<SceneFinding> all;
    lint_open_rooms(g, all);
    lint_sides(g, all);
    return all;
}

}  // namespace luxel
