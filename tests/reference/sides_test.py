#!/usr/bin/env python3
"""Two-sided surfaces whose fronts lie in the dark: the bake says so, and with --two-sided lit their texels hold the light of their backs.

usage: sides_test.py LUXEL

The wedges of copies_test.py around a lamp, wound inside out: fronts see the closed inside, backs the lamp. E = I cos / r2 on the backs that face the
lamp, 0 elsewhere.
"""
import json
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from interpreter import ROOT, use_reference_python   # noqa: E402

sys.path.insert(0, os.path.join(ROOT, "samples"))
import copies_test   # noqa: E402
from gltf_writer import Gltf   # noqa: E402

POINTS = 4000


def scene(double_sided, sign):
    gltf = Gltf()
    gltf.lamp("lamp", {"type": "point", "intensity": copies_test.CANDELA}, (0, 0.5, 0), (0, 0, -1))
    black = gltf.material("black", (0, 0, 0), double_sided=double_sided)
    wedge = gltf.mesh("wedge", [copies_test.outward(f, sign) for f in copies_test.WEDGE], black)
    for k, place in enumerate(copies_test.placements()):
        gltf.nodes[gltf.node(f"copy {k}", wedge)].update(place)
    return gltf


def bake(luxel, folder, name, gltf, sides):
    import numpy as np
    from gltf_scene import Scene
    from lightmap import Lightmaps
    source, baked, report = (os.path.join(folder, name + end) for end in (".gltf", ".glb", ".json"))
    gltf.save(folder, name)
    subprocess.run([luxel, "bake", source, "-o", baked, "--quality", "medium", "--texels-per-metre", "24", "--atlas-size", "256", "--two-sided", sides, "--report", report, "-q"],
                   check=True, timeout=300, stderr=subprocess.DEVNULL)
    read = Scene(baked)
    noise = np.random.default_rng(7)
    triangle = noise.choice(len(read.areas), POINTS, p=read.areas / read.areas.sum())
    weights = noise.dirichlet([2, 2, 2], POINTS)
    points = np.einsum("nk,nkc->nc", weights, read.corners[triangle])
    found = Lightmaps(read, baked).sample(triangle, weights).mean(1)
    with open(report, encoding="utf-8") as file:
        said = json.load(file)
    return points, read.flat[triangle], found, said["dark_fronts"], "dark-fronts" in [w["code"] for w in said["warnings"]]


def errors(found, truth):
    """Median and 95 % of the relative error where there is light; the brightest where there is none."""
    import numpy as np
    lit = truth > 2
    error = np.abs(found - truth)[lit] / truth[lit]
    return np.median(error), np.quantile(error, 0.95), np.abs(found[truth == 0]).max()


def check(name, good, *figures):
    print(f"{'ok' if good else 'WRONG'}: {name}:", *figures)
    return bool(good)


def main():
    use_reference_python()
    luxel = os.path.abspath(sys.argv[1])
    good = []
    with tempfile.TemporaryDirectory(prefix="luxel-sides-") as folder:
        _, _, found, dark, warned = bake(luxel, folder, "inside-out", scene(True, -1), "front")
        good.append(check("fronts are dark, and the bake says so", found.max() == 0 and warned and not dark["turned"], found.max(), dark))
        points, normals, found, dark, warned = bake(luxel, folder, "inside-out-lit", scene(True, -1), "lit")
        median, p95, most = errors(found, copies_test.expected(points, -normals))
        good.append(check("texels hold the light of the backs", median < 0.005 and p95 < 0.03 and dark["turned"] and not warned,
                          f"median {100 * median:.2f} %, 95 % {100 * p95:.1f} %, in the dark at most {most:.2f} lx, {dark}"))
        points, normals, found, dark, warned = bake(luxel, folder, "outside-lit", scene(True, 1), "lit")
        median, p95, most = errors(found, copies_test.expected(points, normals))
        good.append(check("lit fronts stay", median < 0.005 and p95 < 0.03 and dark["charts"] == 0,
                          f"median {100 * median:.2f} %, 95 % {100 * p95:.1f} %, {dark}"))
        _, _, found, dark, warned = bake(luxel, folder, "one-sided-lit", scene(False, -1), "lit")
        good.append(check("one-sided surfaces have no other side", found.max() == 0 and dark["charts"] == 0 and not warned, found.max(), dark))
    sys.exit(0 if all(good) else 1)


if __name__ == "__main__":
    main()
