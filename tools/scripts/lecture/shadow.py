"""The edge of a shadow across regular patches: the lecture's Figure 3."""
import math
import os

import numpy as np

from lecture.common import Chart, bake, difference, light_along, percent, save_charts, table
from gltf_writer import Gltf, box, rectangle

DENSITY = 16            # texels per metre
LAMP, CARD = (-1.2, 2.2, -0.6), (-0.2, 0.7, -0.1)   # a point of light, and the middle of a card below it, m
CARD_HALF, TURN = 0.4, 25.0   # of the card, m; about Y, so that its shadow crosses the patches slantwise, degrees
SIZES = [2, 4, 8, 16, 32]
WAYS = {"constant": ["--gather", "off", "--interpolation", "constant"], "linear": ["--gather", "off", "--interpolation", "linear"],
        "cubic": ["--gather", "off", "--interpolation", "catmull-rom"], "gathered": ["--gather-rays", "128"]}
COLOURS = {"constant": "#7f8c8d", "linear": "#2471a3", "cubic": "#c0392b", "gathered": "#239b56"}
SHOWN = [4, 8, 16]
HALF_LINE = 0.55   # of the line across the edge, m
CAMERA, PANEL = ((1.5, 1.9, 2.1), (0.35, 0.0, 0.1)), (220, 165)


def write_scene(folder):
    """A grey floor of 4 x 4 m, a lamp, and a card between them."""
    gltf = Gltf()
    grey = gltf.material("grey", (0.6, 0.6, 0.6))
    gltf.piece("floor", [rectangle(1, 0.0, (-2, -2), (2, 2), 1)], grey)
    gltf.node("card", gltf.mesh("card", box((-CARD_HALF, -0.01, -CARD_HALF), (CARD_HALF, 0.01, CARD_HALF)), grey), translation=CARD, turn_degrees=TURN)
    gltf.lamp("lamp", {"type": "point", "intensity": 400.0}, LAMP)
    gltf.save(folder, "shadow")
    return os.path.join(folder, "shadow.gltf")


def edge_line(half_length):
    """Ends of a line on the floor that crosses the middle of an edge of the shadow at a right angle."""
    way = np.array([math.cos(math.radians(TURN)), 0.0, -math.sin(math.radians(TURN))])
    lamp, edge = np.array(LAMP), np.array(CARD) + CARD_HALF * way
    middle = lamp + (edge - lamp) * lamp[1] / (lamp[1] - edge[1])
    middle[1] = 0.0
    return middle - half_length * way, middle + half_length * way


def across(path):
    """Light along edge_line, ten points to a texel."""
    return light_along(path, *edge_line(HALF_LINE), int(2 * HALF_LINE * DENSITY * 10))


def blurred(path, right):
    """Texels across the edge whose light is off by more than a tenth of the step from dark to lit."""
    true = across(right)
    return float((np.abs(across(path) - true) > 0.1 * (true.max() - true.min())).sum()) / 10


def pictures(setting, made, right):
    import camera as cameras
    import panels
    import render
    camera = cameras.Camera(*CAMERA, 42.0)
    exposure = 1.2 * render.automatic_exposure(*render.View(right.path).shade(camera.position, camera.directions(*PANEL, 1), True))
    views = {f"{way}, patches of {size}": render.View(made[size, way].path) for way in ("constant", "linear", "gathered") for size in SHOWN}
    panels.save(panels.sheet(views, camera, exposure, PANEL, len(SHOWN)), setting.picture("shadow.jpg"), 70000)
    charts = []
    for size in (4, 16):
        chart = Chart(f"patches of {size} texels", "m across the edge", "irradiance over that in the light", (0, 1.1), (0, 1.4))
        chart.ticks(0, (0, 0.2, 0.4, 0.6, 0.8, 1.0), lambda v: f"{v:g}")
        chart.ticks(1, (0, 0.5, 1), lambda v: f"{v:g}")
        for row, way in enumerate(WAYS):
            light = across(made[size, way].path) / across(right.path).max()
            chart.line(list(zip(np.linspace(0, 2 * HALF_LINE, len(light)), light)), COLOURS[way], way, row)
        charts.append(chart)
    save_charts(setting.picture("shadow_edge.svg"), charts)


def main(setting):
    scene = write_scene(os.path.join(setting.work, "shadow"))
    sizes = [4, 16] if setting.quick else SIZES
    plain = ["--texels-per-metre", str(DENSITY), "--rays", "1024"]
    right = bake(setting, scene, "shadow", "right", ["--quality", "high", *plain, "--patch-texels", "2", "--gather-rays", "1024"])
    made = {(size, way): bake(setting, scene, "shadow", f"{size}-{way}", ["--quality", "medium", *plain, "--patch-texels", str(size), *options])
            for size in sizes for way, options in WAYS.items()}
    light = right.light()
    results = {key: (difference(b.light(), light), blurred(b.path, right.path)) for key, b in made.items()}
    print("Difference from gathered light of 1,024 rays; texels across the edge that are off by more than a tenth of the step\n")
    table(["patch, texels", "patches", *WAYS], [[str(size), f"{made[size, 'linear'].report['counts']['patches']:,}",
          *(f"{percent(results[size, way][0])}; {results[size, way][1]:.1f}" for way in WAYS)] for size in sizes])
    if not setting.quick:
        pictures(setting, made, right)
    return results


def check(results):
    assert results[4, "constant"][0] < 0.7 * results[16, "constant"][0], f"smaller patches are not better: {results}"
    assert results[16, "linear"][1] > 2 * results[4, "linear"][1] > 2, f"interpolation does not blur the edge by the patch: {results}"
    assert results[16, "gathered"][0] < 0.1 * results[16, "linear"][0], f"gathered light depends on the patches: {results}"
    assert results[16, "gathered"][1] < 1, f"gathered edges are not sharp: {results}"
