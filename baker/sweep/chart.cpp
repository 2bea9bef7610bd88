#include "baker/sweep/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace luxel {
namespace {

constexpr double width = 760, height = 440, left = 74, right = 24, top = 20, bottom = 54;
constexpr double plot_width = width - left - right, plot_height = height - top - bottom;
constexpr double letter_width = 6.6, line_height = 13;  // of labels, for keeping them apart
constexpr double base_of_bytes = 1024;

/// One logarithmic axis: its range widened to at least a factor, and its ticks.
struct LogAxis {
    double least = 1, most = 10;
    std::vector<double> ticks;

    LogAxis(const std::vector<double>& values, ChartUnit unit) {
        least = std::numeric_limits<double>::max(), most = 0;
        for (const double value : values)
            if (value > 0) least = std::min(least, value), most = std::max(most, value);
        if (!(most > 0)) least = 1, most = 1;
        constexpr double margin = 1.25, least_range = 4;
        const double middle = std::sqrt(least * most);
        least = std::min(least / margin, middle / std::sqrt(least_range));
        most = std::max(most * margin, middle * std::sqrt(least_range));
        find_ticks(unit);
    }
    /// 0 at the least, 1 at the most; what is 0 is at the least.
    [[nodiscard]] double place(double value) const { return value > 0 ? std::clamp(std::log(value / least) / std::log(most / least), 0.0, 1.0) : 0; }

  private:
    void find_ticks(ChartUnit unit) {
        const double base = unit == ChartUnit::bytes ? 2 : 10;
        const double decades = std::log(most / least) / std::log(base);
        std::vector<double> steps{1};
        int every = 1;
        if (unit == ChartUnit::bytes && decades < 3) steps = {1, 1.25, 1.5, 1.75};
        else if (unit == ChartUnit::bytes) every = std::max(1, static_cast<int>(std::ceil(decades / 8)));
        else steps = decades > 3 ? std::vector<double>{1} : decades > 1.2 ? std::vector<double>{1, 2, 5} : std::vector<double>{1, 1.5, 2, 3, 4, 5, 6, 8};
        const int first = static_cast<int>(std::floor(std::log(least) / std::log(base))) - 1;
        for (int power = first; std::pow(base, power) <= most; ++power) {
            if (unit == ChartUnit::bytes && power % every != 0) continue;
            for (const double step : steps) {
                const double tick = step * std::pow(base, power);
                if (tick >= least && tick <= most) ticks.push_back(tick);
            }
        }
    }
};

struct Box {
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    [[nodiscard]] bool meets(const Box& other) const { return x0 < other.x1 && other.x0 < x1 && y0 < other.y1 && other.y0 < y1; }
};

class Drawing {
  public:
    explicit Drawing(const Chart& chart) : chart_(chart), x_(values(&ChartPoint::x), chart.x.unit), y_(values(&ChartPoint::y), chart.y.unit) {}

    std::string svg() {
        out_ = fmt::format("<svg id=\"{}\" class=\"chart\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n", escaped(chart_.id), width, height, escaped(chart_.title));
        draw_axes();
        if (chart_.has_diagonal) draw_diagonal();
        draw_front();
        // Those that matter lie on top.
        for (const bool presets : {false, true})
            for (const ChartPoint& point : chart_.points)
                if ((point.is_preset || point.is_chosen) == presets) draw_point(point);
        for (const ChartPoint& point : chart_.points)
            if (!point.label.empty()) draw_label(point);
        return std::move(out_) + "</svg>\n";
    }

  private:
    [[nodiscard]] std::vector<double> values(double ChartPoint::*member) const {
        std::vector<double> all;
        for (const ChartPoint& point : chart_.points) all.push_back(point.*member);
        return all;
    }
    [[nodiscard]] double at_x(double value) const { return left + plot_width * x_.place(value); }
    [[nodiscard]] double at_y(double value) const { return top + plot_height * (1 - y_.place(value)); }

    void line(const char* kind, double x0, double y0, double x1, double y1) {
        out_ += fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", kind, x0, y0, x1, y1);
    }
    void text(const char* anchor, double x, double y, const std::string& words, const char* more = "") {
        out_ += fmt::format("<text text-anchor=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", anchor, x, y, more, escaped(words));
    }

    void draw_axes() {
        double last = -1e9;
        for (const double tick : x_.ticks) {
            line("grid", at_x(tick), top, at_x(tick), top + plot_height);
            const std::string words = value_text(tick, chart_.x.unit);
            const double half = letter_width * static_cast<double>(words.size()) / 2;
            if (at_x(tick) - half < last || at_x(tick) + half > width) continue;
            text("middle", at_x(tick), top + plot_height + 18, words);
            last = at_x(tick) + half + letter_width;
        }
        last = 1e9;
        for (const double tick : y_.ticks) {
            line("grid", left, at_y(tick), left + plot_width, at_y(tick));
            if (at_y(tick) > last - line_height) continue;
            text("end", left - 8, at_y(tick) + 4, value_text(tick, chart_.y.unit));
            last = at_y(tick);
        }
        line("axis", left, top + plot_height, left + plot_width, top + plot_height);
        line("axis", left, top, left, top + plot_height);
        text("middle", left + plot_width / 2, height - 12, chart_.x.title);
        text("middle", 14, top + plot_height / 2, chart_.y.title, fmt::format(" transform=\"rotate(-90 14 {:.1f})\"", top + plot_height / 2).c_str());
    }

