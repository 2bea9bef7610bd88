#include "baker/chunks/room_chunks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "baker/chunks/room_tree.h"
#include "baker/chunks/space_halving.h"

namespace luxel {
namespace {

using Cells = std::vector<std::uint32_t>;

/// Step 3. Joining pairs can end with chunks that are a little over half full everywhere; giving away one of them fills
/// others.
class Dissolver {
  public:
    Dissolver(const SightGraph& graph, const RoomTree& tree, std::uint32_t limit)
        : graph_(graph),
          tree_(tree),
          limit_(limit),
          group_of_(graph.count()),
          groups_(tree.roots.size()),
          patches_(tree.roots.size()),
          received_(tree.roots.size(), false) {
        for (std::uint32_t g = 0; g < tree.roots.size(); ++g) {
            groups_[g] = leaves_below(tree, tree.roots[g]);
            patches_[g] = tree.nodes[tree.roots[g]].patches;
            for (const std::uint32_t cell : groups_[g]) group_of_[cell] = g;
        }
    }

    /// Sets of cells, each ascending; none is empty.
    std::vector<Cells> run() {
        std::vector<std::uint32_t> order(groups_.size());
        std::iota(order.begin(), order.end(), 0u);
        std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            return std::pair(patches_[a], a) < std::pair(patches_[b], b);
        });
        for (const std::uint32_t group : order)
            if (!received_[group]) dissolve(group);
        std::erase_if(groups_, [](const Cells& cells) { return cells.empty(); });
        for (Cells& cells : groups_) std::sort(cells.begin(), cells.end());
        return std::move(groups_);
    }

  private:
    struct Move {
        Cells cells;
        std::uint32_t to;
    };

    void dissolve(std::uint32_t group) {
        std::vector<Move> moves;
        std::map<std::uint32_t, std::uint32_t> added;  // patches per receiving group
        std::uint64_t lost = 0, won = 0;
        std::vector<std::uint32_t> pieces{tree_.roots[group]};
        while (!pieces.empty()) {
            const RoomNode& piece = tree_.nodes[pieces.back()];
            Cells cells = leaves_below(tree_, pieces.back());
            pieces.pop_back();
            const auto [to, rays] = best_receiver(cells, piece.patches, group, added);
            if (to != none) {
                won += rays;
                added[to] += piece.patches;
                moves.push_back({std::move(cells), to});
                continue;
            }
            lost += piece.between;
            if (piece.left == none || moves.size() + pieces.size() >= most_pieces) return;
            pieces.push_back(piece.left);
            pieces.push_back(piece.right);
        }
        if (won < lost) return;
        for (const Move& move : moves) {
            groups_[move.to].insert(groups_[move.to].end(), move.cells.begin(), move.cells.end());
            for (const std::uint32_t cell : move.cells) group_of_[cell] = move.to;
            received_[move.to] = true;
        }
        for (const auto& [to, patches] : added) patches_[to] += patches;
        groups_[group].clear();
    }

    /// Of the groups with space, the one that these cells see most, and by how many rays; none if there is none.
    std::pair<std::uint32_t, std::uint64_t> best_receiver(const Cells& cells, std::uint32_t patches, std::uint32_t from,
                                                          const std::map<std::uint32_t, std::uint32_t>& added) const {
        std::map<std::uint32_t, std::uint64_t> seen;
        for (const std::uint32_t cell : cells)
            for (const SightGraph::Link& link : graph_.links_of(cell)) seen[group_of_[link.other]] += link.rays;
        std::pair<std::uint32_t, std::uint64_t> best{none, 0};
        for (const auto& [group, rays] : seen) {
            const auto more = added.find(group);
            const std::uint64_t size =
                std::uint64_t{patches_[group]} + patches + (more == added.end() ? 0 : more->second);
            if (group != from && size <= limit_ && rays > best.second) best = {group, rays};
        }
        return best;
    }

