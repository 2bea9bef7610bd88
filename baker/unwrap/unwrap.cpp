#include "baker/unwrap/unwrap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "baker/core/parallel.h"
#include "baker/unwrap/fit_page.h"
#include "baker/unwrap/kept_uv.h"
#include "baker/unwrap/mesh_copies.h"
#include "baker/unwrap/pieces.h"
#include "baker/unwrap/place_charts.h"
#include "baker/unwrap/planar_charts.h"
#include "baker/unwrap/xatlas_charts.h"

namespace luxel {
namespace {

/// What came out of one piece, or of all pieces of a shape.
struct UnwrappedPiece {
    std::vector<TexelChart> charts;
    std::size_t fallback_triangles = 0, scaled_charts = 0;
    bool timed_out = false;
};

/// A mesh that is unwrapped once for all objects that show it.
struct Shape {
    std::uint32_t object = 0;  ///< the first that shows it
    std::size_t object_count = 0;
    double density = 0;                   ///< texels per metre
    ObjectMesh mesh;
    std::vector<std::vector<std::uint32_t>> pieces;
    std::vector<UnwrappedPiece> results;  ///< per piece; one for a kept layout
    std::vector<TexelChart> charts;       ///< of all pieces, by lowest triangle
    std::string not_kept;                 ///< why TEXCOORD_1 was not used, if it was asked for
};

void check_options(const UnwrapOptions& options) {
    const auto fail = [](const std::string& what, const std::string& hint) {
        throw Error(ErrorCode::usage, "unwrap", what, hint);
    };
    if (options.page_size < smallest_page || options.page_size > largest_page)
        fail(fmt::format("atlas size {} is not in {} .. {}", options.page_size, smallest_page, largest_page),
             "give --atlas-size 1024");
    if (options.padding > options.page_size / 8)
        fail(fmt::format("padding {} is more than an eighth of the atlas size {}", options.padding, options.page_size),
             "give a smaller --padding");
    if (!(options.texels_per_metre >= 0) || !std::isfinite(options.texels_per_metre))
        fail(fmt::format("{} texels per metre", options.texels_per_metre),
             "give a positive number, or 0 for automatic");
    if (options.piece_triangles == 0) fail("pieces of 0 triangles", "give at least 1");
}

/// For each object the one whose layout it takes: itself, but for stretched copies.
std::vector<std::uint32_t> layout_owners(const Scene& scene, const std::vector<CopyGroup>& groups) {
    std::vector<std::uint32_t> owner(scene.objects.size());
    std::iota(owner.begin(), owner.end(), 0u);
    for (const CopyGroup& group : groups)
        for (const ObjectRun& run : group.instances)
            for (std::uint32_t k = 0; k < run.count; ++k) owner[run.first + k] = group.instances[0].first + k;
    return owner;
}

/// For each object the first one that has its shape and density, maybe itself; `none` for those without triangles.
std::vector<std::uint32_t> first_of_shape(const Scene& scene) {
    std::map<std::uint64_t, std::vector<std::uint32_t>> by_content;
    std::vector<std::uint32_t> first(scene.objects.size(), none);
    for (std::uint32_t o = 0; o < first.size(); ++o) {
        const Object& object = scene.objects[o];
        if (object.triangle_count == 0) continue;
        auto& candidates = by_content[object.content_hash];
        const auto found = std::ranges::find_if(candidates, [&](std::uint32_t other) {
            return scene.objects[other].texels_per_metre == object.texels_per_metre && same_shape(scene, scene.objects[other], object);
        });
        first[o] = found == candidates.end() ? o : *found;
        if (first[o] == o) candidates.push_back(o);
    }
    return first;
}

/// Groups objects that take the same layout at the same density; `shape_of` gets the group of each object.
std::vector<Shape> find_shapes(const Scene& scene, const UnwrapOptions& options, const std::vector<CopyGroup>& groups, float density,
                               std::vector<std::uint32_t>& shape_of) {
    const std::vector<std::uint32_t> owner = layout_owners(scene, groups), first = first_of_shape(scene);
    std::vector<std::uint32_t> shape_of_first(scene.objects.size(), none);
    std::vector<Shape> shapes;
    shape_of.assign(scene.objects.size(), none);
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
        const std::uint32_t shown = first[owner[o]];
        if (shown == none) continue;
        shape_of[o] = shape_of_first[shown];
        if (shape_of[o] == none || options.each_copy) {
            shape_of[o] = shape_of_first[shown] = static_cast<std::uint32_t>(shapes.size());
            shapes.emplace_back().object = shown;
            shapes.back().density = static_cast<double>(scene.objects[shown].density(density));
        }
        ++shapes[shape_of[o]].object_count;
    }
    return shapes;
}

void prepare_shape(const Scene& scene, const UnwrapOptions& options, std::uint32_t limit, Shape& shape) {
    const Object& object = scene.objects[shape.object];
    shape.mesh = object_mesh(scene, object);
    if (options.uv_mode == UvMode::keep && scene.object_has_uv1[shape.object]) {
        if (auto kept = kept_chart(scene, object, shape.mesh, shape.density, shape.not_kept)) {
            UnwrappedPiece& result = shape.results.emplace_back();
            result.scaled_charts = fit_chart_whole(std::move(*kept), shape.density, limit, result.charts) ? 1 : 0;
            return;
        }
    }
    shape.pieces = cut_pieces(shape.mesh, options.piece_triangles);
    shape.results.resize(shape.pieces.size());
}

UnwrappedPiece unwrap_piece(const ObjectMesh& mesh, const std::vector<std::uint32_t>& piece, double density,
                            std::uint32_t limit, double time_limit_s) {
    UnwrappedPiece result;
    PieceCharts found = xatlas_charts(mesh, piece, time_limit_s);
    result.timed_out = found.timed_out;
    std::vector<FlatChart> charts;
    for (FlatChart& chart : found.charts) {
        orient(chart);
        if (is_valid(mesh, chart, density))
            charts.push_back(std::move(chart));
        else
            found.left_out.insert(found.left_out.end(), chart.triangles.begin(), chart.triangles.end());
    }
    std::sort(found.left_out.begin(), found.left_out.end());
    result.fallback_triangles = found.left_out.size();
    for (FlatChart& chart : planar_charts(mesh, found.left_out, density)) charts.push_back(std::move(chart));
    for (FlatChart& chart : charts)
        if (fit_chart(mesh, std::move(chart), density, limit, result.charts)) ++result.scaled_charts;
    return result;
}

void unwrap_shapes(const Scene& scene, const UnwrapOptions& options, std::vector<Shape>& shapes, const ProgressFunction& progress) {
    const std::uint32_t limit = options.page_size - 2 * options.padding;
    parallel_for(shapes.size(), 1, [&](std::size_t s) { prepare_shape(scene, options, limit, shapes[s]); });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> work;
    std::uint64_t total = 0;
    for (std::uint32_t s = 0; s < shapes.size(); ++s)
        for (std::uint32_t p = 0; p < shapes[s].pieces.size(); ++p) {
            work.emplace_back(s, p);
            total += shapes[s].pieces[p].size();
        }
    ProgressCounter counter(total, progress);
    parallel_for(work.size(), 1, [&](std::size_t w) {
        Shape& shape = shapes[work[w].first];
        const auto& piece = shape.pieces[work[w].second];
        shape.results[work[w].second] = unwrap_piece(shape.mesh, piece, shape.density, limit, options.piece_time_limit_s);
        counter.add(piece.size());
    });
    parallel_for(shapes.size(), 1, [&](std::size_t s) {
        for (UnwrappedPiece& result : shapes[s].results)
            std::move(result.charts.begin(), result.charts.end(), std::back_inserter(shapes[s].charts));
        std::sort(shapes[s].charts.begin(), shapes[s].charts.end(),
                  [](const TexelChart& a, const TexelChart& b) { return a.triangles[0] < b.triangles[0]; });
    });
}

void report(const Scene& scene, const std::vector<Shape>& shapes, double time_limit_s, std::vector<Warning>& warnings) {
    for (const Shape& shape : shapes) {
        const std::string copies =
            shape.object_count > 1 ? fmt::format(" (and {} copies)", shape.object_count - 1) : std::string();
        const auto warn = [&](const char* code, const std::string& text) {
            warnings.push_back({code, scene.objects[shape.object].name, text + copies});
        };
        std::size_t fallback = 0, scaled = 0, slow = 0;
        for (const UnwrappedPiece& result : shape.results) {
            fallback += result.fallback_triangles;
            scaled += result.scaled_charts;
            slow += result.timed_out ? 1 : 0;
        }
        if (!shape.not_kept.empty())
            warn("uv-not-kept", "TEXCOORD_1 is not fit for a lightmap: " + shape.not_kept + "; unwrapped instead");
        if (slow)
            warn("unwrap-slow",
                 fmt::format("{} pieces were given up after {} s: another run may differ", slow, time_limit_s));
        if (fallback)
            warn("unwrap-fallback", fmt::format("{} of {} triangles could not be unwrapped and got planar charts",
                                                fallback, shape.mesh.triangles.size()));
        if (scaled)
            warn("chart-scaled",
                 fmt::format("{} charts are larger than a page and got fewer texels per metre", scaled));
    }
}

void append_object(const Scene& scene, std::uint32_t o, const Shape& shape, Atlas& atlas) {
    const Object& object = scene.objects[o];
    for (std::uint32_t ordinal = 0; ordinal < shape.charts.size(); ++ordinal) {
        const TexelChart& source = shape.charts[ordinal];
        Chart chart;
        chart.object = o;
        chart.ordinal = ordinal;
        chart.width = source.width;
        chart.height = source.height;
        chart.first = static_cast<std::uint32_t>(atlas.chart_triangles.size());
        chart.count = static_cast<std::uint32_t>(source.triangles.size());
        for (std::size_t i = 0; i < source.triangles.size(); ++i) {
            const std::uint32_t triangle = object.first_triangle + source.triangles[i];
            atlas.chart_triangles.push_back(triangle);
            atlas.triangle_chart[triangle] = static_cast<std::uint32_t>(atlas.charts.size());
            for (std::size_t k = 0; k < 3; ++k)
                atlas.corner_uv[std::size_t{3} * triangle + k] = source.corner_uv[i][mesh_corner(object, k)];
        }
        atlas.charts.push_back(chart);
    }
}

/// Of what has a lightmap and no density of its own; if nothing has, of all.
double area_to_fill(const Scene& scene) {
    double all = 0, own = 0;
    for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
        const Object& object = scene.object_of(t);
        const double area = scene.area_m2(t);
        all += area;
        if (object.has_lightmap && object.texels_per_metre <= 0) own += area;
    }
    return own > 0 ? own : all;
}

}  // namespace

