#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "baker/plan/lint.h"
#include "baker/trace/coincident.h"
#include "baker/unwrap/kept_uv.h"
#include "baker/unwrap/object_mesh.h"

namespace luxel {
namespace {

/// Of what a surface gives back, above which light hardly ends: paints end at about 0.85, fresh snow at 0.9.
constexpr float bright = 0.9f;
/// One object with more of all texels than this, when others share the rest.
constexpr double crowding_share = 0.5;
/// Coordinates are stored no finer than this share of a texel: edges and corners visibly move.
constexpr double coarse_share = 1.0 / 16;

void name(SceneFinding& finding, std::string where) {
    ++finding.count;
    if (finding.where.size() < SceneFinding::most_named) finding.where.push_back(std::move(where));
}

void keep(std::vector<SceneFinding>& all, SceneFinding finding) {
    if (finding.count > 0) all.push_back(std::move(finding));
}

void lint_second_uv(const BakedGeometry& g, std::vector<SceneFinding>& all) {
    SceneFinding unfit{"uv1-unfit", "second UV sets that --uv keep cannot use; they are unwrapped instead", {}, 0};
    for (std::size_t n = 0; n < g.scene.objects.size(); ++n) {
        const Object& object = g.scene.objects[n];
        if (!g.scene.object_has_uv1[n] || !object.has_lightmap || object.triangle_count == 0) continue;
        std::string why_not;
        const double density = static_cast<double>(object.density(g.atlas.texels_per_metre));
        if (!kept_chart(g.scene, object, object_mesh(g.scene, object), density, why_not)) name(unfit, object.name + ": " + why_not);
    }
    keep(all, std::move(unfit));
}

void lint_density(const BakedGeometry& g, std::vector<SceneFinding>& all) {
    std::vector<std::pair<double, std::size_t>> texels;  // of objects, by their area
    double sum = 0;
    for (std::size_t n = 0; n < g.scene.objects.size(); ++n) {
        const Object& object = g.scene.objects[n];
        if (!object.has_lightmap) continue;
        double area_m2 = 0;
        for (std::uint32_t t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t) area_m2 += g.scene.area_m2(t);
        const double density = static_cast<double>(object.density(g.atlas.texels_per_metre));
        texels.emplace_back(area_m2 * density * density, n), sum += texels.back().first;
    }
    std::ranges::sort(texels);
    SceneFinding tiny{"below-a-texel", "objects with less surface than one texel: one value lights them. Raise their texelsPerMetre, or light them by probes (\"lightmap\": false)", {}, 0};
    for (const auto& [count, n] : texels)
        if (count < 1) name(tiny, g.scene.objects[n].name);
    SceneFinding large{"crowding", "one object takes most of all texels: lower its texelsPerMetre (docs/settings.md), or cut it", {}, 0};
    if (texels.size() > 2 && texels.back().first > crowding_share * sum)
        name(large, g.scene.objects[texels.back().second].name + ": " + std::to_string(std::lround(100 * texels.back().first / sum)) + " %");
    keep(all, std::move(tiny));
    keep(all, std::move(large));
}

void lint_reflectance(const BakedGeometry& g, std::vector<SceneFinding>& all) {
    struct Sum {
        double area_m2 = 0, reflected_m2 = 0;
    };
    std::map<std::uint32_t, Sum> materials;
    for (const Patch& patch : g.patches.patches) {
        Sum& sum = materials[g.scene.objects[g.atlas.charts[patch.chart].object].material];
        sum.area_m2 += static_cast<double>(patch.area_m2);
        sum.reflected_m2 += static_cast<double>(patch.area_m2 * std::max({patch.reflectance.x, patch.reflectance.y, patch.reflectance.z}));
    }
    SceneFinding finding{"bright-surfaces", "materials reflect more than 90 % of a colour: no paint does. Rooms of them get many times the light, and take longer", {}, 0};
    for (const auto& [material, sum] : materials)
        if (sum.reflected_m2 > static_cast<double>(bright) * sum.area_m2)
            name(finding, g.scene.materials[material].name + ": " + std::to_string(std::lround(1000 * sum.reflected_m2 / sum.area_m2) / 10) + " %");
    keep(all, std::move(finding));
}

void lint_lamps(const BakedGeometry& g, std::vector<SceneFinding>& all) {
    SceneFinding finding{"dark-lamps", "lamps without power: intensity or colour is zero", {}, 0};
    for (const std::string& lamp : g.scene.dark_lamps) name(finding, lamp);
    keep(all, std::move(finding));
}

void lint_place(const BakedGeometry& g, std::vector<SceneFinding>& all) {
    // What the file holds, node transforms in double included; the bake itself works about Scene::origin.
    double farthest_m = 0;
    for (const Vec3f& p : g.scene.positions)
        for (int axis = 0; axis < 3; ++axis) farthest_m = std::max(farthest_m, std::fabs(g.scene.origin[axis] + static_cast<double>(p[axis])));
    const double step_m = farthest_m * 0x1p-24, texel_m = 1 / static_cast<double>(g.atlas.texels_per_metre);
    if (!(step_m > coarse_share * texel_m)) return;
    all.push_back({"far-from-origin", "coordinates reach " + std::to_string(std::llround(farthest_m)) + " m, where single precision steps by " + std::to_string(step_m * 1000) +
                                          " mm: viewers tear edges apart. Move the scene to the origin", {}, 1});
}

void lint_coincident(const BakedGeometry& g, std::vector<SceneFinding>& all) {
    const CoincidentTriangles groups(g.scene);
    if (groups.empty()) return;
    SceneFinding finding{"coincident-faces", "triangles lie in the same place and face the same way: one hides the other by chance, viewers flicker. Remove one of them", {}, 0};
    std::set<std::pair<std::uint32_t, std::uint32_t>> named;
    for (std::uint32_t t = 0; t < g.scene.triangle_count(); ++t)
        for (const std::uint32_t other : groups.group(t)) {
            if (other <= t || g.scene.geometric_normal(t).dot(g.scene.geometric_normal(other)) <= 0) continue;
            const auto pair = std::minmax(g.scene.triangle_object[t], g.scene.triangle_object[other]);
            ++finding.count;
            if (finding.where.size() < SceneFinding::most_named && named.insert(pair).second)
                finding.where.push_back(g.scene.objects[pair.first].name + (pair.first == pair.second ? std::string() : " and " + g.scene.objects[pair.second].name));
        }
    keep(all, std::move(finding));
}

}  // namespace

std::vector<SceneFinding> lint_scene(const BakedGeometry& g) {
    std::vector<SceneFinding> all;
    lint_second_uv(g, all);
    lint_density(g, all);
    lint_reflectance(g, all);
    lint_lamps(g, all);
    lint_place(g, all);
    lint_coincident(g, all);
    return all;
}

}  // namespace luxel
