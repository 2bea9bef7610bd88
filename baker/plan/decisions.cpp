#include "baker/plan/decisions.h"

#include <algorithm>

namespace luxel {
namespace {

std::string count_of(std::size_t count, const std::string& what, const char* ending = "s") {
    return std::to_string(count) + " " + what + (count == 1 ? "" : ending);
}

}  // namespace

std::vector<Decision> decide(const BakeOptions& options, const BakedGeometry& g) {
    const Scene& scene = g.scene;
    std::vector<Decision> out;
    const auto add = [&](const char* part, bool runs, std::string why) { out.push_back({part, runs, std::move(why)}); };
    const auto see_through = static_cast<std::size_t>(std::ranges::count_if(scene.materials, [](const Material& m) { return m.is_see_through(); }));
    const bool filters = g.tracer->is_see_through();
    add("see-through", filters, filters ? count_of(see_through, "material") + (see_through == 1 ? " lets" : " let") + " light pass: rays ask them at each hit" : "nothing lets light pass: rays stop at what they meet");
    const auto backs = static_cast<std::size_t>(std::ranges::count_if(g.patches.patches, [](const Patch& p) { return p.is_back; }));
    add("back patches", backs > 0, backs ? count_of(backs, "patch", "es") + " on backs of two-sided surfaces that are open to something" : "no two-sided surface has its back open to anything");
    add("lamps", !scene.lamps.empty(), scene.lamps.empty() ? "the scene has no punctual lights: no shadow rays" : count_of(scene.lamps.size(), "punctual light"));
    add("sky", !scene.sky.empty(), scene.sky.empty() ? "there is no sky" : "a sky of " + std::to_string(scene.sky.width) + " x " + std::to_string(scene.sky.height) + " pixels");
    const auto emits = static_cast<std::size_t>(std::ranges::count_if(g.patches.patches, [](const Patch& p) { return p.emission != Rgb(0, 0, 0); }));
    add("bright surfaces", emits > 0, emits ? count_of(emits, "patch", "es") + (emits == 1 ? " shines" : " shine") : "no surface shines");
    const bool reflects = std::ranges::any_of(g.patches.patches, [](const Patch& p) { return p.reflectance != Rgb(0, 0, 0); });
    const bool has_light = emits > 0 || !scene.lamps.empty() || !scene.sky.empty();
    add("solve", reflects && has_light, !has_light ? "the scene has no light" : reflects ? "light is reflected on" : "no surface reflects light: it ends where it first arrives");
    add("gather", options.gather_rays > 0, options.gather_rays ? std::to_string(options.gather_rays) + " rays per texel" : "draft quality interpolates the patches");
    add("seams", !g.seams.empty(), g.seams.empty() ? "no charts meet on smooth surface, or --seams keep" : count_of(g.seams.size(), "stretch", "es") + " where charts meet");
    return out;
}

}  // namespace luxel
