"""What the figures of docs/claims.md share: bakes that are made once, light of texels, tables, curves."""
import json
import math
import os
import subprocess
import sys

import numpy as np

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", ".."))
sys.path[:0] = [os.path.join(ROOT, "tests", "reference"), os.path.join(ROOT, "samples"), os.path.join(ROOT, "tools", "scripts")]
import gltf_scene   # noqa: E402
import lightmap     # noqa: E402

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


class Setting:
    """Programs, folders, and whether this is the quick run of the tests: smallest cases, no pictures."""

    def __init__(self, build, scenes, work, out, quick):
        self.luxel = os.path.join(build, "tools", "luxel", "luxel")
        self.partial_light = os.path.join(build, "tests", "figures", "partial_light")
        self.estimator_bench = os.path.join(build, "tests", "bench", "estimator_bench")
        self.scenes, self.work, self.out, self.quick = scenes, os.path.abspath(work), out, quick

    def picture(self, name):
        os.makedirs(self.out, exist_ok=True)
        return os.path.join(self.out, name)


class Bake:
    """A bake: `path` of its model, `report`, and on demand the light of its texels."""

    def __init__(self, path):
        self.path = path
        with open(path + ".report.json", encoding="utf-8") as file:
            self.report = json.load(file)

    def light(self):
        """Luminance of irradiance (N) of the texels that hold light of their own, page by page."""
        with open(self.path + ".lightmaps.json", encoding="utf-8") as file:
            pages = json.load(file)["pages"]
        folder = os.path.dirname(self.path)
        return np.concatenate([(lightmap.read_exr(os.path.join(folder, p["exr"]["uri"])) @ LUMINANCE)[read_valid(os.path.join(folder, p["layers"]["uri"]))]
                               for p in pages])

    def seconds(self, *stages):
        return sum(s["seconds"] for s in self.report["stages"] if s["name"] in stages)


def read_valid(path):
    """Where a page's texels hold light of their own."""
    import OpenImageIO as oiio
    picture = oiio.ImageInput.open(path)
    part = next(k for k in range(64) if picture.seek_subimage(k, 0) and picture.spec(k).get_string_attribute("oiio:subimagename") in ("valid", ""))
    spec = picture.spec(part)
    return np.asarray(picture.read_image(part, 0, 0, 1, "uint")).reshape(spec.height, spec.width) == 1


