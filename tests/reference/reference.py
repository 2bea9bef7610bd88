#!/usr/bin/env python3
"""Compares baked lightmaps with path traced irradiance at randomly chosen texels.

usage: reference.py SCENE BAKED.glb [--points 1000] [--spp 4096] [--out PREFIX] [--png-errormap FILE.png]

Texels are drawn in proportion to the area they cover. The truth of a texel is the mean over the part of its square that
the surface covers, without points that lie inside solids (most of their view is backs of surfaces, and no light comes there). Geometry, materials
and lamps come from SCENE, or from BAKED where SCENE is compressed; then `geometry` in the result says "baked".
Prints JSON (and writes PREFIX.json, PREFIX.npz):
  median, p95    of |b - t| / max(t, 1 % of the mean truth), luminance
  relRMSE        root mean square of b - t over points and channels, relative to the mean truth
  relRMSE_net    the same without the share that is the reference's own noise
  bias, bias_se  mean b / mean t - 1, and its standard error from the reference
  noise          root mean square standard error of the truth, relative to the mean truth
  noise_median, noise_p95   what median and p95 would be if the bake were right and only the truth were noisy
  points, buried, area_ratio   compared texels; texels left out as inside solids; area of BAKED over area of SCENE
"""
import argparse
import json
import os
import subprocess
import sys
import time

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
import gltf_scene   # noqa: E402
import lightmap     # noqa: E402
import lights       # noqa: E402

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
PLACES = 256         # points of a texel: its part in a sharp shadow is then right to about 1 %
BURIED_SHARE = 0.5   # a point may be inside a solid when more of its view is backs
BURIED_PATHS = 64    # and is when none of so many paths brings light


def load_truth_scene(path, baked_path, light):
    sizes = {"lamp_radius": light.lamp_radius, "sun_angle": light.sun_angle}
    try:
        return gltf_scene.Scene(path, **sizes), "source"
    except ValueError:
        return gltf_scene.Scene(baked_path, **sizes), "baked"


def keep_open_points(tracer, footprints, seed):
    """Drops points inside solids; refills each texel's places from those that are left. Returns kept ones, number dropped."""
    points, flat = (np.concatenate([getattr(f, key) for f in footprints]) for key in ("points", "flat"))
    buried = tracer.buried(points, flat, seed) > BURIED_SHARE
    if buried.any():   # behind the back of a lamp, in a gap: dark, but not inside
        light = tracer.irradiance(points[buried, None], flat[buried, None], flat[buried, None], BURIED_PATHS, seed)[0]
        buried[buried] = light.max(1) <= 0
    kept = []
    for f, inside in zip(footprints, buried.reshape(len(footprints), -1)):
        good = np.nonzero(~inside)[0]
        if len(good) == 0:
            continue
        again = good[np.arange(PLACES) % len(good)]
        f.points, f.flat, f.normals = f.points[again], f.flat[again], f.normals[again]
        kept.append(f)
    return kept, len(footprints) - len(kept)


def figures(baked, truth, error):
    """The numbers of the head of this file; arrays (N, 3)."""
    mean = truth.mean()
    if mean <= 0:
        return {"mean_truth": 0.0, "mean_baked": float(baked.mean()), "points": len(truth)}
    b, t = baked @ LUMINANCE, truth @ LUMINANCE
    scale = np.maximum(t, 0.01 * t.mean())
    relative = np.abs(b - t) / scale
    own_relative = np.abs(np.random.default_rng(0).normal(size=len(t))) * (error @ LUMINANCE) / scale
    square, own = ((baked - truth) ** 2).mean(), (error ** 2).mean()
    return {"median": float(np.median(relative)), "p95": float(np.quantile(relative, 0.95)),
            "noise_median": float(np.median(own_relative)), "noise_p95": float(np.quantile(own_relative, 0.95)),
            "relRMSE": float(np.sqrt(square) / mean), "relRMSE_net": float(np.sqrt(max(square - own, 0)) / mean),
            "bias": float(baked.mean() / mean - 1), "bias_se": float(np.sqrt((error.mean(1) ** 2).sum()) / len(truth) / mean),
            "noise": float(np.sqrt(own) / mean), "mean_truth": float(mean), "mean_baked": float(baked.mean()),
            "points": len(truth)}


