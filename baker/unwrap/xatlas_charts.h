/// Charts of one piece by xatlas. The only file that names xatlas.
/// Threads: reentrant. The result depends on the piece alone, unless `timed_out`.
/// Source: github.com/jpcy/xatlas; Levy et al., Least Squares Conformal Maps, SIGGRAPH 2002.
#pragma once
#include <vector>

#include "baker/unwrap/chart_shape.h"

namespace luxel {

struct PieceCharts {
    std::vector<FlatChart> charts;        ///< in metres, scale restored; not yet checked
    std::vector<std::uint32_t> left_out;  ///< triangles that xatlas gave no chart, ascending
    bool timed_out = false;               ///< gave up: everything is left out
};

/// Pieces with slivers a billion times as long as wide are left out whole. `time_limit_s` bounds a piece that never ends; a bounded piece takes a small fraction of a second.
PieceCharts xatlas_charts(const ObjectMesh& mesh, const std::vector<std::uint32_t>& piece, double time_limit_s);

}  // namespace luxel