def run(command):
    """Standard output; ends the script where the program fails."""
    done = subprocess.run(command, check=False, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        sys.exit(f"claims: exit code {done.returncode}: {' '.join(command)}")
    return done.stdout


def bake(setting, scene, group, name, options):
    """The bake of a scene under work/group/NAME, made if it is not there; bakes of one group share what they can."""
    path = os.path.join(setting.work, group, name, "scene.glb")
    if not os.path.exists(path + ".report.json"):
        os.makedirs(os.path.dirname(path), exist_ok=True)
        run([setting.luxel, "bake", scene, "-o", path, "-q", "--aov", "valid", "--work", os.path.join(setting.work, group, "work"),
             "--report", path + ".report.part", *options])
        os.replace(path + ".report.part", path + ".report.json")
    return Bake(path)


def sample(name):
    return os.path.join(ROOT, "samples", name, name + ".gltf")


def difference(found, right):
    """Sum of differences over sum of what is right: texels are of one size, so means over the surface."""
    return float(np.abs(found - right).sum() / right.sum())


def table(head, rows):
    print("| " + " | ".join(head) + " |")
    print("|" + " --- |" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |", flush=True)
    print()


def percent(value):
    return f"{100 * value:.0f} %" if value >= 0.995 else f"{100 * value:.2g} %" if value >= 1e-3 else f"{100 * value:.1g} %"


def light_along(path, start, end, count, level=1e-6):
    """Luminance of irradiance at points of a level floor (its front up), as a viewer reads the lightmap. level: how far its height may be off, m."""
    scene = gltf_scene.Scene(path)
    maps = lightmap.Lightmaps(scene, path)
    points = np.linspace(start, end, count)
    floor = [t for t in range(len(scene.corners)) if maps.page[t] >= 0 and scene.flat[t][1] > 0.999 and np.abs(scene.corners[t][:, 1] - start[1]).max() < level]
    triangles, weights = np.full(count, -1), np.zeros((count, 3))
    for t in floor:
        a, b, c = scene.corners[t][:, [0, 2]]
        inverse = np.linalg.inv(np.stack([b - a, c - a], 1))
        uv = (points[:, [0, 2]] - a) @ inverse.T
        bary = np.stack([1 - uv.sum(1), uv[:, 0], uv[:, 1]], 1)
        inside = (bary.min(1) > -1e-6) & (triangles < 0)
        triangles[inside], weights[inside] = t, bary[inside]
    if (triangles < 0).any():
        sys.exit(f"claims: {path}: the line leaves the floor")
    return maps.sample(triangles, weights) @ LUMINANCE


class Chart:
    """Lines over two axes as SVG; `log`: of x and y. Limits are given, so that a picture can be compared with an older one. Names of the
    lines stand in the top right corner, or where `names` says: the left end of the first one, and how far up it is."""

    WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 430, 300, 62, 24, 34, 46

    def __init__(self, title, x_label, y_label, x_limits, y_limits, log=(False, False), names=None):
        self.labels, self.limits, self.log, self.names, self.parts = (title, x_label, y_label), (x_limits, y_limits), log, names, []

    def place(self, axis, value):
        low, high = self.limits[axis]
        value = min(max(value, low), high)
        share = math.log(value / low) / math.log(high / low) if self.log[axis] else (value - low) / (high - low)
        if axis == 0:
            return self.LEFT + share * (self.WIDTH - self.LEFT - self.RIGHT)
        return self.HEIGHT - self.BOTTOM - share * (self.HEIGHT - self.TOP - self.BOTTOM)

    def line(self, points, colour, name=None, row=0, dash="", dots=False):
        shown = " ".join(f"{self.place(0, x):.1f},{self.place(1, y):.1f}" for x, y in points)
        style = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(f'<polyline points="{shown}" fill="none" stroke="{colour}" stroke-width="1.6"{style}/>')
        if dots:
            self.parts += [f'<circle cx="{self.place(0, x):.1f}" cy="{self.place(1, y):.1f}" r="2.2" fill="{colour}"/>' for x, y in points]
        if name:
            x, y = (self.WIDTH - self.RIGHT - 8, self.TOP) if self.names is None else (self.LEFT + self.names[0], self.HEIGHT - self.BOTTOM - self.names[1])
            anchor = "end" if self.names is None else "start"
            self.parts.append(f'<text x="{x}" y="{y + 14 + 14 * row}" text-anchor="{anchor}" fill="{colour}">{name}</text>')

    def ticks(self, axis, values, text):
        for value in values:
            at = self.place(axis, value)
            if axis == 0:
                self.parts.insert(0, f'<line x1="{at:.1f}" x2="{at:.1f}" y1="{self.TOP}" y2="{self.HEIGHT - self.BOTTOM}" stroke="#ddd"/>')
                self.parts.append(f'<text x="{at:.1f}" y="{self.HEIGHT - self.BOTTOM + 15}" text-anchor="middle">{text(value)}</text>')
            else:
                self.parts.insert(0, f'<line x1="{self.LEFT}" x2="{self.WIDTH - self.RIGHT}" y1="{at:.1f}" y2="{at:.1f}" stroke="#ddd"/>')
                self.parts.append(f'<text x="{self.LEFT - 6}" y="{at + 4:.1f}" text-anchor="end">{text(value)}</text>')

    def svg(self, left, top):
        title, x_label, y_label = self.labels
        middle = (self.HEIGHT - self.BOTTOM + self.TOP) / 2
        return "\n".join([f'<g transform="translate({left} {top})">',
                          f'<text x="{self.WIDTH / 2}" y="20" text-anchor="middle" font-size="14">{title}</text>', *self.parts,
                          f'<text x="{(self.WIDTH + self.LEFT) / 2}" y="{self.HEIGHT - 12}" text-anchor="middle">{x_label}</text>',
                          f'<text x="14" y="{middle}" text-anchor="middle" transform="rotate(-90 14 {middle})">{y_label}</text>', "</g>"])


def save_charts(path, charts, columns=2):
    rows = -(-len(charts) // columns)
    width, height = Chart.WIDTH * min(columns, len(charts)), Chart.HEIGHT * rows
    parts = [c.svg(Chart.WIDTH * (k % columns), Chart.HEIGHT * (k // columns)) for k, c in enumerate(charts)]
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        file.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" font-size="11">\n'
                   f'<rect width="100%" height="100%" fill="white"/>\n' + "\n".join(parts) + "\n</svg>\n")