double automatic_density(double area_m2, std::uint32_t page_size) {
    if (!(area_m2 > 0)) return 1;
    const double wanted = std::sqrt(0.5 / area_m2) * page_size;
    int exponent = 0;
    const double fraction = std::frexp(wanted, &exponent);  // in [0.5, 1)
    // Powers of 2^(1/4): rounding down to them needs no logarithm, so no machine rounds differently.
    constexpr std::array<double, 4> ladder{0.5, 0.59460355750136051, 0.70710678118654757, 0.84089641525371450};
    double rounded = ladder[0];
    for (const double step : ladder)
        if (step <= fraction) rounded = step;
    return std::ldexp(rounded, exponent);
}

Atlas unwrap(const Scene& scene, const UnwrapOptions& options, std::vector<Warning>& warnings,
             const ProgressFunction& progress) {
    check_options(options);
    Atlas atlas;
    // Rounded to float before use: charts are made with the very number that is stored and that enters patch ids.
    atlas.texels_per_metre = static_cast<float>(
        options.texels_per_metre > 0 ? options.texels_per_metre : automatic_density(area_to_fill(scene), options.page_size));
    atlas.page_size = options.page_size;
    atlas.padding = options.padding;
    const double page_side = options.page_size - 2.0 * options.padding;
    const std::vector<CopyGroup> groups = options.instances == InstanceMode::share
                                              ? find_copies(scene, static_cast<double>(atlas.texels_per_metre), page_side * page_side)
                                              : std::vector<CopyGroup>();
    std::vector<std::uint32_t> shape_of;
    std::vector<Shape> shapes = find_shapes(scene, options, groups, atlas.texels_per_metre, shape_of);
    unwrap_shapes(scene, options, shapes, progress);
    report(scene, shapes, options.piece_time_limit_s, warnings);
    atlas.chart_triangles.reserve(scene.triangle_count());
    atlas.triangle_chart.assign(scene.triangle_count(), none);
    atlas.corner_uv.resize(3 * scene.triangle_count());
    for (std::uint32_t o = 0; o < scene.objects.size(); ++o)
        if (shape_of[o] != none) append_object(scene, o, shapes[shape_of[o]], atlas);
    const auto lost = std::count(atlas.triangle_chart.begin(), atlas.triangle_chart.end(), none);
    if (lost || atlas.chart_triangles.size() != scene.triangle_count())
        throw Error(ErrorCode::internal, "unwrap", fmt::format("{} triangles have no chart", lost));
    place_charts(scene, groups, atlas, warnings);
    return atlas;
}

std::size_t repeated_objects(const Scene& scene) {
    const std::vector<std::uint32_t> first = first_of_shape(scene);
    std::size_t count = 0;
    for (std::uint32_t o = 0; o < first.size(); ++o) count += first[o] != none && first[o] != o;
    return count;
}

std::uint32_t shown_page_count(const Scene& scene, const Atlas& atlas) {
    std::uint32_t count = 0;
    for (const Chart& chart : atlas.charts)
        if (scene.objects[chart.object].has_lightmap) count = std::max(count, chart.page + 1);
    return count;
}

}  // namespace luxel
