#include "baker/bake/split_stage.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "baker/chunks/sight_graph.h"
#include "formats/gltf/gltf_in.h"

namespace luxel {
namespace {

constexpr std::uint32_t rays_per_patch = 4;
constexpr std::uint32_t no_group = 0xffffffffu;

/// Nodes that are loaded together.
struct Group {
    std::uint64_t triangles = 0;
    std::array<double, 3> low, high;  ///< m
    std::map<std::uint32_t, std::uint64_t> rays;
    Group() {
        low.fill(std::numeric_limits<double>::infinity());
        high.fill(-std::numeric_limits<double>::infinity());
    }
    void add_bounds(const std::array<double, 3>& least, const std::array<double, 3>& most) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], least[k]);
            high[k] = std::max(high[k], most[k]);
        }
    }
    [[nodiscard]] double distance2(const Group& other) const {
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double apart = (low[k] + high[k] - other.low[k] - other.high[k]) / 2;
            sum += apart * apart;
        }
        return sum;
    }
};

std::size_t node_of_object(const BakedGeometry& g, std::uint32_t object) {
    return static_cast<std::size_t>(g.record.instances[g.scene.objects[object].instance].node);
}

std::size_t node_count(const BakedGeometry& g) {
    const auto nodes = g.document.json.find("nodes");
    return nodes == g.document.json.end() ? 0 : nodes->size();
}

/// Per node the chunk where most of its surface lies, numbered without gaps; no_group for nodes without patches.
std::vector<std::uint32_t> group_by_chunk(const BakedGeometry& g, std::uint32_t& group_count) {
    std::vector<std::map<ChunkNumber, double>> areas(node_count(g));
    for (ChunkNumber chunk = 0; chunk < g.layout.chunk_count(); ++chunk)
        for (PatchNumber p = g.layout.first_patch[chunk]; p < g.layout.first_patch[chunk + 1]; ++p)
            areas[node_of_object(g, g.atlas.charts[g.patches.patches[p].chart].object)][chunk] += static_cast<double>(g.patches.patches[p].area_m2);
    std::vector<std::uint32_t> group_of_chunk(g.layout.chunk_count(), no_group), groups(areas.size(), no_group);
    std::vector<ChunkNumber> chunks(areas.size());
    for (std::size_t node = 0; node < areas.size(); ++node) {
        if (areas[node].empty()) continue;
        chunks[node] = std::ranges::max_element(areas[node], {}, [](const auto& entry) { return entry.second; })->first;
        group_of_chunk[chunks[node]] = 0;
    }
    group_count = 0;
    for (std::uint32_t& group : group_of_chunk)
        if (group != no_group) group = group_count++;
    for (std::size_t node = 0; node < areas.size(); ++node)
        if (!areas[node].empty()) groups[node] = group_of_chunk[chunks[node]];
    return groups;
}

void add_surface(const BakedGeometry& g, std::uint32_t object, Group& group) {
    const Object& run = g.scene.objects[object];
    group.triangles += run.triangle_count;
    for (std::uint32_t t = run.first_triangle; t < run.first_triangle + run.triangle_count; ++t)
        for (int k = 0; k < 3; ++k) {
            const Vec3f& corner = g.scene.corner(t, k);
            const std::array<double, 3> point{g.scene.origin.x + static_cast<double>(corner.x), g.scene.origin.y + static_cast<double>(corner.y),
                                              g.scene.origin.z + static_cast<double>(corner.z)};
            group.add_bounds(point, point);
        }
}

std::vector<Group> measure_groups(const BakeOptions& options, const BakedGeometry& g, const std::vector<std::uint32_t>& group_of_node,
                                  std::uint32_t group_count) {
    std::vector<Group> groups(group_count);
    for (std::uint32_t object = 0; object < g.scene.objects.size(); ++object)
        if (const std::uint32_t group = group_of_node[node_of_object(g, object)]; group != no_group) add_surface(g, object, groups[group]);
    const double edge_m = std::exp2(std::ceil(std::log2(4 * static_cast<double>(patch_side_m(options, g.atlas)))));
    const SightCells cells = find_sight_cells(g.patches, edge_m);
    const SightGraph sight = trace_sight(g.scene, g.atlas, g.patches, *g.tracer, cells, rays_per_patch);
    std::vector<std::uint32_t> group_of_cell;  // all patches of a cell lie on one chart
    for (const auto& members : cells.patches)
        group_of_cell.push_back(group_of_node[node_of_object(g, g.atlas.charts[g.patches.patches[members.front()].chart].object)]);
    const SightGraph joined = join_nodes(sight, group_of_cell, group_count);
    for (std::uint32_t group = 0; group < group_count; ++group)
        for (const SightGraph::Link& link : joined.links_of(group)) groups[group].rays[link.other] = link.rays;
    return groups;
}

/// Whom a group joins: who sees most of it, else who is nearest; the lowest number of equals.
std::uint32_t choose_partner(const std::vector<Group>& groups, const std::vector<bool>& is_gone, std::uint32_t small) {
    std::uint32_t best = no_group;
    std::uint64_t most = 0;
    for (const auto& [other, rays] : groups[small].rays)
        if (rays > most) most = rays, best = other;
    if (best != no_group) return best;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t other = 0; other < groups.size(); ++other)
        if (other != small && !is_gone[other] && groups[small].distance2(groups[other]) < least)
            least = groups[small].distance2(groups[other]), best = other;
    return best;
}

