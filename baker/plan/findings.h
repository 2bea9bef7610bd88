/// What is said about a scene before hours are spent on it.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace luxel {

/// A fault of the scene, or what looks like one. Codes are words of the interface: docs/plan.md lists them.
struct SceneFinding {
    std::string code;
    std::string text;                 ///< what was found, with figures, and what to do
    std::vector<std::string> where;   ///< nodes, materials or lamps, the worst first; at most most_named of `count`
    std::uint64_t count = 0;          ///< how many there are
    static constexpr std::size_t most_named = 8;
};

}  // namespace luxel