    static constexpr std::size_t most_pieces = 16;  ///< more would be shreds
    const SightGraph& graph_;
    const RoomTree& tree_;
    std::uint32_t limit_;
    std::vector<std::uint32_t> group_of_;  ///< per cell
    std::vector<Cells> groups_;
    std::vector<std::uint32_t> patches_;  ///< per group
    std::vector<bool> received_;          ///< groups that are no longer a node of the tree
};

std::uint64_t patches_in(const SightGraph& graph, const Cells& group) {
    std::uint64_t patches = 0;
    for (const std::uint32_t cell : group) patches += graph.patches[cell];
    return patches;
}

Vec3d mean_place(const SightCells& cells, const Cells& group) {
    Vec3d sum(0, 0, 0);
    for (const std::uint32_t cell : group) sum += cells.middle[cell];
    return sum / static_cast<double>(group.size());
}

/// Step 4. Small groups are put together, and what is still small is added to the nearest group with space.
void join_small_by_place(const SightCells& cells, const SightGraph& graph, std::uint32_t limit,
                         std::vector<Cells>& groups) {
    const std::uint32_t small_patches = limit / 4;
    Cells small;
    std::erase_if(groups, [&](const Cells& group) {
        const bool is_small = patches_in(graph, group) < small_patches;
        if (is_small) small.insert(small.end(), group.begin(), group.end());
        return is_small;
    });
    std::sort(small.begin(), small.end());
    std::vector<Vec3d> places;
    for (const Cells& group : groups) places.push_back(mean_place(cells, group));
    for (const Cells& rest : halve_space(cells.middle, graph.patches, std::move(small), limit)) {
        const std::uint64_t patches = patches_in(graph, rest);
        const Vec3d place = mean_place(cells, rest);
        Cells* nearest = nullptr;
        double least = std::numeric_limits<double>::max();
        for (std::size_t g = 0; patches < small_patches && g < places.size(); ++g) {
            const double distance = (places[g] - place).length();
            if (distance < least && patches_in(graph, groups[g]) + patches <= limit)
                nearest = &groups[g], least = distance;
        }
        if (nearest)
            nearest->insert(nearest->end(), rest.begin(), rest.end());
        else
            groups.push_back(rest);
    }
}

}  // namespace

std::vector<std::vector<PatchNumber>> group_into_rooms(const SightCells& cells, const SightGraph& graph,
                                                       std::uint32_t limit) {
    const RoomTree tree = build_room_tree(graph, limit);
    std::vector<Cells> groups = Dissolver(graph, tree, limit).run();
    join_small_by_place(cells, graph, limit, groups);
    std::vector<std::vector<PatchNumber>> chunks;
    for (const Cells& group : groups) {
        std::vector<PatchNumber> members;
        for (const std::uint32_t cell : group)
            members.insert(members.end(), cells.patches[cell].begin(), cells.patches[cell].end());
        std::sort(members.begin(), members.end());
        // A single cell may be larger than a small limit.
        for (auto begin = members.begin(); begin != members.end();) {
            const auto end = members.end() - begin > std::ptrdiff_t{limit} ? begin + limit : members.end();
            chunks.emplace_back(begin, end);
            begin = end;
        }
    }
    std::sort(chunks.begin(), chunks.end(), [](const auto& a, const auto& b) { return a.front() < b.front(); });
    return chunks;
}

Tiling find_room_chunks(const Scene& scene, const Atlas& atlas, const PatchSet& patches, const Tracer& tracer,
                        const RoomOptions& options) {
    // A power of two, so that halvings of space never cut a cell.
    const double edge_m = std::exp2(std::ceil(std::log2(4 * static_cast<double>(options.patch_side_m))));
    const SightCells cells = find_sight_cells(patches, edge_m);
    const SightGraph graph = trace_sight(scene, atlas, patches, tracer, cells, options.rays_per_patch);
    const std::uint32_t limit = std::clamp(options.chunk_patches, 1u, ChunkLayout::max_chunk_patches);
    return number_chunks(group_into_rooms(cells, graph, limit), patches.count());
}

}  // namespace luxel
