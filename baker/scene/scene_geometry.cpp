#include "baker/scene/scene_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "baker/core/parallel.h"

namespace luxel {

namespace {

bool is_finite(const Vec3f& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool is_finite(const Vec3d& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool is_within(const Vec3d& v, double most) { return is_finite(v) && std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}) <= most; }
bool is_finite(const Vec2f& v) { return std::isfinite(v.x) && std::isfinite(v.y); }

/// Affine only: a last column other than 0 0 0 1 has no meaning for nodes.
Vec3d transformed(const Vec3f& p, const Matrix44d& m) {
    const double x = p.x, y = p.y, z = p.z;
    return {x * m[0][0] + y * m[1][0] + z * m[2][0] + m[3][0], x * m[0][1] + y * m[1][1] + z * m[2][1] + m[3][1],
            x * m[0][2] + y * m[1][2] + z * m[2][2] + m[3][2]};
}

/// Turns normals as positions turn: rows are the cross products of the other two rows.
struct NormalMatrix {
    Vec3d rows[3];
    bool mirrored;

    explicit NormalMatrix(const Matrix44d& m) {
        const Vec3d x(m[0][0], m[0][1], m[0][2]), y(m[1][0], m[1][1], m[1][2]), z(m[2][0], m[2][1], m[2][2]);
        rows[0] = y.cross(z);
        rows[1] = z.cross(x);
        rows[2] = x.cross(y);
        mirrored = x.dot(rows[0]) < 0;
        if (mirrored)
            for (Vec3d& row : rows) row = -row;
    }
    /// Unit, or zero where there is no direction.
    [[nodiscard]] Vec3f apply(const Vec3f& n) const {
        if (!is_finite(n)) return Vec3f(0, 0, 0);
        // Scaled to a maximum of 1 first: squares of tiny normals under tiny scales would vanish.
        Vec3d turned = rows[0] * n.x + rows[1] * n.y + rows[2] * n.z;
        const double largest = std::max({std::abs(turned.x), std::abs(turned.y), std::abs(turned.z)});
        if (!(largest > 0) || !std::isfinite(largest)) return Vec3f(0, 0, 0);
        turned /= largest;
        return to_float(turned / turned.length());
    }
};

ShapeMetric metric_of(const Matrix44d& m) {
    return shape_metric({m[0][0], m[0][1], m[0][2]}, {m[1][0], m[1][1], m[1][2]}, {m[2][0], m[2][1], m[2][2]});
}

Vec3d area_vector_of(const std::vector<Vec3f>& positions, const std::array<std::uint32_t, 3>& t) {
    const Vec3d a = to_double(positions[t[0]]);
    return (to_double(positions[t[1]]) - a).cross(to_double(positions[t[2]]) - a);
}

/// Moves the primitive's vertices and lists the triangles that are kept, by the primitive's own vertex numbers.
struct MovedPrimitive {
    std::vector<Vec3f> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

MovedPrimitive move_and_clean(const PrimitiveRecord& primitive, const Matrix44d& world, const Vec3d& origin,
                              ObjectGeometry& out) {
    MovedPrimitive moved;
    moved.positions.reserve(primitive.positions.size());
    for (const Vec3f& p : primitive.positions) moved.positions.push_back(to_float(transformed(p, world) - origin));
    const std::size_t count = primitive.indices.size() / 3;
    for (std::size_t t = 0; t < count; ++t) {
        std::array<std::uint32_t, 3> triangle{primitive.indices[3 * t], primitive.indices[3 * t + 1],
                                              primitive.indices[3 * t + 2]};
        if (out.mirrored) std::swap(triangle[1], triangle[2]);
        if (!std::ranges::all_of(triangle, [&](std::uint32_t v) { return is_within(Vec3d(moved.positions[v]), 1.5 * farthest_m); })) {
            ++out.not_finite_count;
            continue;
        }
        // Later stages keep areas as floats: what is no normal float there counts as no area.
        const double area = 0.5 * area_vector_of(moved.positions, triangle).length();
        if (!(area >= static_cast<double>(std::numeric_limits<float>::min()))) {
            ++out.no_area_count;
            continue;
        }
        moved.triangles.push_back(triangle);
        out.source_triangle.push_back(static_cast<std::uint32_t>(t));
    }
    return moved;
}

Vec2f uv_of(const PrimitiveRecord& primitive, std::size_t set, std::uint32_t vertex, ObjectGeometry& out) {
    const std::vector<Vec2f>& values = primitive.uv[set];
    if (values.empty()) return Vec2f(0, 0);
    if (is_finite(values[vertex])) return values[vertex];
    ++out.bad_uv_count;
    return Vec2f(0, 0);
}

/// What exporters write into meshes that nobody has painted.
bool is_painted(const PrimitiveRecord& primitive) {
    return std::ranges::any_of(primitive.colors, [](const Rgba& color) { return color != Rgba{1, 1, 1, 1}; });
}

Rgba limited(Rgba color, ObjectGeometry& out) {
    constexpr float rounding = 1e-6f;  // of integers that were divided
    bool is_bad = false;
    for (float& channel : color) {
        is_bad = is_bad || !(channel >= -rounding && channel <= 1 + rounding);
        channel = channel > 0 ? (channel < 1 - rounding ? channel : 1.0f) : 0.0f;
    }
    out.bad_color_count += is_bad;
    return color;
}

void append_vertex(const PrimitiveRecord& primitive, std::uint32_t vertex, const Vec3f& position, const Vec3f& normal,
                   ObjectGeometry& out) {
    out.positions.push_back(position);
    out.normals.push_back(normal);
    out.shape_positions.push_back(shape_position(out.shape_root, primitive.positions[vertex]));
    for (std::size_t set = 0; set < 2; ++set) out.uv[set].push_back(uv_of(primitive, set, vertex, out));
    if (out.is_painted) out.colors.push_back(limited(primitive.colors[vertex], out));
}

/// Without normals glTF asks for flat shading: no corner is shared.
void append_flat(const PrimitiveRecord& primitive, const MovedPrimitive& moved, ObjectGeometry& out) {
    for (const auto& triangle : moved.triangles) {
        const auto first = static_cast<std::uint32_t>(out.positions.size());
        const Vec3f normal = to_float(area_vector_of(moved.positions, triangle).normalized());
        for (const std::uint32_t vertex : triangle) append_vertex(primitive, vertex, moved.positions[vertex], normal, out);
        out.triangles.push_back({first, first + 1, first + 2});
    }
}

void append_smooth(const PrimitiveRecord& primitive, const MovedPrimitive& moved, const NormalMatrix& turn,
                   ObjectGeometry& out) {
    std::vector<std::uint32_t> number(moved.positions.size(), none);
    for (const auto& triangle : moved.triangles)
        for (const std::uint32_t vertex : triangle) number[vertex] = 0;
    std::vector<std::uint32_t> bad;
    for (std::uint32_t vertex = 0; vertex < number.size(); ++vertex) {
        if (number[vertex] == none) continue;
        number[vertex] = static_cast<std::uint32_t>(out.positions.size());
        const Vec3f normal = turn.apply(primitive.normals[vertex]);
        if (normal == Vec3f(0, 0, 0)) bad.push_back(number[vertex]);
        append_vertex(primitive, vertex, moved.positions[vertex], normal, out);
    }
    for (const auto& triangle : moved.triangles)
        out.triangles.push_back({number[triangle[0]], number[triangle[1]], number[triangle[2]]});

    // A vertex without a usable normal takes the area-weighted mean of its triangles', or that of the last one where
    // they cancel.
    out.bad_normal_count = static_cast<std::uint32_t>(bad.size());
    if (bad.empty()) return;
    std::vector<Vec3d> sum(bad.size(), Vec3d(0, 0, 0)), last(bad.size(), Vec3d(0, 0, 1));
    for (const auto& triangle : out.triangles)
        for (const std::uint32_t vertex : triangle) {
            const auto found = std::ranges::lower_bound(bad, vertex);
            if (found == bad.end() || *found != vertex) continue;
            const auto place = static_cast<std::size_t>(found - bad.begin());
            last[place] = area_vector_of(out.positions, triangle);
            sum[place] += last[place];
        }
    for (std::size_t i = 0; i < bad.size(); ++i) {
        const bool cancels = sum[i].length() <= 1e-9 * last[i].length();
        out.normals[bad[i]] = to_float((cancels ? last[i] : sum[i]).normalized());
    }
}

struct Box {
    Vec3d low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    void add(const Vec3d& p) {
        for (int c = 0; c < 3; ++c) {
            low[c] = std::min(low[c], p[c]);
            high[c] = std::max(high[c], p[c]);
        }
    }
};

}  // namespace

ObjectGeometry build_object_geometry(const PrimitiveRecord& primitive, const Matrix44d& world, const Vec3d& origin) {
    ObjectGeometry out;
    const NormalMatrix turn(world);
    out.mirrored = turn.mirrored;
    out.metric = metric_of(world);
    out.shape_root = shape_root(out.metric);
    const MovedPrimitive moved = move_and_clean(primitive, world, origin, out);
    const std::size_t vertex_bound = primitive.normals.empty() ? 3 * moved.triangles.size() : primitive.positions.size();
    out.positions.reserve(vertex_bound);
    out.normals.reserve(vertex_bound);
    out.shape_positions.reserve(vertex_bound);
    for (auto& set : out.uv) set.reserve(vertex_bound);
    out.is_painted = is_painted(primitive);
    if (out.is_painted) out.colors.reserve(vertex_bound);
    out.triangles.reserve(moved.triangles.size());
    if (primitive.normals.empty()) append_flat(primitive, moved, out);
    else append_smooth(primitive, moved, turn, out);
    return out;
}

Vec3d scene_origin(const SceneRecord& record) {
    std::vector<Box> boxes(record.instances.size());
    parallel_for(record.instances.size(), 16, [&](std::size_t i) {
        const InstanceRecord& instance = record.instances[i];
        for (const PrimitiveRecord& primitive : record.meshes[static_cast<std::size_t>(instance.mesh)].primitives)
            for (const Vec3f& p : primitive.positions) {
                const Vec3d world = transformed(p, instance.world);
                if (is_within(world, farthest_m)) boxes[i].add(world);
            }
    });
    Box box;
    for (const Box& part : boxes)
        if (part.low.x <= part.high.x) {
            box.add(part.low);
            box.add(part.high);
        }
    if (!(box.low.x <= box.high.x)) return Vec3d(0, 0, 0);
    const Vec3d size = box.high - box.low;
    const double longest = std::max({size.x, size.y, size.z});
    if (!(longest > 0) || !std::isfinite(longest)) return is_finite(box.low) && longest == 0 ? box.low : Vec3d(0, 0, 0);
    int exponent = 0;
    std::frexp(longest, &exponent);  // longest = m * 2^exponent, 1/2 <= m < 1
    const double grid = std::ldexp(1.0, exponent - 1);
    const Vec3d center = box.low + size * 0.5;
    return {std::round(center.x / grid) * grid, std::round(center.y / grid) * grid, std::round(center.z / grid) * grid};
}

}  // namespace luxel