    void draw_diagonal() {
        const double least = std::max(x_.least, y_.least), most = std::min(x_.most, y_.most);
        if (least < most) line("front", at_x(least), at_y(least), at_x(most), at_y(most));
    }

    void draw_front() {
        if (chart_.front.empty()) return;
        // A step: between two points nothing better than the cheaper one has been measured.
        const ChartPoint& first = chart_.points[chart_.front.front()];
        std::string path = fmt::format("M{:.1f} {:.1f}", at_x(first.x), at_y(first.y));
        for (std::size_t k = 1; k < chart_.front.size(); ++k) {
            const ChartPoint& point = chart_.points[chart_.front[k]];
            path += fmt::format("H{:.1f}V{:.1f}", at_x(point.x), at_y(point.y));
        }
        out_ += fmt::format("<path class=\"front\" d=\"{}H{:.1f}\"/>\n", path, left + plot_width);
    }

    void draw_point(const ChartPoint& point) {
        const double radius = point.is_preset || point.is_chosen ? 6.5 : 4.5;
        const std::string kind = std::string("point") + (point.is_preset ? " preset" : "") + (point.is_chosen ? " chosen" : "") + (point.is_uncertain ? " uncertain" : "");
        out_ += fmt::format("<a href=\"{}\"><circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"><title>{}\n{}: {}\n{}: {}</title></circle></a>\n", escaped(point.link), kind, at_x(point.x),
                            at_y(point.y), radius, escaped(point.name), escaped(chart_.x.title), value_text(point.x, chart_.x.unit), escaped(chart_.y.title), value_text(point.y, chart_.y.unit));
        taken_.push_back({at_x(point.x) - radius, at_y(point.y) - radius, at_x(point.x) + radius, at_y(point.y) + radius});
    }

    /// At the first of four places beside the point where nothing else is; else at the last.
    void draw_label(const ChartPoint& point) {
        const double x = at_x(point.x), y = at_y(point.y), length = letter_width * static_cast<double>(point.label.size());
        struct Place {
            double x, y;
            const char* anchor;
            Box box;
        };
        const auto rightward = [&](double px, double py) { return Place{px, py, "start", {px, py - line_height + 2, px + length, py + 3}}; };
        const auto leftward = [&](double px, double py) { return Place{px, py, "end", {px - length, py - line_height + 2, px, py + 3}}; };
        const Place places[]{rightward(x + 9, y - 7), leftward(x - 9, y - 7), leftward(x - 9, y + 15), rightward(x + 9, y + 15), rightward(x + 9, y - 22), leftward(x - 9, y + 30)};
        const auto fits = [&](const Place& place) {
            return place.box.x0 >= left && place.box.x1 <= width && place.box.y0 >= 0 && place.box.y1 <= top + plot_height &&
                   std::ranges::none_of(taken_, [&](const Box& box) { return box.meets(place.box); });
        };
        const auto* found = std::ranges::find_if(places, fits);
        const Place& place = found == std::end(places) ? places[3] : *found;
        taken_.push_back(place.box);
        text(place.anchor, place.x, place.y, point.label, " class=\"name\"");
    }

    const Chart& chart_;
    LogAxis x_, y_;
    std::vector<Box> taken_;
    std::string out_;
};

}  // namespace

std::string chart_svg(const Chart& chart) { return Drawing(chart).svg(); }

std::string value_text(double value, ChartUnit unit) {
    // Two digits, but never 1e+02.
    const auto rounded = [](double number) { return number < 99.5 ? fmt::format("{:.2g}", number) : fmt::format("{:.0f}", number); };
    if (unit == ChartUnit::share) return rounded(100 * value) + " %";
    if (unit == ChartUnit::seconds) return rounded(value) + " s";
    constexpr const char* names[]{"B", "KB", "MB", "GB", "TB"};
    std::size_t name = 0;
    for (; value >= base_of_bytes && name + 1 < std::size(names); ++name) value /= base_of_bytes;
    return rounded(value) + " " + names[name];
}

std::string escaped(const std::string& text) {
    std::string safe;
    for (const char letter : text) {
        if (letter == '&') safe += "&amp;";
        else if (letter == '<') safe += "&lt;";
        else if (letter == '>') safe += "&gt;";
        else if (letter == '"') safe += "&quot;";
        else safe += letter;
    }
    return safe;
}

}  // namespace luxel
