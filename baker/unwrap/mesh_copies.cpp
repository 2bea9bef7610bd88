#include "baker/unwrap/mesh_copies.h"

#include <algorithm>
#include <map>
#include <utility>

namespace luxel {
namespace {

/// Squares of the lengths that an edge of a copy may have where that of the layout's own mesh is 1.
constexpr double least_stretch2 = 1.0 / 16, most_stretch2 = 1.4142135623730951;

/// A symmetric matrix as in ShapeMetric.
using Symmetric = ShapeMetric;

/// a - factor * b
Symmetric difference(const Symmetric& a, double factor, const Symmetric& b) {
    Symmetric out{};
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = a[k] - factor * b[k];
    return out;
}

/// By Sylvester's criterion: all leading minors are positive.
bool is_positive_definite(const Symmetric& m) {
    const auto [a, b, c, d, e, f] = m;  // rows (a), (b c), (d e f)
    return a > 0 && a * c - b * b > 0 && a * (c * f - e * e) - b * (b * f - e * d) + d * (b * e - c * d) > 0;
}

/// Are all lengths under `metric` within the limits of those under `own`? Both limits are statements on quadratic forms.
bool is_stretch_allowed(const ShapeMetric& metric, const ShapeMetric& own) {
    if (metric == own) return true;
    return is_positive_definite(difference(metric, least_stretch2, own)) && is_positive_definite(difference(own, 1 / most_stretch2, metric));
}

struct Instance {
    ObjectRun objects;
    double texels = 0;
};

std::vector<Instance> instances_of(const Scene& scene, double density) {
    std::vector<Instance> instances;
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
        const Object& object = scene.objects[o];
        if (o == 0 || object.instance != scene.objects[o - 1].instance) instances.push_back({{o, 0}, 0});
        ++instances.back().objects.count;
        const double own = object.texels_per_metre > 0 ? static_cast<double>(object.texels_per_metre) : density;
        for (std::uint32_t t = 0; t < object.triangle_count; ++t) instances.back().texels += scene.area_m2(object.first_triangle + t) * own * own;
    }
    std::erase_if(instances, [&](const Instance& instance) { return !scene.objects[instance.objects.first].has_lightmap; });
    return instances;
}

/// Same primitives with the same triangles; sizes aside.
bool same_mesh(const Scene& scene, const ObjectRun& a, const ObjectRun& b) {
    for (std::uint32_t k = 0; k < a.count; ++k) {
        const Object &p = scene.objects[a.first + k], &q = scene.objects[b.first + k];
        const auto kept = scene.source_triangle.begin();  // rounding may have cost one copy a triangle that another kept
        if (p.triangle_count != q.triangle_count || p.vertex_count != q.vertex_count ||
            !std::equal(kept + p.first_triangle, kept + p.first_triangle + p.triangle_count, kept + q.first_triangle))
            return false;
    }
    return true;
}

bool can_share(const Scene& scene, const Instance& own, const Instance& copy, double most_texels) {
    const ShapeMetric &metric = scene.objects[copy.objects.first].metric, &own_metric = scene.objects[own.objects.first].metric;
    return scene.objects[copy.objects.first].texels_per_metre == scene.objects[own.objects.first].texels_per_metre && same_mesh(scene, own.objects, copy.objects) &&
           (own.texels > most_texels ? metric == own_metric : is_stretch_allowed(metric, own_metric));
}

/// What copies have in common for sure: contents and numbers of their primitives.
using Contents = std::vector<std::pair<std::uint64_t, std::uint32_t>>;

Contents contents_of(const Scene& scene, const ObjectRun& run) {
    Contents contents;
    for (std::uint32_t o = run.first; o < run.first + run.count; ++o)
        contents.emplace_back(scene.objects[o].content_hash, scene.objects[o].primitive);
    return contents;
}

/// Each takes the first larger one that it can share with; `candidates` show the same contents, in the scene's order.
void group(const Scene& scene, const std::vector<Instance>& instances, std::vector<std::uint32_t> candidates, double most_texels,
           std::vector<CopyGroup>& out) {
    std::stable_sort(candidates.begin(), candidates.end(), [&](std::uint32_t a, std::uint32_t b) { return instances[a].texels > instances[b].texels; });
    std::vector<std::vector<std::uint32_t>> groups;
    for (const std::uint32_t i : candidates) {
        const auto found = std::find_if(groups.begin(), groups.end(), [&](const std::vector<std::uint32_t>& g) {
            return can_share(scene, instances[g[0]], instances[i], most_texels);
        });
        if (found != groups.end()) found->push_back(i);
        else groups.push_back({i});
    }
    for (std::vector<std::uint32_t>& g : groups) {
        if (g.size() == 1 && !scene.objects[instances[g[0]].objects.first].shares_node) continue;
        std::sort(g.begin() + 1, g.end());
        CopyGroup& made = out.emplace_back();
        for (const std::uint32_t i : g) made.instances.push_back(instances[i].objects);
    }
}

}  // namespace

std::vector<CopyGroup> find_copies(const Scene& scene, double density, double most_texels) {
    const std::vector<Instance> instances = instances_of(scene, density);
    std::map<Contents, std::vector<std::uint32_t>> by_contents;
    for (std::uint32_t i = 0; i < instances.size(); ++i) by_contents[contents_of(scene, instances[i].objects)].push_back(i);
    std::vector<CopyGroup> groups;
    for (auto& [contents, candidates] : by_contents) group(scene, instances, std::move(candidates), most_texels, groups);
    return groups;
}

}  // namespace luxel
