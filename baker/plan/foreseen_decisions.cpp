#include "baker/plan/foreseen_decisions.h"

#include <algorithm>

#include "baker/plan/open_rays.h"

namespace luxel {
namespace {

constexpr std::uint64_t bytes_per_pair = 6;  ///< of a block that is decoded: a column and an exchange area

void foresee_sky(const BakedGeometry& g, Decision& sky) {
    const std::vector<std::uint32_t> open = count_open_rays(g);
    if (!std::ranges::all_of(open, [](std::uint32_t rays) { return rays == 0; })) return;
    sky.runs = false;
    sky.why = "no surface sees it, as far as " + std::to_string(open_rays_of_patch) + " rays of each patch tell";
}

}  // namespace

void foresee_decisions(const BakeOptions& options, const BakedGeometry& g, std::span<const SceneFinding> findings, std::uint64_t pairs, std::uint64_t cache_bytes,
                       std::vector<Decision>& decisions) {
    for (Decision& decision : decisions)
        if (decision.part == part_name(Part::sky) && decision.runs && !options.forced.has(Part::sky)) foresee_sky(g, decision);
    const auto unlit = std::ranges::find(findings, "unlit-surfaces", &SceneFinding::code);
    if (unlit != findings.end() && options.gather_rays) decisions.push_back(decide_part(options, Part::dark_patches, false, unlit->text.substr(0, unlit->text.find(':'))));
    const std::uint64_t bytes = pairs * bytes_per_pair;
    decisions.push_back(decide_part(options, Part::disk, bytes > cache_bytes,
                                    "decoded blocks take about " + std::to_string(bytes >> 20) + " MB, the solve may keep " + std::to_string(cache_bytes >> 20) + " MB of them"));
}

}  // namespace luxel
