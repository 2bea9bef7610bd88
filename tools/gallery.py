#!/usr/bin/env python3
"""Remakes docs/gallery.md: bakes real scenes, compares them with Mitsuba, draws pictures.

usage: tools/gallery.py [--scenes DIR] [--only NAME ...] [--quality Q] [--points N] [--spp N] [--work DIR]

--scenes DIR  where staircase/, lq-e1m1/, hotel-room/ and zdm2/ lie (default: ../shared/scenes beside the project);
              missing scenes are named and left out
--work DIR    bakes and reports (default: build/gallery)
Set-up, build and the Python environment with Mitsuba are made by the scripts beside this one. With LUXEL_REFERENCE_PYTHON
set, that interpreter is used instead.
"""
import argparse
import json
import os
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SCENES = [  # name, file, what it is; {scenes} is --scenes
    ("staircase", "{scenes}/staircase/staircase.glb", "775 meshes, one emissive window"),
    ("lq-e1m1", "{scenes}/lq-e1m1/lq_e1m1.glb", "a game level: 259 lamps, emissive textures"),
    ("hotel-room", "{scenes}/hotel-room/hotel-room.glb", "one mesh, three lamps, meshopt compression"),
    ("zdm2", "{scenes}/zdm2/zdm2.glb", "a level without normals or textures"),
    ("corridor_16", "samples/corridor_16/corridor_16.gltf", "16 furnished rooms, doors, a lamp in two of three"),
]
SIZE = "480x320"
NOISE = 0.35         # of the 95th percentile: more paths are traced while the truth's noise alone would give more,
MOST_SPP = 65536     # up to so many


def reference_python():
    given = os.environ.get("LUXEL_REFERENCE_PYTHON")
    if given:
        return given
    subprocess.run([os.path.join(ROOT, "tools/setup.sh"), "reference"], check=True)
    return os.path.join(ROOT, "build/deps/reference/bin/python")


def run(*command):
    print("+", " ".join(command), file=sys.stderr, flush=True)
    return subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout


def shrink(python, source, target):
    """A picture of at most 60 kB, whatever is in it."""
    code = ("import os, sys; from PIL import Image; p = Image.open(sys.argv[1]).convert('RGB')\n"
            "for q in range(88, 20, -6):\n"
            "    p.save(sys.argv[2], quality=q, optimize=True)\n"
            "    if os.path.getsize(sys.argv[2]) <= 60000: break\n")
    run(python, "-c", code, source, target)


def compare(python, path, baked, output, options):
    """Figures against path tracing with as many paths as it takes to see the bake's error and not the tracer's."""
    spp = options.spp
    while True:
        figures = json.loads(run(python, "-B", os.path.join(ROOT, "tests/reference/reference.py"), path, baked, "--points", str(options.points),
                                 "--spp", str(spp), "--out", output))
        if figures["noise_p95"] <= NOISE * figures["p95"] or spp * 4 > MOST_SPP:
            return figures
        spp *= 4


def one(python, name, path, options):
    """Bakes, compares and draws one scene; returns its row of the table."""
    work = os.path.join(options.work, name)
    os.makedirs(work, exist_ok=True)
    pictures = os.path.join(ROOT, "docs/gallery")
    os.makedirs(pictures, exist_ok=True)
    baked, report, reference = (os.path.join(work, name + end) for end in (".glb", ".report.json", ".reference"))
    run(os.path.join(ROOT, "tools/run.sh"), "bake", path, "-o", baked, "--quality", options.quality, "--report", report)
    scripts = os.path.join(ROOT, "tests/reference")
    figures = compare(python, path, baked, reference, options)
    raw, wrong = os.path.join(work, "picture.png"), os.path.join(work, "error.png")
    view = run(python, "-B", f"{scripts}/render.py", baked, raw, "--size", SIZE).strip()
    chosen = view.removeprefix("camera: ").split() if view else []
    run(python, "-B", f"{scripts}/render.py", baked, wrong, "--size", SIZE, "--error", str(options.spp // 16), *chosen)
    shrink(python, raw, os.path.join(pictures, name + ".jpg"))
    shrink(python, wrong, os.path.join(pictures, name + "_error.jpg"))
    with open(report, encoding="utf-8") as file:
        bake = json.load(file)
    seconds = sum(stage["seconds"] for stage in bake["stages"])
    return {"name": name, "figures": figures, "seconds": seconds, "peak": bake["memory"]["peak_bytes"], "counts": bake["counts"]}


def page(rows, options):
    lines = ["# Gallery", "",
             "Made by `tools/gallery.py`; do not edit. Each scene baked with "
             f"`--quality {options.quality}` and all other options at their defaults, then compared with path tracing "
             f"(Mitsuba 3) at {options.points} random texels: |baked - traced| / traced, area-weighted. "
             "`noise` is what the tracing's own error would make of median and p95 if the bake were exact; while it is large, more paths are traced "
             f"({options.spp} to {MOST_SPP} per texel). In the error pictures blue is too dark, red too bright, full colour is 20 %; "
             "they are noisier than the figures.", "",
             "| scene | picture | error | median | p95 | bias | noise | seconds | peak memory |", "|---|---|---|---|---|---|---|---|---|"]
    for row in rows:
        f, name = row["figures"], row["name"]
        what = next(text for n, _, text in SCENES if n == name)
        lines.append(f"| **{name}**<br>{what}<br>{row['counts']['triangles']:,} triangles, {row['counts']['texels']:,} texels "
                     f"| ![{name}](gallery/{name}.jpg) | ![error of {name}](gallery/{name}_error.jpg) "
                     f"| {f['median']:.1%} | {f['p95']:.1%} | {f['bias']:+.1%} | {f['noise_median']:.1%}, {f['noise_p95']:.1%} of {f['spp']} paths "
                     f"| {row['seconds']:.0f} | {row['peak'] / 2**20:,.0f} MB |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", default=os.path.join(ROOT, "../shared/scenes"), metavar="DIR")
    parser.add_argument("--only", nargs="+", choices=[s[0] for s in SCENES], metavar="NAME", help="the table then has only these")
    parser.add_argument("--quality", default="medium", choices=["draft", "medium", "high"])
    parser.add_argument("--points", type=int, default=1000)
    parser.add_argument("--spp", type=int, default=16384)
    parser.add_argument("--work", default=os.path.join(ROOT, "build/gallery"), metavar="DIR")
    options = parser.parse_args()
    options.work = os.path.abspath(options.work)
    python = reference_python()
    rows, failed = [], []
    for name, pattern, _ in SCENES:
        path = os.path.normpath(os.path.join(ROOT, pattern.format(scenes=os.path.abspath(options.scenes))))
        if options.only and name not in options.only:
            continue
        if not os.path.exists(path):
            print(f"gallery: {name} is left out: {path} is not there (see --scenes)", file=sys.stderr)
            continue
        try:
            rows.append(one(python, name, path, options))
        except subprocess.CalledProcessError as error:
            print(f"gallery: {name} is left out: {os.path.basename(error.cmd[0])} ended with {error.returncode}", file=sys.stderr)
            failed.append(name)
    if not rows:
        sys.exit("gallery: nothing was baked, docs/gallery.md is unchanged")
    with open(os.path.join(ROOT, "docs/gallery.md"), "w", encoding="utf-8") as file:
        file.write(page(rows, options))
    print(f"gallery: docs/gallery.md with {len(rows)} scenes" + (f"; failed: {', '.join(failed)}" if failed else ""))
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
