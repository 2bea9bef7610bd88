#include "baker/chunks/room_tree.h"

#include <algorithm>
#include <numeric>

namespace luxel {
namespace {

/// Cells of fewer patches count as this many: a single ray between two scraps is chance, not neighbourhood.
constexpr std::uint32_t least_size = 16;

class Joiner {
  public:
    Joiner(const SightGraph& graph, std::uint32_t limit) : graph_(graph), limit_(limit) {
        node_of_.resize(graph.count());
        std::iota(node_of_.begin(), node_of_.end(), 0u);
        for (std::size_t n = 0; n < graph.count(); ++n) {
            tree.nodes.push_back({none, none, graph.patches[n], 0});
            weight_.push_back(std::max<std::uint64_t>(graph.patches[n], least_size));
        }
    }

    /// One round of joins. False when there was none to make.
    bool round() {
        find_nearest();
        std::vector<std::uint32_t> group(graph_.count(), none), node_of;
        std::vector<std::uint64_t> weight;
        for (std::uint32_t n = 0; n < graph_.count(); ++n) {
            if (group[n] != none) continue;
            const auto next = static_cast<std::uint32_t>(node_of.size());
            group[n] = next;
            const std::uint32_t other = nearest_[n].other;
            const bool mutual = other != none && nearest_[other].other == n;
            if (mutual) group[other] = next;
            node_of.push_back(mutual ? join(n, other, nearest_[n].rays) : node_of_[n]);
            weight.push_back(weight_[n] + (mutual ? weight_[other] : 0));
        }
        if (node_of.size() == node_of_.size()) return false;
        graph_ = join_nodes(graph_, group, node_of.size());
        node_of_ = std::move(node_of);
        weight_ = std::move(weight);
        return true;
    }

    RoomTree finish() {
        tree.roots = node_of_;
        return std::move(tree);
    }

    RoomTree tree;

  private:
    std::uint32_t join(std::uint32_t a, std::uint32_t b, std::uint64_t rays) {
        const RoomNode &left = tree.nodes[node_of_[a]], &right = tree.nodes[node_of_[b]];
        tree.nodes.push_back({node_of_[a], node_of_[b], left.patches + right.patches, rays});
        return static_cast<std::uint32_t>(tree.nodes.size() - 1);
    }

    void find_nearest() {
        nearest_.assign(graph_.count(), {none, 0});
        for (std::uint32_t n = 0; n < graph_.count(); ++n) {
            double most = 0;
            for (const SightGraph::Link& link : graph_.links_of(n)) {
                if (std::uint64_t{graph_.patches[n]} + graph_.patches[link.other] > limit_) continue;
                // The same number seen from both ends: counts and products are below 2^53, hence exact.
                const double closeness =
                    static_cast<double>(link.rays) / static_cast<double>(weight_[n] * weight_[link.other]);
                if (closeness < most || (closeness == most && !before(n, link.other, nearest_[n].other))) continue;
                most = closeness;
                nearest_[n] = link;
            }
        }
    }

    /// Order of the pairs (n, a) and (n, b), the same whichever end looks.
    static bool before(std::uint32_t n, std::uint32_t a, std::uint32_t b) {
        return std::minmax(n, a) < std::minmax(n, b);
    }

    SightGraph graph_;
    std::uint32_t limit_;
    std::vector<std::uint32_t> node_of_;  ///< per node of the graph as it is now
    std::vector<std::uint64_t> weight_;
    std::vector<SightGraph::Link> nearest_;
};

}  // namespace

RoomTree build_room_tree(const SightGraph& graph, std::uint32_t limit) {
    Joiner joiner(graph, limit);
    bool joined = true;
    while (joined) joined = joiner.round();
    return joiner.finish();
}

std::vector<std::uint32_t> leaves_below(const RoomTree& tree, std::uint32_t node) {
    std::vector<std::uint32_t> leaves, stack{node};
    while (!stack.empty()) {
        const std::uint32_t at = stack.back();
        stack.pop_back();
        if (tree.nodes[at].left == none) {
            leaves.push_back(at);
        } else {
            stack.push_back(tree.nodes[at].left);
            stack.push_back(tree.nodes[at].right);
        }
    }
    std::sort(leaves.begin(), leaves.end());
    return leaves;
}

}  // namespace luxel
