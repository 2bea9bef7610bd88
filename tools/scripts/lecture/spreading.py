"""Patches spread over texels: constant, linear, cubic. Is cubic worth it?"""
import os

import numpy as np

from lecture.common import Chart, bake, difference, light_along, percent, sample, save_charts, table

SCENES = {"cornell_box": ["--texels-per-metre", "96"], "two_rooms": ["--texels-per-metre", "16"]}
METHODS = {"constant": "#7f8c8d", "linear": "#2471a3", "corners": "#7d6608", "cubic-bspline": "#239b56", "catmull-rom": "#c0392b"}
SIZES = [2, 4, 8, 16]   # texels along a patch
RAYS = 4096             # so many that patches are right and only the spreading is wrong
PROFILE = ("cornell_box", 8, (0.02, 0.0, 0.06), (0.53, 0.0, 0.06))   # scene, patch, along the front of the floor, m


def measure(setting, scene, sizes, methods):
    """(size, method) -> bake; and what is gathered."""
    group, rays = os.path.join("spreading", scene), 512 if setting.quick else RAYS
    plain = ["--tolerance", "1e-5", "--rays", str(rays), *SCENES[scene]]
    gathered = bake(setting, sample(scene), group, "gathered", ["--quality", "high", *plain])
    return {(size, method): bake(setting, sample(scene), group, f"{size}-{method}", ["--quality", "draft", *plain, "--patch-texels", str(size), "--interpolation", method])
            for size in sizes for method in methods}, gathered


def size_for(error, sizes, errors):
    """Patches of which size have this error, between those that were measured; None: beyond them."""
    if not min(errors) <= error <= max(errors):
        return None
    return float(np.exp(np.interp(np.log(error), np.log(errors), np.log(sizes))))


def profile(setting, spread, gathered):
    """The lecture's Figure 2 with real values: light along a line over the patches of a floor."""
    scene, size, start, end = PROFILE
    count = 500
    x = np.linspace(0, np.linalg.norm(np.subtract(end, start)) * 100, count)
    right = light_along(gathered.path, start, end, count)
    charts = []
    for names in (("constant", "linear"), ("cubic-bspline", "catmull-rom")):
        chart = Chart(" and ".join(names), "cm along the floor", "irradiance over its mean", (0, 52), (0, 2), names=(230, 90))
        chart.ticks(0, range(0, 51, 10), str)
        chart.ticks(1, (0, 0.5, 1, 1.5, 2), lambda v: f"{v:g}")
        chart.line(list(zip(x, right / right.mean())), "#bbb", "gathered", 0)
        for row, name in enumerate(names):
            values = light_along(spread[size, name].path, start, end, count)
            chart.line(list(zip(x, values / right.mean())), METHODS[name], name, row + 1)
        charts.append(chart)
    save_charts(setting.picture("spreading.svg"), charts)


def main(setting):
    results = {}
    scenes, sizes, methods = (["cornell_box"], [4, 8], ["constant", "linear", "catmull-rom"]) if setting.quick else (list(SCENES), SIZES, list(METHODS))
    for scene in scenes:
        spread, gathered = measure(setting, scene, sizes, methods)
        right = gathered.light()
        error = results[scene] = {key: difference(made.light(), right) for key, made in spread.items()}
        print(f"{scene}: difference from gathered light, {RAYS} rays per patch\n")
        table(["patch, texels", "patches", *methods], [[str(size), f"{spread[size, 'linear'].report['counts']['patches']:,}",
              *(percent(error[size, m]) for m in methods)] for size in sizes])
        linear = [error[size, "linear"] for size in sizes]
        for cubic in (m for m in methods if m not in ("constant", "linear")):
            same = {size: size_for(error[size, cubic], sizes, linear) for size in sizes}
            ratios = ", ".join(f"{error[size, cubic] / of_linear:.2f}" for size, of_linear in zip(sizes, linear))
            print(f"{cubic}: error over that of linear {ratios}; linear is as good with patches of "
                  f"{', '.join(f'{same[size]:.2g}' if same[size] else '-' for size in sizes)} texels")
        print("seconds of the page: " + ", ".join(f"{m} {spread[4, m].seconds('light'):.2f}" for m in methods) + "\n", flush=True)
        if scene == PROFILE[0] and not setting.quick:
            profile(setting, spread, gathered)
    return results


def check(results):
    error = results["cornell_box"]
    assert error[4, "linear"] < error[8, "linear"], f"smaller patches are not better: {error}"
    assert error[4, "linear"] < 0.8 * error[4, "constant"], f"interpolation is no better than steps: {error}"
    assert 0.5 < error[4, "catmull-rom"] / error[4, "linear"] < 1.5, f"cubic and linear are not alike: {error}"
