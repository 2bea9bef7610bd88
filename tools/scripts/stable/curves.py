"""Four curves: error against scale, emission, albedo, and the ratio of patch areas."""
import math
import os

from lecture.common import Chart, save_charts
from stable import rooms
from stable.runs import Failed, measure as measure_room, plain

LEAST = 1e-16   # what the curves show of an error of nothing
SERIES = {"worst": ("luxel, worst texel", "#2471a3", ""), "all": ("luxel, all light", "#239b56", ""), "floor": ("luxel, floor of a box", "#8e44ad", ""),
          "double": ("sums in double", "#7f8c8d", "5 3"), "single": ("sums in single", "#c0392b", "")}
WITHOUT_FLOOR = ("albedo", "area")   # that floor is black, and what floats above it hides the ceiling
# File, title, x axis, values, room.
CURVES = [("scale", "size of the scene", "m", [10.0 ** k for k in range(-6, 7)], lambda v: plain(side=v)),
          ("emission", "emission", "nits", [10.0 ** k for k in range(-30, 31, 5)], lambda v: plain(nits=v)),
          ("albedo", "albedo", "1 - albedo", [1.0, 0.5, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6], lambda v: plain(rho=1 - v)),
          ("area", "a smaller patch", "times smaller in area", [10.0 ** k for k in range(0, 13)], lambda v: lambda lit: rooms.with_mote(lit, v))]


def measure(build, folder, quick):
    """File -> [(x, {series: error})]; a refused bake is infinitely wrong."""
    found = {}
    for name, _, _, values, make in CURVES:
        found[name] = []
        for value in (values[0], values[-1]) if quick else values:
            try:
                figures = measure_room(build, folder, make(value))
            except Failed as failed:
                print(f"{name} {value:g}: {failed}")
                figures = dict.fromkeys(SERIES, math.inf)
            found[name].append((value, {key: figures[key] for key in SERIES if key != "floor" or name not in WITHOUT_FLOOR}))
    return found


def show(lines):
    for name, points in lines.items():
        print(f"{name}: " + "; ".join(f"{text} {max(p[key] for _, p in points):.1e} at most" for key, (text, _, _) in SERIES.items() if key in points[0][1]))


def draw(lines, out):
    for name, title, unit, values, _ in CURVES:
        chart = Chart(title, unit, "relative error", (min(values), max(values)), (LEAST, 10.0), (True, True), None if name == "albedo" else (10, 92))
        every = max(1, len(values) // 6)
        chart.ticks(0, sorted(values)[::every], lambda v: f"{v:g}" if 1e-3 <= v <= 1e3 else f"{v:.0e}")
        chart.ticks(1, [10.0 ** k for k in range(-16, 1, 4)], lambda v: f"{v:.0e}" if v < 1 else "1")
        shown = [(key, *style) for key, style in SERIES.items() if key in lines[name][0][1]]
        for row, (key, text, colour, dash) in enumerate(shown):
            points = [(x, min(max(p[key], LEAST), 10.0)) for x, p in lines[name] if not math.isnan(p[key])]
            chart.line(points, colour, text, row, dash, dots=True)
        save_charts(os.path.join(out, name + ".svg"), [chart])


def check(lines):
    for name, points in lines.items():
        for x, p in points:
            assert p["worst"] < 1e-2 and p["all"] < 1e-2 and p.get("floor", 0) < 2e-2, f"{name} {x}: {p}"
    assert lines["albedo"][1][1]["single"] > 1e2 * lines["albedo"][0][1]["single"], f"single precision does not suffer: {lines['albedo']}"
