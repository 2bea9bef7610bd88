#include "baker/unwrap/xatlas_charts.h"

#include <xatlas.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

namespace luxel {
namespace {

using Clock = std::chrono::steady_clock;

struct AtlasDeleter {
    void operator()(xatlas::Atlas* atlas) const { xatlas::Destroy(atlas); }
};
using AtlasPointer = std::unique_ptr<xatlas::Atlas, AtlasDeleter>;

/// The piece in the units that xatlas likes: centred, mean triangle area 1 (it ignores areas below 1e-7).
struct ScaledPiece {
    std::vector<Vec3f> positions;
    std::vector<std::uint32_t> indices;
    double extent = 0;  ///< longest side of its box
};

/// xatlas packs in bitmaps of a pixel per unit: what is longer has slivers of 1 : 10^9 and would take it hours and gigabytes.
constexpr double longest_piece = 65536;

ScaledPiece scaled_piece(const ObjectMesh& mesh, const std::vector<std::uint32_t>& piece) {
    std::vector<std::uint32_t> used;
    double area = 0;
    for (const std::uint32_t t : piece) {
        used.insert(used.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
        area += mesh.area_m2(t);
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    Vec3d low = mesh.positions[used[0]], high = low;
    for (const std::uint32_t v : used)
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], mesh.positions[v][axis]);
            high[axis] = std::max(high[axis], mesh.positions[v][axis]);
        }
    const Vec3d centre = (low + high) * 0.5;
    const double scale = std::sqrt(static_cast<double>(piece.size()) / area);
    ScaledPiece result;
    for (int axis = 0; axis < 3; ++axis) result.extent = std::max(result.extent, (high[axis] - low[axis]) * scale);
    result.positions.reserve(used.size());
    for (const std::uint32_t v : used) result.positions.push_back(to_float((mesh.positions[v] - centre) * scale));
    result.indices.reserve(piece.size() * 3);
    for (const std::uint32_t t : piece)
        for (const std::uint32_t v : mesh.triangles[t])
            result.indices.push_back(
                static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin()));
    return result;
}

/// xatlas prints to standard output unless told not to; set once for the process.
void silence() {
    static const bool once = [] {
        xatlas::SetPrint(nullptr, false);
        return true;
    }();
    (void)once;
}

bool go_on(xatlas::ProgressCategory, int, void* deadline) {
    return Clock::now() < *static_cast<const Clock::time_point*>(deadline);
}

AtlasPointer run_xatlas(const ScaledPiece& piece, Clock::time_point& deadline) {
    AtlasPointer atlas(xatlas::Create());
    xatlas::SetProgressCallback(atlas.get(), go_on, &deadline);
    xatlas::MeshDecl declaration;
    declaration.vertexPositionData = piece.positions.data();
    declaration.vertexPositionStride = sizeof(Vec3f);
    declaration.vertexCount = static_cast<std::uint32_t>(piece.positions.size());
    declaration.indexData = piece.indices.data();
    declaration.indexCount = static_cast<std::uint32_t>(piece.indices.size());
    declaration.indexFormat = xatlas::IndexFormat::UInt32;
    if (xatlas::AddMesh(atlas.get(), declaration) != xatlas::AddMeshError::Success) return nullptr;
    xatlas::ComputeCharts(atlas.get());
    // Only packing gives out the coordinates. It stretches charts to whole texels, which restore_scale() undoes, so it
    // may be coarse: one texel per triangle keeps it quick and the rounding far below a final texel.
    xatlas::PackOptions options;
    options.texelsPerUnit = 1;
    options.bilinear = false;
    options.rotateChartsToAxis = false;
    options.rotateCharts = false;
    xatlas::PackCharts(atlas.get(), options);
    return atlas;
}

}  // namespace

PieceCharts xatlas_charts(const ObjectMesh& mesh, const std::vector<std::uint32_t>& piece, double time_limit_s) {
    silence();
    PieceCharts result;
    const ScaledPiece scaled = scaled_piece(mesh, piece);
    Clock::time_point deadline =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(time_limit_s));
    const bool is_fit = scaled.extent <= longest_piece;
    const AtlasPointer atlas = is_fit ? run_xatlas(scaled, deadline) : nullptr;
    std::vector<bool> charted(piece.size(), false);
    if (atlas && atlas->meshes && atlas->meshCount == 1) {
        const xatlas::Mesh& out = atlas->meshes[0];
        for (std::uint32_t c = 0; c < out.chartCount; ++c) {
            std::vector<std::uint32_t> faces(out.chartArray[c].faceArray,
                                             out.chartArray[c].faceArray + out.chartArray[c].faceCount);
            std::sort(faces.begin(), faces.end());
            FlatChart chart;
            for (const std::uint32_t face : faces) {
                if (face >= piece.size() || charted[face]) continue;
                charted[face] = true;
                chart.triangles.push_back(piece[face]);
                auto& uv = chart.corner_uv.emplace_back();
                for (std::size_t k = 0; k < 3; ++k) {
                    const float* at = out.vertexArray[out.indexArray[face * 3 + k]].uv;
                    uv[k] = {at[0], at[1]};
                }
            }
            if (!chart.triangles.empty()) result.charts.push_back(std::move(chart));
        }
    } else if (is_fit) {
        result.timed_out = Clock::now() >= deadline;
    }
    for (std::size_t i = 0; i < piece.size(); ++i)
        if (!charted[i]) result.left_out.push_back(piece[i]);
    for (FlatChart& chart : result.charts) {
        constexpr double flat_cosine =
            0.99995;  // within half a degree a projection is the better chart: exact and straight
        if (is_flat(mesh, chart.triangles, flat_cosine)) chart = project_chart(mesh, std::move(chart.triangles));
        restore_scale(mesh, chart);
    }
    std::sort(result.charts.begin(), result.charts.end(),
              [](const FlatChart& a, const FlatChart& b) { return a.triangles[0] < b.triangles[0]; });
    return result;
}

}  // namespace luxel
