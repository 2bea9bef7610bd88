#include "baker/bake/geometry_stages.h"

#include <algorithm>
#include <cmath>

#include "baker/chunks/room_chunks.h"
#include "baker/core/memory.h"
#include "baker/light/lit_sides.h"
#include "baker/patches/patch_build.h"
#include "baker/patches/patch_set.h"
#include "baker/patches/see_through_texels.h"
#include "baker/patches/texel_raster.h"
#include "baker/scene/scene_build.h"
#include "baker/trace/open_backs.h"
#include "baker/trace/texel_joints.h"
#include "baker/trace/visible_area.h"
#include "baker/unwrap/atlas_file.h"
#include "formats/base/file.h"
#include "formats/gltf/gltf_in.h"
#include "formats/gltf/node_settings.h"
#include "formats/image/image_file.h"

namespace luxel {
namespace {

std::optional<DecodedImage> decode(ByteView bytes, const std::string& name) {
    try {
        ImagePixels pixels = decode_image(bytes, name);
        return DecodedImage{pixels.width, pixels.height, std::move(pixels.pixels)};
    } catch (const Error& error) {
        // A picture that cannot be read costs its texture, not the bake; scene_build warns. A missing module stops.
        if (error.code == ErrorCode::bad_input) return {};
        throw;
    }
}

/// What the file or the user may bring: a picture of half a gigabyte decoded.
constexpr ImageLimits sky_limits{.max_side = 16384, .max_pixels = std::uint64_t{1} << 25};

SkyWish read_sky(const SkyChoice& choice) {
    SkyWish wish{.none = choice.none, .color = choice.color, .picture = {}, .picture_name = choice.picture.string(),
                 .turn_degrees = choice.turn_degrees, .scale = choice.scale};
    if (choice.picture.empty()) return wish;
    ImagePixels pixels = decode_image(read_file(choice.picture), choice.picture.string(), sky_limits);
    if (!pixels.is_float)
        throw Error(ErrorCode::bad_input, choice.picture.string(), "expected a picture of floats, OpenEXR or Radiance HDR, found one of integers",
                    "a sky is in nits, which 8 or 16 bits cannot hold");
    if (pixels.width != 2 * std::uint64_t{pixels.height})
        throw Error(ErrorCode::bad_input, choice.picture.string(),
                    "expected longitudes and latitudes, twice as wide as high, found " + std::to_string(pixels.width) + " x " +
                        std::to_string(pixels.height),
                    "convert cubemaps, probes and other projections to an equirectangular picture");
    wish.picture = DecodedImage{pixels.width, pixels.height, std::move(pixels.pixels)};
    return wish;
}

Key atlas_key(const Scene& scene, const UnwrapOptions& o) {
    KeyBuilder key("atlas 2");
    key.key(scene.geometry_key)
        .number(o.texels_per_metre)
        .integer(o.page_size)
        .integer(o.padding)
        .integer(static_cast<int>(o.uv_mode))
        .integer(static_cast<int>(o.instances))
        .integer(o.piece_triangles);
    for (std::size_t n = 0; n < scene.objects.size(); ++n) {
        const Object& object = scene.objects[n];
        if (!object.has_lightmap || object.texels_per_metre > 0)
            key.text("own").integer(static_cast<std::int64_t>(n)).integer(object.has_lightmap).number(static_cast<double>(object.texels_per_metre));
    }
    return key.finish();
}

void read(const BakeOptions& options, BakedGeometry& g, BakeReport& report) {
    g.document = load_gltf(options.input, options.allow_outside);
    const SettingsFile settings = options.settings.empty() ? SettingsFile() : parse_settings(read_file(options.settings), options.settings.filename().string());
    g.record = read_scene(g.document, {.scene = options.scene.empty() ? -1 : find_scene(g.document, options.scene),
                                       .skip_skinned = options.skip_skinned,
                                       .vertex_colors = options.vertex_colors,
                                       .settings = &settings});
    report.warnings.insert(report.warnings.end(), g.document.warnings.begin(), g.document.warnings.end());
    report.warnings.insert(report.warnings.end(), g.record.warnings.begin(), g.record.warnings.end());
    const BuildOptions build{.bad_values = options.bad_values,
                             .blend_colours = options.blend_colours,
                             .file = options.input.filename().string(),
                             .lamp_radius = options.lamp_radius,
                             .sun_angle_degrees = options.sun_angle_degrees,
                             .sky = read_sky(options.sky),
                             .keep_even_textures = options.forced.has(Part::textures),
                             .keep_dark_lamps = options.forced.has(Part::lamps)};
    g.scene = build_scene(g.record, decode, build, report.warnings);
    if (g.scene.triangles.empty())
        throw Error(ErrorCode::bad_input, options.input.string(), "the scene has no triangle with an area",
                    "nothing can be baked; check that the default scene shows a mesh");
    if (std::ranges::none_of(g.scene.objects, [](const Object& object) { return object.has_lightmap; }))
        throw Error(ErrorCode::bad_input, options.input.string(), "no node has a lightmap: its settings, or those of its mesh, say so of each",
                    "\"lightmap\" and \"receive\" must not be false for all; docs/settings.md says what else stops or reflects light");
    report.triangles = g.scene.triangle_count();
}

/// Returns true if the atlas was in the bake folder.
bool unwrap_scene(const BakeOptions& options, const BakeFolder& folder, StageClock& clock, BakedGeometry& g,
                  BakeReport& report) {
    const Key key = atlas_key(g.scene, options.unwrap);
    const auto path = folder.atlas(key);
    clock.keeps(path);
    const bool reused = std::filesystem::exists(path);
    if (reused) {
        g.atlas = load_atlas(path, key, g.scene);
    } else {
        UnwrapOptions unwrapping = options.unwrap;
        unwrapping.each_copy = options.forced.has(Part::copies);
        g.atlas = unwrap(g.scene, unwrapping, report.warnings, clock.progress("triangles"));
        save_atlas(path, key, g.atlas);
    }
    report.charts = g.atlas.charts.size();
    g.shown_pages = shown_page_count(g.scene, g.atlas);
    report.pages = g.shown_pages;
    report.texels_per_metre = static_cast<double>(g.atlas.texels_per_metre);
    return reused;
}

/// Of the scene's surface: less is not worth a warning.
constexpr double shown_share = 0.005;

/// Turns the surfaces that show the light their backs, or says that there are some.
void choose_sides(const BakeOptions& options, BakedGeometry& g, BakeReport& report) {
    const DarkFronts dark = find_dark_fronts(g.scene, g.atlas, *g.tracer);
    double all_m2 = 0;
    for (std::uint32_t t = 0; t < g.scene.triangle_count(); ++t) all_m2 += g.scene.area_m2(t);
    report.dark_fronts = {dark.chart_count, dark.area_m2, dark.area_m2 / all_m2, options.two_sided == TwoSidedTexels::lit};
    if (dark.chart_count == 0) return;
    if (options.two_sided == TwoSidedTexels::lit) {
        g.scene.turned.resize(g.scene.triangle_count());
        for (std::uint32_t t = 0; t < g.scene.turned.size(); ++t) g.scene.turned[t] = dark.charts[g.atlas.triangle_chart[t]];
    } else if (dark.area_m2 >= shown_share * all_m2) {
        report.warnings.push_back({"dark-fronts", options.input.filename().string(),
                                   std::to_string(std::lround(100 * dark.area_m2 / all_m2)) +
                                       " % of the surface is two-sided with its front, whose light texels hold, in the dark and its back in the "
                                       "light: viewers will show it black. --two-sided lit bakes the light of these backs"});
    }
}

/// What of the surface is not visible or parted: patches keep their ids when something else covers a part of them.
void add_visible(const TexelSet& texels, KeyBuilder& key) {
    for (std::size_t page = 0; page < texels.pages.size(); ++page) {
        const std::vector<Fragment>& fragments = texels.pages[page].fragments;
        for (std::size_t f = 0; f < fragments.size(); ++f)
            if (fragments[f].visible != all_visible)
                key.integer(static_cast<std::int64_t>(page))
                    .integer(static_cast<std::int64_t>(f))
                    .integer(fragments[f].visible)
                    .integer(fragments[f].visible_parts);
        const std::vector<Texel>& list = texels.pages[page].texels;
        for (std::size_t t = 0; t < list.size(); ++t)
            if (!list[t].joined_right || !list[t].joined_down || list[t].own_side != all_visible)
                key.integer(static_cast<std::int64_t>(page))
                    .integer(static_cast<std::int64_t>(t))
                    .integer(2 * list[t].joined_right + list[t].joined_down)
                    .integer(list[t].own_side);
    }
}

/// A patch that a wall cuts, and the next one, which drafts interpolate with, lie within two sides of a cell.
float reach_behind_walls_m(const BakeOptions& options, const Atlas& atlas) {
    return 2 * patch_side_m(options, atlas);
}

Tiling number_by_chunk(const BakeOptions& options, const BakedGeometry& g) {
    if (options.chunks == ChunkKind::tiles) return tile_patches(g.patches, {options.chunk_patches});
    return find_room_chunks(g.scene, g.atlas, g.patches, *g.tracer, {options.chunk_patches, patch_side_m(options, g.atlas)});
}

void number_patches(const BakeOptions& options, BakedGeometry& g, BakeReport& report) {
    const std::vector<bool> backs = options.forced.has(Part::back_patches) ? find_all_backs(g.scene, g.patches) : find_open_backs(g.scene, g.atlas, g.patches, *g.tracer);
    g.patches = add_back_sides(std::move(g.patches), backs);
    Tiling tiling = number_by_chunk(options, g);
    renumber(g.patches, tiling.new_number);
    g.layout = std::move(tiling.layout);
    report.patches = g.patches.count();
    report.chunks = g.layout.chunk_count();
    KeyBuilder key("chunks 4");
    for (std::uint32_t t = 0; t < g.scene.turned.size(); ++t)
        if (g.scene.turned[t]) key.text("turned").integer(t);
    key.key(atlas_key(g.scene, options.unwrap)).integer(options.patch_texels);
    for (const Patch& patch : g.patches.patches) key.integer(static_cast<std::int64_t>(patch.id));
    add_visible(g.texels, key);
    g.layout_key = key.array(std::span<const PatchNumber>(g.layout.first_patch)).finish();
}

}  // namespace

std::uint64_t BakedGeometry::resident_bytes() const {
    std::uint64_t bytes = scene.resident_bytes() + atlas.resident_bytes() + texels.resident_bytes() +
                          patches.resident_bytes() + seams.size() * sizeof(Seam) + (tracer ? tracer->resident_bytes() : 0);
    for (const Bytes& buffer : document.buffers) bytes += buffer.size();
    for (const auto& view : document.decoded_views) bytes += view ? view->size() : 0;
    for (const ImageRecord& image : record.images) bytes += image.bytes.size();
    for (const MeshRecord& mesh : record.meshes)
        for (const PrimitiveRecord& p : mesh.primitives)
            bytes += p.positions.size() * sizeof(p.positions[0]) + p.normals.size() * sizeof(p.normals[0]) +
                     (p.uv[0].size() + p.uv[1].size()) * sizeof(p.uv[0][0]) + p.colors.size() * sizeof(p.colors[0]) + p.indices.size() * sizeof(p.indices[0]);
    return bytes;
}

std::unique_ptr<BakedGeometry> prepare_geometry(const BakeOptions& options, const BakeFolder& folder, StageClock& clock,
                                                BakeReport& report) {
    auto g = std::make_unique<BakedGeometry>();
    clock.stage("read", [&] {
        read(options, *g, report);
        return false;
    });
    clock.stage("unwrap", [&] { return unwrap_scene(options, folder, clock, *g, report); });
    clock.stage("texels", [&] {
        g->texels = raster_texels(g->scene, g->atlas);
        report.texels = g->texels.texel_count();
        return false;
    });
    g->tracer = std::make_unique<Tracer>(g->scene, options.forced.has(Part::see_through) ? PassageTest::everywhere : PassageTest::where_needed);
    if (std::ranges::any_of(g->scene.objects, [](const Object& object) { return object.double_sided && object.has_lightmap; }))
        clock.stage("sides", [&] {
            choose_sides(options, *g, report);
            return false;
        });
    clock.stage("visible", [&] {
        find_visible_area(g->scene, g->atlas, *g->tracer, reach_behind_walls_m(options, g->atlas), g->texels);
        thin_see_through(g->scene, g->atlas, g->texels);
        find_texel_joints(g->scene, g->atlas, *g->tracer, g->texels);
        return false;
    });
    if (options.seams == SeamMode::join)
        clock.stage("seams", [&] {
            g->seams = find_seams(g->scene, g->atlas);
            const auto is_hidden = [&](const SeamSide& side) { return g->atlas.charts[g->atlas.triangle_chart[side.triangle]].page >= g->shown_pages; };
            std::erase_if(g->seams, [&](const Seam& seam) { return is_hidden(seam.a) || is_hidden(seam.b); });
            return false;
        });
    clock.stage("patches", [&] {
        g->patches = build_patches(g->scene, g->atlas, g->texels, {options.patch_texels});
        return false;
    });
    clock.stage("chunks", [&] {
        number_patches(options, *g, report);
        return false;
    });
    return g;
}

}  // namespace luxel
