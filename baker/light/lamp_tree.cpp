#include "baker/light/lamp_tree.h"

#include <algorithm>
#include <cmath>

#include "baker/light/lamps.h"

namespace luxel {
namespace {

double power_of(const Lamp& lamp) { return static_cast<double>(lamp.intensity.x) + static_cast<double>(lamp.intensity.y) + static_cast<double>(lamp.intensity.z); }

/// What is left of `random` for the next choice.
double rest_of(double random, double before, double share) { return std::clamp((random - before) / share, 0.0, 0x1.fffffep-1); }

}  // namespace

LampTree::LampTree(std::span<const Lamp> lamps) : lamps_(lamps) {
    for (std::uint32_t k = 0; k < lamps.size(); ++k) order_.push_back(k);
    const auto ends = std::stable_partition(order_.begin(), order_.end(), [&](std::uint32_t k) { return lamps[k].kind != LampKind::directional; });
    directional_ = static_cast<std::uint32_t>(ends - order_.begin());
    if (directional_ > 0) add_node(0, directional_);
}

std::uint32_t LampTree::add_node(std::uint32_t first, std::uint32_t end) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    Vec3f low = lamps_[order_[first]].position, high = low;
    Node node{{}, 0, 0, 0, first, end, 0};
    for (std::uint32_t k = first; k < end; ++k) {
        const Lamp& lamp = lamps_[order_[k]];
        for (int axis = 0; axis < 3; ++axis) low[axis] = std::min(low[axis], lamp.position[axis]), high[axis] = std::max(high[axis], lamp.position[axis]);
        node.power += power_of(lamp);
        node.reach_m = std::max(node.reach_m, lamp.range > 0 ? lamp.range : INFINITY);
    }
    node.center = low + (high - low) * 0.5f;
    for (std::uint32_t k = first; k < end; ++k) node.radius_m = std::max(node.radius_m, (lamps_[order_[k]].position - node.center).length() + lamps_[order_[k]].radius);
    nodes_.push_back(node);
    if (end - first <= leaf_lamps) return index;
    const Vec3f size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::uint32_t middle = first + (end - first) / 2;
    std::sort(order_.begin() + first, order_.begin() + end, [&](std::uint32_t a, std::uint32_t b) {
        const float at_a = lamps_[a].position[axis], at_b = lamps_[b].position[axis];
        return at_a != at_b ? at_a < at_b : a < b;
    });
    add_node(first, middle);
    nodes_[index].right = add_node(middle, end);
    return index;
}

double LampTree::importance(const Node& node, const LitPoint& at) {
    const Vec3f to_center = node.center - at.position;
    const float distance = to_center.length();
    if (distance - node.radius_m >= node.reach_m) return 0;
    const float nearest = std::max({distance, node.radius_m, 1e-12f});  // from inside the ball any distance is possible
    const float cosine = std::clamp((to_center.dot(at.normal) + node.radius_m) / nearest, 0.0f, 1.0f);
    return node.power * static_cast<double>(cosine) / (static_cast<double>(nearest) * static_cast<double>(nearest));
}

double LampTree::strength(std::uint32_t lamp, const LitPoint& at, float spot_m) const {
    const float plain = lamp_strength(lamps_[lamp], at.position, 0, &at.normal);
    return plain > 0 ? static_cast<double>(plain) * static_cast<double>(spread_in_spot(lamps_[lamp], at.position, at.normal, spot_m)) : 0;
}

std::optional<LampTable::Choice> LampTree::choose_of(std::uint32_t first, std::uint32_t end, const LitPoint& at, double random, float spot_m) const {
    double total = 0;
    for (std::uint32_t k = first; k < end; ++k) total += strength(order_[k], at, spot_m);
    if (!(total > 0)) return {};
    std::optional<LampTable::Choice> chosen;  // the last one with light, where rounding leaves a little
    double before = 0;
    for (std::uint32_t k = first; k < end; ++k) {
        const double share = strength(order_[k], at, spot_m) / total;
        if (!(share > 0)) continue;
        chosen = {order_[k], static_cast<float>(share), static_cast<float>(rest_of(random, before, share))};
        before += share;
        if (random < before) break;
    }
    return chosen;
}

std::optional<LampTable::Choice> LampTree::choose(const LitPoint& at, float random, float spot_m) const {
    double left = static_cast<double>(random), probability = 1;
    const auto take = [&](double before, double share) { left = rest_of(left, before, share), probability *= share; };
    const auto finish = [&](std::uint32_t first, std::uint32_t end) {
        auto chosen = choose_of(first, end, at, left, spot_m);
        if (chosen) chosen->probability *= static_cast<float>(probability);
        return chosen;
    };
    double by_tree = nodes_.empty() ? 0 : importance(nodes_.front(), at), from_afar = 0;
    for (std::size_t k = directional_; k < order_.size(); ++k) from_afar += strength(order_[k], at, spot_m);
    if (!(by_tree + from_afar > 0)) return {};
    by_tree /= by_tree + from_afar;
    if (left >= by_tree) {
        take(by_tree, 1 - by_tree);
        return finish(directional_, static_cast<std::uint32_t>(order_.size()));
    }
    take(0, by_tree);
    std::uint32_t node = 0;
    while (nodes_[node].right != 0) {
        const double a = importance(nodes_[node + 1], at), b = importance(nodes_[nodes_[node].right], at);
        if (!(a + b > 0)) return {};
        const double first = a / (a + b);
        if (left < first) {
            take(0, first), node = node + 1;
        } else {
            take(first, 1 - first), node = nodes_[node].right;
        }
    }
    return finish(nodes_[node].first, nodes_[node].end);
}

}  // namespace luxel
