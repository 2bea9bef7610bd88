#!/usr/bin/env python3
"""Units of light: each kind of lamp alone, baked by luxel and rendered by Mitsuba's own emitter of that kind with the same number.

usage: units_test.py LUXEL

Mitsuba's part is stock.py: its path integrator, emitters and material in scalar_rgb, without formulas of this project for lamps. Prints a
table; exit status 1: the means differ by more than four standard errors and 0.5 %.
"""
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from interpreter import ROOT, use_reference_python   # noqa: E402

sys.path.insert(0, os.path.join(ROOT, "samples"))
from gltf_writer import Gltf, rectangle   # noqa: E402

POINTS, SPP = 12, 1024
ROOM = 0.005    # of the bake's own noise and of the footprint's points


def floor(lamp=None, direction=(0, 0, -1), position=(0, 1, 0)):
    """A black floor of 2 x 2 m with one lamp."""
    gltf = Gltf()
    gltf.piece("floor", [rectangle(1, 0.0, (-1, -1), (1, 1), 1)], gltf.material("floor", (0, 0, 0)))
    if lamp:
        gltf.lamp("lamp", lamp, position, direction)
    return gltf


def panel():
    """A black floor under a panel of 1 x 1 m, 1 m above, that shines down."""
    gltf = floor()
    gltf.piece("panel", [rectangle(1, 1.0, (-0.5, -0.5), (0.5, 0.5), -1)], gltf.material("panel", (0, 0, 0), (500, 400, 300)))
    return gltf


def furnace():
    """A closed cube of 1 m; every wall emits and reflects."""
    gltf = Gltf()
    glow = gltf.material("glow", (0.5, 0.5, 0.5), (100, 100, 100))
    for axis in range(3):
        for sign in (-1, 1):
            gltf.piece(f"wall_{axis}_{sign}", [rectangle(axis, sign / 2, (-0.5, -0.5), (0.5, 0.5), -sign)], glow)
    return gltf


LAMPS = [   # name, numbers given to both, Mitsuba's emitter, scene, sky in nits
    ("point", "100, 80, 60 cd", "point", lambda: floor({"type": "point", "intensity": 100.0, "color": [1, 0.8, 0.6]}, position=(0.3, 1, -0.2)), ()),
    ("directional", "3000 lx", "directional", lambda: floor({"type": "directional", "intensity": 3000.0}, (0.4, -1, 0.2)), ()),
    ("emissive surface", "500, 400, 300 nits", "area", panel, ()),
    ("sky", "1000, 2000, 3000 nits", "constant", floor, (1000, 2000, 3000)),
    ("emission and reflection", "100 nits, 0.5", "area", furnace, ()),
]


def compare(luxel, gltf, sky, folder):
    import lights
    import reference
    import stock
    gltf.save(folder, "scene")
    scene, baked = os.path.join(folder, "scene.gltf"), os.path.join(folder, "baked.glb")
    more = ["--sky-color", ",".join(map(str, sky))] if sky else []
    subprocess.run([luxel, "bake", scene, "-o", baked, "-q", "--texels-per-metre", "32", *more], check=True)
    truth = reference.Truth(scene, baked, POINTS, SPP, light=lights.Light(sky_color=sky), module=stock)
    return truth.against(baked)[0]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    use_reference_python()
    good = True
    print("| lamp | given to both | Mitsuba's emitter | luxel, mean lx | Mitsuba, mean lx | luxel / Mitsuba - 1 | standard error of Mitsuba |\n"
          "|---|---|---|---|---|---|---|")
    for name, numbers, emitter, scene, sky in LAMPS:
        with tempfile.TemporaryDirectory(prefix="luxel-units-") as folder:
            f = compare(sys.argv[1], scene(), sky, folder)
        held = abs(f["bias"]) <= 4 * f["bias_se"] + ROOM
        good &= held
        print(f"| {name} | {numbers} | `{emitter}` | {f['mean_baked']:.5g} | {f['mean_truth']:.5g} | {f['bias']:+.3%}{'' if held else ' FAILED'} "
              f"| {f['bias_se']:.3%} |", flush=True)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
