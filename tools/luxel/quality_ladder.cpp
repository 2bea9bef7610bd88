#include "tools/luxel/quality_ladder.h"

#include <algorithm>
#include <array>

namespace luxel {
namespace {

struct Rung {
    const char* quality;
    std::uint32_t gather_rays;  ///< 0: as the preset has it
};
constexpr std::array ladder{Rung{"draft", 0}, Rung{"medium", 16}, Rung{"medium", 32}, Rung{"medium", 64}, Rung{"medium", 0},
                            Rung{"medium", 256}, Rung{"medium", 512}, Rung{"high", 0}, Rung{"high", 2048}};
constexpr std::array decided_by_time{"--quality", "--rays", "--gather", "--gather-rays", "--lamp-points", "--max-rays", "--tolerance", "--error"};

NamedOptions named(BakeArguments arguments, const CLI::App& command, const Rung& rung) {
    arguments.quality = rung.quality;
    NamedOptions choice{rung.quality, resolve_bake_options(arguments, command)};
    if (rung.gather_rays == 0) return choice;
    choice.options.gather_rays = rung.gather_rays;
    choice.options.most_gather_rays = 16 * rung.gather_rays;
    choice.name += " --gather-rays " + std::to_string(rung.gather_rays);
    return choice;
}

}  // namespace

std::vector<NamedOptions> all_presets(const BakeArguments& arguments, const CLI::App& command) {
    std::vector<NamedOptions> presets;
    for (const char* quality : qualities) presets.push_back(named(arguments, command, {quality, 0}));
    return presets;
}

std::vector<NamedOptions> quality_ladder(const BakeArguments& arguments, const CLI::App& command) {
    for (const char* option : decided_by_time)
        if (command.count("--target-seconds") > 0 && command.count(option) > 0)
            throw Error(ErrorCode::usage, "--target-seconds", std::string("expected no ") + option + " beside it: the time decides", "leave out one of the two");
    std::vector<NamedOptions> choices;
    for (const Rung& rung : ladder) choices.push_back(named(arguments, command, rung));
    return choices;
}

void adapt_to_seconds(BakeOptions& options, const BakeArguments& arguments, const CLI::App& command, TimeChoice& choice) {
    if (command.count("--target-seconds") == 0) return;
    options.adapt = [&arguments, &choice, choices = quality_ladder(arguments, command)](BakeOptions& adapted, const BakedGeometry& geometry, double seconds) {
        choice.foreseen = best_within(arguments.target_seconds, choices, geometry, seconds);
        choice.chosen = *std::ranges::find(choices, choice.foreseen.name, &NamedOptions::name);
        take(choice.chosen, adapted);
    };
}

void take(const NamedOptions& chosen, BakeOptions& options) {
    options.rays = chosen.options.rays;
    options.gather_rays = chosen.options.gather_rays;
    options.most_gather_rays = chosen.options.most_gather_rays;
    options.lamp_points = chosen.options.lamp_points;
    options.tolerance = chosen.options.tolerance;
}

}  // namespace luxel
