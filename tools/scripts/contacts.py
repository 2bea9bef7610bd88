#!/usr/bin/env python3
"""Remakes the pictures of docs/texel-light.md: small scenes baked by two builds of luxel, light only, beside each other; prints how far the light is off.

usage: build/deps/reference/bin/python tools/scripts/contacts.py [--before LUXEL] [--luxel LUXEL] [--out docs/contacts] [--work DIR] [SCENE ...]

round    a ball of 12 meridians and 8 circles of latitude with round normals, in the sun and under a sky
foot     a box with a post in it, sunk into the floor of a room: texels of the floor along its outline against path tracing
corner   a box that stands in the corner of a room: a draft, which has the light of patches, beside gathered light and path tracing
--before: an older build for the left half of round and foot; without it these have one half.
"""
import argparse
import math
import os
import subprocess
import sys
import tempfile

import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path[:0] = [os.path.join(ROOT, "tests", "reference"), os.path.join(ROOT, "samples")]
import camera as cameras   # noqa: E402
import panels       # noqa: E402
import reference    # noqa: E402
import render       # noqa: E402
from gltf_writer import Gltf, box, rectangle   # noqa: E402

PANEL = (360, 300)
DENSITY = 16   # texels per metre of the box
HALF = (0.45, 0.35)   # of the sunk box
PLACE, TURN = (1.7, 1.6), 20.0
BOX = ((0.4, 0.0, 0.04), (0.9, 0.4, 0.44))   # 4 cm from the wall behind it
PATHS = 64   # of a sample of the path traced picture, which has nine a pixel


def smooth(gltf, name, points, triangles, normals, material):
    """A mesh with shared corners and normals."""
    import struct
    pack = lambda rows: b"".join(struct.pack("<3f", *row) for row in rows)   # noqa: E731
    limits = {"min": [min(p[k] for p in points) for k in range(3)], "max": [max(p[k] for p in points) for k in range(3)]}
    position = gltf._accessor(pack(points), 5126, "VEC3", len(points), 34962, **limits)
    normal = gltf._accessor(pack(normals), 5126, "VEC3", len(points), 34962)
    flat = [k for t in triangles for k in t]
    index = gltf._accessor(struct.pack(f"<{len(flat)}H", *flat), 5123, "SCALAR", len(flat), 34963)
    gltf.meshes.append({"name": name, "primitives": [
        {"attributes": {"POSITION": position, "NORMAL": normal}, "indices": index, "material": material, "mode": 4}]})
    return len(gltf.meshes) - 1


def ball(meridians, circles):
    """Points on the unit sphere, triangles with their fronts outwards."""
    points = [(0.0, 1.0, 0.0), (0.0, -1.0, 0.0)]
    for row in range(1, circles):
        down = math.pi * row / circles
        for k in range(meridians):
            around = 2 * math.pi * k / meridians
            points.append(tuple(float(np.float32(c)) for c in (math.sin(down) * math.cos(around), math.cos(down), math.sin(down) * math.sin(around))))

    def corner(row, k):
        return 0 if row == 0 else 1 if row == circles else 2 + (row - 1) * meridians + k % meridians
    triangles = []
    for row in range(circles):
        for k in range(meridians):
            a, b, c, d = corner(row, k), corner(row, k + 1), corner(row + 1, k + 1), corner(row + 1, k)
            triangles += ([(a, b, c)] if row > 0 else []) + ([(a, c, d)] if row + 1 < circles else [])
    return points, triangles


def round_scene(folder):
    gltf = Gltf()
    white = gltf.material("white", (0.6, 0.6, 0.6))
    gltf.piece("floor", [rectangle(1, -1.0, (-4, -4), (4, 4), 1)], white)
    points, triangles = ball(12, 8)
    gltf.node("ball", smooth(gltf, "ball", points, triangles, points, white))
    gltf.lamp("sun", {"type": "directional", "intensity": 6000.0}, (0, 5, 0), (-0.83, -0.31, -0.2))
    gltf.save(folder, "round")


def white_room(panel_x):
    """A room of 3 x 2.5 x 3 m, lit by a panel below its ceiling that begins at this x; and a grey material for what stands in it."""
    gltf = Gltf()
    white, grey = gltf.material("white", (0.7, 0.7, 0.7)), gltf.material("grey", (0.5, 0.5, 0.5))
    lamp = gltf.material("lamp", (0, 0, 0), [2000] * 3)
    walls = [rectangle(axis, at, low, high, sign) for axis, low, high in ((0, (0, 0), (2.5, 3)), (1, (0, 0), (3, 3)), (2, (0, 0), (3, 2.5)))
             for at, sign in ((0.0, 1), (2.5 if axis == 1 else 3.0, -1))]
    gltf.piece("walls", walls, white)
    gltf.piece("panel", [rectangle(1, 2.45, (panel_x, 1.0), (panel_x + 0.6, 1.6), -1)], lamp)
    return gltf, grey


def foot_scene(folder):
    gltf, grey = white_room(1.0)
    gltf.node("box", gltf.mesh("box", box((-HALF[0], -0.4, -HALF[1]), (HALF[0], 0.5, HALF[1])), grey), translation=(PLACE[0], 0, PLACE[1]), turn_degrees=TURN)
    gltf.node("post", gltf.mesh("post", box((-0.05, -0.4, -0.05), (0.05, 1.2, 0.05)), grey), translation=(PLACE[0] + 0.05, 0, PLACE[1]), turn_degrees=50)
    gltf.save(folder, "foot")