/// `from` becomes a part of `into`: triangles, bounds, and what sees them.
void merge(std::vector<Group>& groups, std::uint32_t from, std::uint32_t into) {
    Group& gone = groups[from];
    groups[into].triangles += gone.triangles;
    groups[into].add_bounds(gone.low, gone.high);
    for (const auto& [other, rays] : gone.rays) {
        groups[other].rays.erase(from);
        if (other == into) continue;
        groups[other].rays[into] += rays;
        groups[into].rays[other] += rays;
    }
    gone = Group();
}

}  // namespace

SplitPlan plan_split(const BakeOptions& options, const BakedGeometry& geometry) {
    std::uint32_t count = 0;
    const std::vector<std::uint32_t> group_of_node = group_by_chunk(geometry, count);
    std::vector<Group> groups = measure_groups(options, geometry, group_of_node, count);
    std::vector<std::uint32_t> joined(count);
    std::vector<bool> is_gone(count, false);
    for (std::uint32_t group = 0; group < count; ++group) joined[group] = group;
    for (std::uint32_t left = count; left > 1;) {
        std::uint32_t small = no_group;
        for (std::uint32_t group = 0; group < count; ++group)
            if (!is_gone[group] && groups[group].triangles < options.split_triangles &&
                (small == no_group || groups[group].triangles < groups[small].triangles))
                small = group;
        if (small == no_group) break;
        const std::uint32_t partner = choose_partner(groups, is_gone, small);
        if (partner == no_group) break;
        merge(groups, small, partner);
        is_gone[small] = true;
        joined[small] = partner;
        --left;
    }
    SplitPlan plan;
    std::vector<std::uint32_t> number(count, no_group);
    for (std::uint32_t group = 0; group < count; ++group)
        if (!is_gone[group]) number[group] = static_cast<std::uint32_t>(plan.split.part_count++);
    for (const std::uint32_t group : group_of_node) {
        std::uint32_t last = group;
        while (last != no_group && is_gone[last]) last = joined[last];
        plan.split.part_of_node.push_back(last == no_group ? -1 : static_cast<std::int64_t>(number[last]));
    }
    plan.rays.resize(plan.split.part_count);
    for (std::uint32_t group = 0; group < count; ++group)
        if (!is_gone[group])
            for (const auto& [other, rays] : groups[group].rays) plan.rays[number[group]][number[other]] = rays;
    if (!options.scene.empty()) plan.split.scene = find_scene(geometry.document, options.scene);
    return plan;
}

namespace {

ChunkFile file_entry(const BakedGeometry& g, const GltfPart& part) {
    ChunkFile entry{part.file.filename().string(), std::filesystem::file_size(part.file), {}};
    std::map<std::uint64_t, std::string> paths;
    for (const InstanceRecord& instance : g.record.instances)
        if (instance.gpu_instance <= 0) paths[static_cast<std::uint64_t>(instance.node)] = instance.node_path;
    for (const std::uint64_t node : part.nodes)
        if (const auto path = paths.find(node); path != paths.end()) entry.nodes.push_back(path->second);
    return entry;
}

}  // namespace

ChunkIndex index_of_parts(const BakeOptions& options, const BakedGeometry& geometry, const SplitPlan& plan, const GltfParts& parts) {
    ChunkIndex index;
    index.generator = options.software;
    index.model = options.output.filename().string();
    if (parts.common) index.common = file_entry(geometry, *parts.common);
    for (const auto& picture : parts.pictures) index.pictures.push_back(picture.filename().string());
    std::vector<std::uint32_t> number(parts.parts.size(), no_group), part_of_node(node_count(geometry), no_group);
    for (std::size_t part = 0; part < parts.parts.size(); ++part) {
        if (parts.parts[part].file.empty()) continue;
        number[part] = static_cast<std::uint32_t>(index.chunks.size());
        for (const std::uint64_t node : parts.parts[part].nodes) part_of_node[node] = static_cast<std::uint32_t>(part);
        ChunkEntry& entry = index.chunks.emplace_back();
        static_cast<ChunkFile&>(entry) = file_entry(geometry, parts.parts[part]);
        entry.pages = parts.parts[part].pages;
    }
    std::vector<Group> surfaces(parts.parts.size());
    for (std::uint32_t object = 0; object < geometry.scene.objects.size(); ++object)
        if (const std::uint32_t part = part_of_node[node_of_object(geometry, object)]; part != no_group)
            add_surface(geometry, object, surfaces[part]);
    for (std::size_t part = 0; part < parts.parts.size(); ++part) {
        if (number[part] == no_group) continue;
        ChunkEntry& entry = index.chunks[number[part]];
        entry.triangles = surfaces[part].triangles;
        entry.low = surfaces[part].low;
        entry.high = surfaces[part].high;
        for (const auto& [other, rays] : plan.rays[part])
            if (number[other] != no_group) entry.neighbours.push_back({number[other], rays});
        std::ranges::stable_sort(entry.neighbours, std::ranges::greater(), &ChunkNeighbour::rays);
    }
    return index;
}

}  // namespace luxel
