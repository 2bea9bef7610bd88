#include "baker/bake/endless_light.h"

#include <algorithm>
#include <cmath>

#include "baker/core/disjoint_sets.h"
#include "baker/store/closed_matrix.h"

namespace luxel {
namespace {

/// Where light ends, lm.
struct Ended {
    Channels fictive{0, 0, 0}, all{0, 0, 0};

    void add(const Ended& other) {
        for (std::size_t c = 0; c < 3; ++c) {
            fictive[c] += other.fictive[c];
            all[c] += other.all[c];
        }
    }
    [[nodiscard]] double share() const {
        double largest = 0;
        for (std::size_t c = 0; c < 3; ++c)
            if (all[c] > 0) largest = std::max(largest, fictive[c] / all[c]);
        return largest;
    }
};

Ended ended_at(const Patch& patch, const BakedMatrix& matrix, const BakedSolution& solution, PatchNumber p) {
    Ended ended;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto solved = static_cast<double>(solution.reflectance[p][static_cast<int>(c)]);
        const double arrived = matrix.area_m2[p] * solution.result.irradiance[p][c];
        ended.fictive[c] = arrived * (static_cast<double>(patch.reflectance[static_cast<int>(c)]) - solved);
        const double sent = std::max(0.0, solution.result.radiosity[p][c] - solution.result.unshot[p][c]);
        ended.all[c] = arrived * (1 - solved) + std::max(0.0, matrix.closure.row_open_m2[p]) * sent;
    }
    return ended;
}

/// Which patches exchange light, directly or not: each patch with the smallest number of its part.
std::vector<PatchNumber> parts(const BakedMatrix& matrix) {
    DisjointSets sets(static_cast<PatchNumber>(matrix.area_m2.size()));
    ClosedMatrix strips(*matrix.strips, matrix.area_m2, matrix.closure);
    Block block;
    for (std::size_t index = 0; index < strips.blocks().size(); ++index) {
        strips.load(index, block);
        const std::vector<PatchNumber>& first = strips.layout().first_patch;
        for (PatchNumber row = 0; row + 1 < block.row_begin.size(); ++row)
            for (std::uint32_t k = block.row_begin[row]; k < block.row_begin[row + 1]; ++k)
                sets.unite(first[block.a] + row, first[block.b] + block.columns[k]);
    }
    std::vector<PatchNumber> part(matrix.area_m2.size());
    for (PatchNumber p = 0; p < part.size(); ++p) part[p] = sets.find(p);
    return part;
}

/// Does light that matters never end? `total`: of all patches.
bool is_endless(const std::vector<Ended>& ended, const Ended& total, const BakedMatrix& matrix) {
    const std::vector<PatchNumber> part = parts(matrix);
    std::vector<Ended> sums(ended.size());
    for (PatchNumber p = 0; p < ended.size(); ++p) sums[part[p]].add(ended[p]);
    return std::ranges::any_of(sums, [&](const Ended& sum) {
        for (std::size_t c = 0; c < 3; ++c)
            if (sum.fictive[c] > most_fictive * sum.all[c] && sum.all[c] > some_fictive * total.all[c]) return true;
        return false;
    });
}

std::vector<double> light_by_material(const BakedGeometry& g, const std::vector<Ended>& ended) {
    std::vector<double> light(g.scene.materials.size(), 0.0);
    for (PatchNumber p = 0; p < ended.size(); ++p) {
        const auto fragments = g.patches.fragments_of(p);
        if (fragments.empty()) continue;
        const Object& object = g.scene.objects[g.scene.triangle_object[fragments.front().triangle]];
        light[object.material] += std::ranges::max(ended[p].fictive);
    }
    return light;
}

/// 'material "a", material 7, ...': at most three, the most light first.
std::string names(const Scene& scene, const std::vector<double>& light) {
    std::vector<std::size_t> order;
    for (std::size_t m = 0; m < light.size(); ++m)
        if (light[m] > 0) order.push_back(m);
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return light[a] > light[b]; });
    std::string text;
    for (std::size_t k = 0; k < std::min<std::size_t>(order.size(), 3); ++k) {
        const std::string& name = scene.materials[order[k]].name;
        text += (k ? ", material " : "material ") + (name.empty() ? std::to_string(order[k]) : "\"" + name + "\"");
    }
    return order.size() > 3 ? text + " and " + std::to_string(order.size() - 3) + " more" : text;
}

}  // namespace

std::vector<Rgb> solvable_reflectances(const PatchSet& patches, const RayTallies& tallies) {
    std::vector<Rgb> values;
    for (std::size_t p = 0; p < patches.count(); ++p) {
        const float most = 1 - 0.5f / static_cast<float>(std::max(tallies.rays[p], 1u));
        Rgb value = patches.patches[p].reflectance;
        for (int c = 0; c < 3; ++c)
            if (value[c] >= 1) value[c] = most;
        values.push_back(value);
    }
    return values;
}

void judge_endless_light(const BakeOptions& options, const BakedGeometry& g, const BakedMatrix& matrix,
                         const BakedSolution& solution, BakeReport& report) {
    std::vector<Ended> ended;
    Ended total;
    for (PatchNumber p = 0; p < g.patches.count(); ++p) {
        ended.push_back(ended_at(g.patches.patches[p], matrix, solution, p));
        total.add(ended.back());
    }
    if (total.share() <= some_fictive) return;
    const std::string where = names(g.scene, light_by_material(g, ended));
    if (is_endless(ended, total, matrix))
        throw Error(ErrorCode::bad_input, options.input.filename().string() + ": " + where,
                    "the light never ends: reflectance 1, and no ray found a surface that absorbs it, or a way out",
                    "lower the colour below 1, or open the scene; more --rays find smaller openings");
    report.warnings.push_back({"white-surfaces", where,
                               "reflectance 1: for " + std::to_string(std::lround(100 * total.share())) +
                                   " % of the light the rays cannot tell where it ends, and it is taken to end there; more --rays, or "
                                   "a colour below 1, make this smaller"});
}

}  // namespace luxel