def corner_scene(folder):
    gltf, grey = white_room(1.7)
    gltf.piece("box", box(*BOX, omit=("-y",)), grey)
    gltf.save(folder, "corner")


def outside_m(points):
    """How far places are outside of the box's outline."""
    a, x, z = math.radians(TURN), points[:, 0] - PLACE[0], points[:, 2] - PLACE[1]
    return np.maximum(abs(x * math.cos(a) - z * math.sin(a)) - HALF[0], abs(x * math.sin(a) + z * math.cos(a)) - HALF[1])


SCENES = {"round": (round_scene, ["--texels-per-metre", "24", "--sky-color", "40,48,60"], ((-0.7, 0.5, 2.9), (0.0, -0.1, 0))),
          "foot": (foot_scene, ["--texels-per-metre", str(DENSITY)], ((0.45, 0.75, 2.75), (1.75, 0.1, 1.55))),
          "corner": (corner_scene, ["--texels-per-metre", str(DENSITY)], ((1.3, 0.65, 1.2), (0.55, 0.16, 0.25)))}


class TrueView(render.View):
    """What path tracing finds where View reads the lightmap."""

    def shade(self, position, directions, light_only=False):
        triangle, weights, _, front = self.hits(position, directions)
        points = (weights[front][..., None] * self.scene.corners[triangle[front]]).sum(1)[:, None]
        flat = self.scene.flat[triangle[front]][:, None]
        light = np.zeros((len(directions), 3))
        light[front] = self.tracer.irradiance(points, flat, flat, PATHS)[0] / np.pi
        return light, front


def bake(luxel, folder, scene, name, *options):
    out = os.path.join(folder, name, scene + ".glb")
    subprocess.run([luxel, "bake", os.path.join(folder, scene + ".gltf"), "-o", out, "-q", *SCENES[scene][1], *options], check=True)
    return out


def report_foot(folder, out, name):
    """Light of the floor's texels that the outline of the box cuts, against path tracing."""
    _, arrays, _ = reference.compare(os.path.join(folder, "foot.gltf"), out, 6000, 512)
    place = arrays["position"]
    chosen = (abs(place[:, 1]) < 1e-3) & (abs(outside_m(place)) < 0.5 / DENSITY)
    baked, truth = (arrays[k][chosen] @ reference.LUMINANCE for k in ("baked", "truth"))
    print(f"foot, {name}: {chosen.sum()} texels, light {baked.sum() / truth.sum() - 1:+.1%}, median error {np.median(abs(baked - truth) / truth):.1%}", flush=True)


def report_corner(folder, paths):
    """Light of the texels along contacts against path tracing."""
    truth = reference.Truth(os.path.join(folder, "corner.gltf"), paths["draft"], 6000, 512)
    for name, out in paths.items():
        _, arrays, _ = truth.against(out)
        chosen = is_at_contact(arrays["position"])
        found = reference.figures(*(arrays[k][chosen] for k in ("baked", "truth", "error")))
        print(f"corner, {name}: {found['points']} texels, light {found['bias']:+.1%}, median error {found['median']:.1%}, "
              f"95 % below {found['p95']:.0%}", flush=True)


def is_at_contact(place):
    """Is a place within a texel of two of these: the floor, the two walls, the box?"""
    at_box = np.maximum(BOX[0] - place, place - BOX[1]).max(1) < 1 / DENSITY
    return (place < 1 / DENSITY).sum(1) + at_box >= 2


def picture(views, camera, target):
    camera = cameras.Camera(*camera, 45.0)
    last = list(views.values())[-1]
    exposure = 1.3 * render.automatic_exposure(*last.shade(camera.position, camera.directions(*PANEL, 1), True))
    panels.save(panels.sheet(views, camera, exposure, PANEL, len(views)), target, 60000)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(SCENES))
    parser.add_argument("--before", metavar="LUXEL")
    parser.add_argument("--luxel", default=os.path.join(ROOT, "build", "dev", "tools", "luxel", "luxel"))
    parser.add_argument("--out", default=os.path.join(ROOT, "docs", "contacts"), metavar="DIR")
    parser.add_argument("--work", metavar="DIR")
    options = parser.parse_args()
    unknown = [scene for scene in options.scenes if scene not in SCENES]
    if unknown:
        parser.error(f"no scene {', '.join(unknown)}; known are {', '.join(SCENES)}")
    os.makedirs(options.out, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        folder = os.path.abspath(options.work or temporary)
        for scene in options.scenes or SCENES:
            make, _, camera = SCENES[scene]
            make(folder)
            if scene == "corner":
                paths = {quality: bake(options.luxel, folder, scene, quality, "--quality", quality) for quality in ("draft", "medium")}
            else:
                builds = {"before": options.before, "after": options.luxel} if options.before else {"after": options.luxel}
                paths = {name: bake(luxel, folder, scene, name) for name, luxel in builds.items()}
            views = {name: render.View(path) for name, path in paths.items()}
            if scene == "corner":
                views["path tracing"] = TrueView(paths["medium"])
            picture(views, camera, os.path.join(options.out, scene + ".png"))
            if scene == "corner":
                report_corner(folder, paths)
            if scene == "foot":
                for name, out in paths.items():
                    report_foot(folder, out, name)


if __name__ == "__main__":
    main()
