/// The tree of rooms: what sees each other most is joined first, never beyond the limit, whatever the numbers of the
/// nodes.
#include "baker/chunks/room_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <set>

namespace luxel {
namespace {

using Pairs = std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>;

SightGraph graph_of(const std::vector<std::uint32_t>& patches, const Pairs& pairs) {
    std::vector<std::vector<SightGraph::Link>> rows(patches.size());
    for (const auto& [pair, rays] : pairs) {
        rows[pair.first].push_back({pair.second, rays});
        rows[pair.second].push_back({pair.first, rays});
    }
    SightGraph graph;
    graph.patches = patches;
    for (const auto& row : rows) {
        graph.links.insert(graph.links.end(), row.begin(), row.end());
        graph.row_begin.push_back(graph.links.size());
    }
    return graph;
}

/// `rooms` rooms of `cells` cells that see all of their room about alike and, by doors, a little of the next.
Pairs rooms_in_a_row(std::uint32_t rooms, std::uint32_t cells, unsigned seed) {
    std::mt19937_64 random(seed);
    Pairs pairs;
    for (std::uint32_t r = 0; r < rooms; ++r)
        for (std::uint32_t i = r * cells; i < (r + 1) * cells; ++i) {
            for (std::uint32_t j = i + 1; j < (r + 1) * cells; ++j)
                pairs[{i, j}] = 50 + static_cast<std::uint32_t>(random() % 50);
            if (r + 1 < rooms)
                pairs[{i, (r + 1) * cells + static_cast<std::uint32_t>(random() % cells)}] =
                    1 + static_cast<std::uint32_t>(random() % 5);
        }
    return pairs;
}

using Sets = std::set<std::vector<std::uint32_t>>;

Sets groups(const RoomTree& tree) {
    Sets sets;
    for (const std::uint32_t root : tree.roots) sets.insert(leaves_below(tree, root));
    return sets;
}

TEST(RoomTree, RoomsJoinBeforeDoors) {
    const std::uint32_t rooms = 5, cells = 12, size = 20;
    const SightGraph graph = graph_of(std::vector<std::uint32_t>(rooms * cells, size), rooms_in_a_row(rooms, cells, 1));
    Sets expected;
    for (std::uint32_t r = 0; r < rooms; ++r) {
        std::vector<std::uint32_t> room(cells);
        std::iota(room.begin(), room.end(), r * cells);
        expected.insert(room);
    }
    EXPECT_EQ(groups(build_room_tree(graph, cells * size)), expected);
    EXPECT_EQ(groups(build_room_tree(graph, 2 * cells * size - 1)), expected);
    EXPECT_EQ(build_room_tree(graph, 2 * cells * size).roots.size(), 3u) << "pairs of rooms, and one alone";
    EXPECT_EQ(build_room_tree(graph, 100000).roots.size(), 1u);
}

TEST(RoomTree, NodesAreWithinTheLimitAndAddUp) {
    std::mt19937_64 random(2);
    std::vector<std::uint32_t> patches;
    for (int k = 0; k < 60; ++k) patches.push_back(1 + static_cast<std::uint32_t>(random() % 40));
    const Pairs pairs = rooms_in_a_row(5, 12, 3);
    for (const std::uint32_t limit : {1u, 30u, 100u, 1000u}) {
        const RoomTree tree = build_room_tree(graph_of(patches, pairs), limit);
        std::vector<int> met(patches.size(), 0);
        for (const std::uint32_t root : tree.roots)
            for (const std::uint32_t leaf : leaves_below(tree, root)) ++met[leaf];
        EXPECT_EQ(met, std::vector<int>(patches.size(), 1));
        for (const RoomNode& node : tree.nodes) {
            if (node.left == none) continue;
            EXPECT_LE(node.patches, limit);
            EXPECT_EQ(node.patches, tree.nodes[node.left].patches + tree.nodes[node.right].patches);
            std::uint64_t rays = 0;
            for (const std::uint32_t i : leaves_below(tree, node.left))
                for (const std::uint32_t j : leaves_below(tree, node.right))
                    if (const auto at = pairs.find(std::minmax(i, j)); at != pairs.end()) rays += at->second;
            EXPECT_EQ(node.between, rays);
            EXPECT_GT(rays, 0u) << "what does not see each other is not joined";
        }
    }
}

TEST(RoomTree, NumbersOfNodesDoNotMatter) {
    // Rays so different that no two pairs are equally close.
    Pairs pairs = rooms_in_a_row(4, 10, 4);
    std::mt19937_64 random(5);
    for (auto& [pair, rays] : pairs) rays = rays * 100000 + static_cast<std::uint32_t>(random() % 100000);
    const std::vector<std::uint32_t> patches(40, 20);
    const Sets before = groups(build_room_tree(graph_of(patches, pairs), 250));
    std::vector<std::uint32_t> number(40);
    std::iota(number.begin(), number.end(), 0u);
    for (int round = 0; round < 10; ++round) {
        std::shuffle(number.begin(), number.end(), random);
        Pairs renamed;
        for (const auto& [pair, rays] : pairs) renamed[std::minmax(number[pair.first], number[pair.second])] = rays;
        Sets expected;
        for (const auto& group : before) {
            std::vector<std::uint32_t> other;
            for (const std::uint32_t node : group) other.push_back(number[node]);
            std::sort(other.begin(), other.end());
            expected.insert(other);
        }
        EXPECT_EQ(groups(build_room_tree(graph_of(patches, renamed), 250)), expected);
    }
}

TEST(RoomTree, EqualPairsAndNothingAtAll) {
    Pairs ring;  // every pair of neighbours is equally close
    for (std::uint32_t k = 0; k < 12; ++k) ring[std::minmax(k, (k + 1) % 12)] = 7;
    EXPECT_EQ(build_room_tree(graph_of(std::vector<std::uint32_t>(12, 20), ring), 1000).roots.size(), 1u);
    EXPECT_EQ(build_room_tree(graph_of({5, 5, 5}, {}), 1000).roots.size(), 3u);
    EXPECT_TRUE(build_room_tree(graph_of({}, {}), 1000).roots.empty());
}

}  // namespace
}  // namespace luxel