def path_tracer():
    """The module whose Tracer this machine can run: pathtrace, or stock where Mitsuba's llvm variant does not work. Tried in
    a process of its own, because an LLVM that is too old ends the process."""
    code = "import pathtrace as p; r = p.mi.PCG32(size=4); assert p.dr.all(r.next_float32() < 1)"
    tried = subprocess.run([sys.executable, "-B", "-c", code], cwd=HERE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    if tried.returncode == 0:
        import pathtrace
        return pathtrace
    print("reference: llvm_ad_rgb does not work here (Debian: libllvm19); scalar_rgb is used, which is slow", file=sys.stderr)
    import stock
    return stock


class Truth:
    """Random valid texels of a bake, and the path traced irradiance there. Holds for every bake with the same charts."""

    def __init__(self, scene_path, baked_path, points=1000, spp=4096, seed=0, normals="shading", light=lights.Light(),
                 blend_colours=False, module=None):
        maps = lightmap.Lightmaps(gltf_scene.Scene(baked_path), baked_path)
        module = module or path_tracer()
        self.scene, self.origin = load_truth_scene(scene_path, baked_path, light)
        self.name, self.spp, self.tracer_name = os.path.basename(scene_path), spp, module.__name__
        tracer = module.Tracer(self.scene, light.emitter(), blend_colours)
        chosen, self.buried = keep_open_points(tracer, lightmap.choose_texels(maps, points, PLACES, seed), seed)
        flat = np.array([f.flat for f in chosen])
        facing = np.array([f.normals for f in chosen]) if normals == "shading" else flat
        self.value, self.error = tracer.irradiance(np.array([f.points for f in chosen]), flat, facing, spp, seed)
        self.page, self.x, self.y = (np.array([getattr(f, key) for f in chosen]) for key in ("page", "x", "y"))
        self.position, self.uv, self.pages = np.array([f.points.mean(0) for f in chosen]), maps.uv, maps.page

    def against(self, baked_path):
        """The figures of a bake, the arrays they come from, its lightmaps."""
        scene = gltf_scene.Scene(baked_path)
        maps = lightmap.Lightmaps(scene, baked_path)
        if not (np.array_equal(maps.page, self.pages) and np.array_equal(maps.uv, self.uv)):
            raise ValueError(f"{baked_path}: other charts than those the truth was made for")
        baked = np.array([maps.value(*at) for at in zip(self.page, self.x, self.y)])
        result = {"scene": self.name, "baked": os.path.basename(baked_path), "geometry": self.origin, "tracer": self.tracer_name,
                  "spp": self.spp, **figures(baked, self.value, self.error), "buried": self.buried,
                  "area_ratio": float(scene.areas.sum() / self.scene.areas.sum()), "pages": maps.sources,
                  "bad_values": int(sum((~np.isfinite(p)).sum() for p in maps.pages))}
        arrays = {"baked": baked, "truth": self.value, "error": self.error, "page": self.page, "x": self.x, "y": self.y,
                  "position": self.position}
        return result, arrays, maps


def compare(scene_path, baked_path, *arguments, **options):
    """Returns the figures, and the arrays they come from; arguments as Truth has them."""
    return Truth(scene_path, baked_path, *arguments, **options).against(baked_path)


def error_map(path, maps, arrays, width=480):
    """The pages in grey, each compared texel a dot: blue too dark, white right, red too bright; full colour at 20 %."""
    from PIL import Image, ImageDraw
    b, t = arrays["baked"] @ LUMINANCE, arrays["truth"] @ LUMINANCE
    relative = (b - t) / np.maximum(t, 0.01 * max(t.mean(), 1e-300))
    columns = int(np.ceil(np.sqrt(len(maps.pages))))
    side = width // columns
    lines = -(-len(maps.pages) // columns)
    sheet = Image.new("RGB", (side * columns, side * lines), (0, 0, 0))
    scale = np.quantile(np.concatenate([p @ LUMINANCE for p in map(lambda p: p.reshape(-1, 3), maps.pages)]), 0.98) or 1.0
    for page, values in enumerate(maps.pages):
        grey = (np.clip(values @ LUMINANCE / scale, 0, 1) ** 0.4545 * 140).astype(np.uint8)
        left, top = page % columns * side, page // columns * side
        sheet.paste(Image.fromarray(grey).resize((side, side)).convert("RGB"), (left, top))
        draw = ImageDraw.Draw(sheet)
        zoom = np.array([side / values.shape[1], side / values.shape[0]])
        radius = 2
        for k in np.nonzero(arrays["page"] == page)[0]:
            share = float(np.clip(relative[k] / 0.2, -1, 1))
            colour = (255, int(255 * (1 - share)), int(255 * (1 - share))) if share > 0 else \
                (int(255 * (1 + share)), int(255 * (1 + share)), 255)
            x, y = left + (arrays["x"][k] + 0.5) * zoom[0], top + (arrays["y"][k] + 0.5) * zoom[1]
            draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=colour)
    sheet.quantize(64).save(path, optimize=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene"), parser.add_argument("baked")
    parser.add_argument("--points", type=int, default=1000)
    parser.add_argument("--spp", type=int, default=4096, help="paths per texel")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", metavar="PREFIX", help="write PREFIX.json and PREFIX.npz")
    parser.add_argument("--png-errormap", metavar="FILE")
    parser.add_argument("--normals", choices=["shading", "geometric"], default="shading", help="at the compared points")
    parser.add_argument("--blend-colour", choices=["on", "off"], default="off", help="as luxel bake had it")
    lights.add_options(parser)
    options = parser.parse_args()
    begin = time.time()
    result, arrays, maps = compare(options.scene, options.baked, options.points, options.spp, options.seed,
                                   options.normals, lights.from_options(options), options.blend_colour == "on")
    result["seconds"] = round(time.time() - begin, 1)
    text = json.dumps(result, indent=1)
    print(text)
    if options.out:
        with open(options.out + ".json", "w", encoding="utf-8") as file:
            file.write(text + "\n")
        np.savez_compressed(options.out + ".npz", **arrays)
    if options.png_errormap:
        error_map(options.png_errormap, maps, arrays)


if __name__ == "__main__":
    main()
