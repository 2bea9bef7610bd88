#include "baker/bake/decisions.h"

#include <algorithm>

namespace luxel {
namespace {

std::string count_of(std::size_t count, const std::string& what, const char* ending = "s") {
    return std::to_string(count) + " " + what + (count == 1 ? "" : ending);
}

bool shines(const Patch& patch) { return patch.emission != Rgb(0, 0, 0); }

bool is_grey(const Rgb& colour) { return colour.x == colour.y && colour.y == colour.z; }

bool is_all_grey(const BakedGeometry& g) {
    const Scene& scene = g.scene;
    return std::ranges::all_of(g.patches.patches, [](const Patch& p) { return is_grey(p.reflectance) && is_grey(p.emission); }) &&
           std::ranges::all_of(scene.lamps, [](const Lamp& lamp) { return is_grey(lamp.intensity); }) &&
           std::ranges::all_of(scene.sky.nits, is_grey) && !g.tracer->is_see_through();
}

/// What the parts of a bake ask of a scene.
class Decisions {
  public:
    Decisions(const BakeOptions& options, const BakedGeometry& geometry)
        : options_(options), g_(geometry), scene_(geometry.scene), emits_(count_patches(shines)),
          reflects_(std::ranges::any_of(g_.patches.patches, [](const Patch& p) { return p.reflectance != Rgb(0, 0, 0); })) {}

    /// Drafts have no other way to know what patches send straight to each other.
    [[nodiscard]] bool needs_form_factors() const { return options_.forced.has(Part::solve) || (has_light(g_) && (reflects_ || options_.gather_rays == 0)); }

    std::vector<Decision> all() {
        decide_surfaces();
        decide_light();
        add("gather", options_.gather_rays > 0, options_.gather_rays ? std::to_string(options_.gather_rays) + " rays per texel" : "draft quality interpolates the patches");
        add("seams", !g_.seams.empty(), g_.seams.empty() ? "no charts meet on smooth surface, or --seams keep" : count_of(g_.seams.size(), "stretch", "es") + " where charts meet");
        return std::move(out_);
    }

  private:
    template <class Is>
    [[nodiscard]] std::size_t count_patches(const Is& is) const {
        return static_cast<std::size_t>(std::ranges::count_if(g_.patches.patches, is));
    }
    void add(std::string part, bool runs, std::string why) { out_.push_back({std::move(part), runs, std::move(why)}); }
    void add(Part part, bool is_needed, const std::string& why) { out_.push_back(decide_part(options_, part, is_needed, why)); }

    void decide_surfaces() {
        if (const std::size_t copies = repeated_objects(scene_))
            add(Part::copies, false, count_of(copies, "object") + (copies == 1 ? " has" : " have") + " the shape of another: charts are made once for all");
        if (scene_.even_textures)
            add(Part::textures, false, count_of(scene_.even_textures, "texture") + " of one colour: part of the material");
        const auto see_through = static_cast<std::size_t>(std::ranges::count_if(scene_.materials, [](const Material& m) { return m.is_see_through(); }));
        add(Part::see_through, see_through > 0, see_through ? count_of(see_through, "material") + (see_through == 1 ? " lets" : " let") + " light pass: rays ask them at each hit" : "nothing lets light pass: rays stop at what they meet");
        const std::size_t backs = count_patches([](const Patch& p) { return p.is_back; });
        add(Part::back_patches, backs > 0, backs ? count_of(backs, "patch", "es") + " on backs of two-sided surfaces that are open to something" : "no two-sided surface has its back open to anything");
    }

    void decide_light() {
        add(Part::lamps, !scene_.lamps.empty(), !scene_.lamps.empty() ? count_of(scene_.lamps.size(), "punctual light") : scene_.dark_lamps.empty() ? "the scene has no punctual lights: no shadow rays" : "no punctual light has power: no shadow rays");
        add(part_name(Part::sky), !scene_.sky.empty(), scene_.sky.empty() ? "there is no sky" : "a sky of " + std::to_string(scene_.sky.width) + " x " + std::to_string(scene_.sky.height) + " pixels");
        add("bright-surfaces", emits_ > 0, emits_ ? count_of(emits_, "patch", "es") + (emits_ == 1 ? " shines" : " shine") : "no surface shines");
        const bool grey = is_all_grey(g_);
        add(Part::colours, !grey, grey ? "light and surfaces are grey: what is judged of one channel holds for all" : "channels differ");
        add(Part::solve, reflects_ && has_light(g_), !has_light(g_) ? "the scene has no light" : reflects_ ? "light is reflected on" : "no surface reflects light: it ends where it first arrives");
    }

    const BakeOptions& options_;
    const BakedGeometry& g_;
    const Scene& scene_;
    std::size_t emits_;
    bool reflects_;
    std::vector<Decision> out_;
};

}  // namespace

Decision decide_part(const BakeOptions& options, Part part, bool is_needed, const std::string& why) {
    const bool is_forced = !is_needed && options.forced.has(part);
    return {part_name(part), is_needed || is_forced, (is_forced ? "forced, though " : "") + why};
}

std::vector<Decision> decide(const BakeOptions& options, const BakedGeometry& geometry) { return Decisions(options, geometry).all(); }

bool has_light(const BakedGeometry& geometry) {
    return !geometry.scene.lamps.empty() || !geometry.scene.sky.empty() || std::ranges::any_of(geometry.patches.patches, shines);
}

bool needs_form_factors(const BakeOptions& options, const BakedGeometry& geometry) { return Decisions(options, geometry).needs_form_factors(); }

}  // namespace luxel
