/// Joins what sees each other most, again and again: a tree whose lower nodes are corners and furniture, and whose
/// upper ones are rooms and flats, up to a size.
///
/// Two nodes join when each is the one that the other sees most of those it fits together with, by rays over the
/// product of their sizes (average linkage, mutual nearest neighbours). Average linkage is reducible (Bruynooghe 1977;
/// Murtagh 1983): a join never brings anything nearer, so below the limit the tree is that of joining the closest pair
/// of all each time, in any order. That makes it local: what happens in one room does not wait for another. Pure;
/// integers and exact quotients only, ties by the order of nodes.
#pragma once
#include <cstdint>
#include <vector>

#include "baker/chunks/sight_graph.h"

namespace luxel {

struct RoomNode {
    std::uint32_t left = none, right = none;  ///< children; none for leaves, which are the nodes of the graph
    std::uint32_t patches = 0;
    std::uint64_t between = 0;  ///< rays between left and right
};

struct RoomTree {
    std::vector<RoomNode> nodes;       ///< the leaves first, in the graph's order; children before parents
    std::vector<std::uint32_t> roots;  ///< what sees nothing else that it could join
};

/// `limit`: nodes of more patches are not made; a leaf may be larger.
RoomTree build_room_tree(const SightGraph& graph, std::uint32_t limit);

/// The leaves below a node, ascending.
std::vector<std::uint32_t> leaves_below(const RoomTree& tree, std::uint32_t node);

}  // namespace luxel
