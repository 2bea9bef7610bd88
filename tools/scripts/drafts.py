#!/usr/bin/env python3
"""Remakes the pictures of docs/drafts.md, and prints its table: patches spread over texels in every way, beside gathered light.

usage: build/deps/reference/bin/python tools/scripts/drafts.py [--luxel LUXEL] [--out docs/drafts] [--work DIR] [SAMPLE ...]

Each sample (default: cornell_box, two_rooms, corridor_4) is solved twice, with the rays of a draft (128 per patch) and of --quality
high (1024), and its patches spread in each way; `gathered` is --quality high. The error of a texel is |draft - gathered| / max(gathered, 1 % of the
mean), in luminance, over the texels that hold light of their own.
--work DIR: bakes and bake folders are kept there, and used again.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "tests", "reference"))
import camera as cameras   # noqa: E402
import panels       # noqa: E402
import lightmap     # noqa: E402
import reference    # noqa: E402
import render       # noqa: E402

# Options: density, for patches a hand wide, smaller ones in the small box; camera (place, target, m; None: one that is looked for).
SAMPLES = {"cornell_box": (["--texels-per-metre", "120"], ((0.42, 0.38, -0.16), (0.23, 0.13, 0.25))),
           "two_rooms": (["--texels-per-metre", "16"], None), "corridor_4": (["--texels-per-metre", "16"], None)}
METHODS = ["constant", "linear", "corners", "cubic-bspline", "catmull-rom"]
GATHERED = "gathered"
PANEL = (300, 200)


def bake(luxel, sample, folder, name, *options):
    """Irradiance (N, 3) of a bake's texels that hold light of their own, and its path."""
    out = os.path.join(folder, name, sample + ".glb")
    if not os.path.exists(out):
        subprocess.run([luxel, "bake", os.path.join(ROOT, "samples", sample, sample + ".gltf"), "-o", out, "-q", "--aov", "valid",
                        *SAMPLES[sample][0], *options], check=True)
    with open(out + ".lightmaps.json", encoding="utf-8") as file:
        pages = json.load(file)["pages"]
    light = [lightmap.read_exr(os.path.join(folder, name, page["exr"]["uri"])) for page in pages]
    valid = [read_valid(os.path.join(folder, name, page["layers"]["uri"])) for page in pages]
    return np.concatenate([p[v] for p, v in zip(light, valid)]), out


def read_valid(path):
    """Where a page's texels hold light of their own."""
    import OpenImageIO as oiio
    picture = oiio.ImageInput.open(path)
    part = next(k for k in range(64) if picture.seek_subimage(k, 0) and picture.spec(k).get_string_attribute("oiio:subimagename") in ("valid", ""))
    spec = picture.spec(part)
    return np.asarray(picture.read_image(part, 0, 0, 1, "uint")).reshape(spec.height, spec.width) == 1


def errors(draft, gathered):
    return reference.figures(draft, gathered, np.zeros_like(gathered))


def picture(paths, camera, target):
    """All bakes from one camera with one exposure, the lightmap alone."""
    views = {name: render.View(path) for name, path in paths.items()}
    gathered = views[GATHERED]
    camera = cameras.Camera(*camera, 60.0) if camera else cameras.search(gathered.scene, gathered.look, 0)
    exposure = render.automatic_exposure(*gathered.shade(camera.position, camera.directions(*PANEL, 1), True))
    panels.save(panels.sheet(views, camera, exposure, PANEL, 3), target, 80000)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("samples", nargs="*", metavar="SAMPLE", help=", ".join(SAMPLES))
    parser.add_argument("--luxel", default=os.path.join(ROOT, "build", "dev", "tools", "luxel", "luxel"))
    parser.add_argument("--out", default=os.path.join(ROOT, "docs", "drafts"), metavar="DIR")
    parser.add_argument("--work", metavar="DIR")
    options = parser.parse_args()
    unknown = [sample for sample in options.samples if sample not in SAMPLES]
    if unknown:
        parser.error(f"no sample {', '.join(unknown)}; known are {', '.join(SAMPLES)}")
    os.makedirs(options.out, exist_ok=True)
    print("| sample | spread | draft: median | p95 | relRMSE | solved well: median | p95 | relRMSE |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as temporary:
        for sample in options.samples or SAMPLES:
            folder = os.path.join(os.path.abspath(options.work or temporary), sample)
            gathered, path = bake(options.luxel, sample, folder, GATHERED, "--quality", "high", "--work", os.path.join(folder, "high"))
            paths = {}
            for method in METHODS:
                spread = ["--gather-rays", "0", "--interpolation", method]
                draft, paths[method] = bake(options.luxel, sample, folder, method, "--quality", "draft", *spread, "--work", os.path.join(folder, "draft"))
                well, _ = bake(options.luxel, sample, folder, method + "-well", "--quality", "high", *spread, "--work", os.path.join(folder, "high"))
                figures = [errors(light, gathered) for light in (draft, well)]
                print(f"| {sample} | {method} | " + " | ".join(f"{f[k]:.1%}" for f in figures for k in ("median", "p95", "relRMSE")) + " |", flush=True)
            paths[GATHERED] = path
            picture(paths, SAMPLES[sample][1], os.path.join(options.out, sample + ".jpg"))


if __name__ == "__main__":
    main()
