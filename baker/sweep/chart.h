/// A chart of points as SVG text, for pages without scripts: logarithmic axes, a stepped Pareto front, names beside some points, and a tooltip on each.
///
/// Colours come from the page's style: classes `axis`, `grid`, `front`, `point`, `preset`, `chosen`, `uncertain`, `name`.
/// Threads  pure. The same input gives the same bytes.
#pragma once
#include <string>
#include <vector>

namespace luxel {

enum class ChartUnit { seconds, bytes, share };

struct ChartPoint {
    double x = 0, y = 0;
    std::string name;     ///< of the tooltip
    std::string label;    ///< beside the point; empty: none
    std::string link;     ///< "#p3": where a click leads
    bool is_preset = false, is_chosen = false, is_uncertain = false;
};

struct ChartAxis {
    std::string title;
    ChartUnit unit = ChartUnit::share;
};

struct Chart {
    std::string id;  ///< of the element
    std::string title;
    ChartAxis x, y;
    std::vector<ChartPoint> points;   ///< x and y > 0; values of 0 are drawn at the axis
    std::vector<std::size_t> front;   ///< indices by rising x; empty: none is drawn
    bool has_diagonal = false;        ///< the line y = x
};

std::string chart_svg(const Chart& chart);

/// "0.13 s", "45 MB", "2.3 %"
std::string value_text(double value, ChartUnit unit);

/// For text and attributes of HTML and SVG.
std::string escaped(const std::string& text);

}  // namespace luxel
