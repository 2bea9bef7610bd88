#!/usr/bin/env python3
"""Seconds to a given error, luxel beside Blender's Cycles, on the three scenes of the harness that has measured Cycles.

usage: tools/scripts/cycles_table.py LUXEL [--harness DIR] [--only SCENE ...] [--repeat 3] [--longest 60] [--work DIR]

--harness DIR  make_scenes.py, truth.py and cycles_results.md (default: ../shared/harness beside the project); its own path traced
               truth judges both bakers. Each brings its own charts: luxel unwraps, which counts in its seconds, at the density that
               gives the surface as many texels as Cycles had
--work DIR     scenes, truths and bakes; what is there is used again, but luxel is always run (default: build/cycles_table)
--longest S    no finer setting after one that has taken S seconds

Seconds of luxel are the whole process on all cores, the least of --repeat runs, and its processor seconds / 2, which a busy machine
hardly changes; those of Cycles are processor seconds / 2 and denoising, without the start of Blender, as cycles_results.md derives
them. The error is the RMS over the mean truth, the truth's own
noise subtracted. Between settings seconds are interpolated by logarithms, along those that no other setting beats.
Needs the Python environment of `tools/setup.sh reference`, or LUXEL_REFERENCE_PYTHON, an interpreter that has its packages.
"""
import argparse
import json
import math
import os
import re
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "tests/reference"))
from interpreter import use_reference_python   # noqa: E402

LEVELS = (0.20, 0.10, 0.05, 0.02, 0.01)
UNLIT = [4.05, -1, -1, 9, 4, 6]   # the room without the lamp
# scene file, side of a page, covered texels of Cycles, what is judged: title, name in cycles_results.md, points, spp, box, goals by level in seconds
SCENES = {
    "cornell": (256, 39251, [("Cornell box, 256 x 256", "cornell 256", 1000, 32768, None, {0.05: 0.3, 0.02: 0.6, 0.01: 2.0})]),
    "two_room": (256, 46108, [("two rooms, 256 x 256", "two_room 256", 1000, 32768, None, {0.05: 0.5}),
                       ("two rooms, the unlit one alone", "two_room 256, room 1 only", 400, 65536, UNLIT, {0.05: 1.5})]),
    "rooms_16": (768, 354959, [("16 rooms, 768 x 768", "rooms_16 768", 1000, 16384, None, {0.05: 4.0})]),
}
LADDER = ["--quality draft --rays 32", "--quality draft", "--quality draft --gather-rays 8", "--quality draft --gather-rays 16",
          "--quality draft --gather-rays 32", "--quality draft --gather-rays 64", "--quality medium --gather-rays 64", "--quality medium",
          "--quality medium --gather-rays 256", "--quality high", "--quality high --gather-rays 2048"]


def cycles_seconds(harness):
    """(name, OIDN, metric) -> texts of LEVELS, from the table of cycles_results.md."""
    with open(os.path.join(harness, "cycles_results.md"), encoding="utf-8") as file:
        text = file.read()
    part = text[text.index("## Seconds to reach"):]
    rows = re.findall(r"^\| ([^|]+) \| (off|lightmap) \| (center|texel) \|(.+)\|$", part, re.M)
    return {(name, oidn, metric): [cell.strip() for cell in cells.split("|")] for name, oidn, metric, cells in rows}


def prepared(harness, name, texels, work):
    """The scene, and the texels per metre that give its surface so many texels."""
    import gltfio
    scene = os.path.join(work, name + ".glb")
    if not os.path.exists(scene):
        subprocess.run([sys.executable, "-B", os.path.join(harness, "make_scenes.py"), work, "--only", name], check=True,
                       stdout=subprocess.DEVNULL)
    area = sum(gltfio.face_normals(p.P, p.F)[1].sum() for p in gltfio.load(scene).prims)
    return scene, math.sqrt(texels / area)


def timed_bake(command, repeat):
    """Least wall seconds of a whole process, and its processor seconds."""
    best = (math.inf, 0.0)
    for _ in range(repeat):
        begin = time.time()
        child = subprocess.Popen(command)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode:
            sys.exit("cycles_table: failed: " + " ".join(command))
        best = min(best, (time.time() - begin, usage.ru_utime + usage.ru_stime))
    return best


def with_float_pages(output):
    """The bake with its float pages in the place of the 8-bit ones, as the harness reads pictures that a glTF names. Its path."""
    import gltfio
    document, blob = gltfio._read_container(output)
    with open(output + ".lightmaps.json", encoding="utf-8") as file:
        pages = {page["picture"]["name"]: page["exr"]["uri"] for page in json.load(file)["pages"]}
    for image in document["images"]:
        if image.get("name") in pages:
            name = image["name"]
            image.clear()
            image.update(uri=pages[name])
    for material in document["materials"]:
        material.get("extensions", {}).get("MOZ_lightmap", {})["intensity"] = 1.0
    path = output.removesuffix(".glb") + ".float.glb"
    gltfio.write_glb(path, document, blob)
    return path


def baked(options, scene, side, density, setting, output):
    """What a setting costs: a dictionary; writes the bake."""
    command = [options.luxel, "bake", scene, "-o", output, "--texels-per-metre", f"{density:.6g}", "--atlas-size", str(side),
               "-q", *setting.split()]
    wall, processor = timed_bake(command, options.repeat)
    subprocess.run([*command, "--report", output + ".json"], check=True)   # not in the timed runs: Cycles writes no report
    with open(output + ".json", encoding="utf-8") as file:
        report = json.load(file)
    stages = {}
    for stage in report["stages"]:
        stages[stage["name"]] = stages.get(stage["name"], 0) + stage["seconds"]
    return {"setting": setting, "wall": wall, "processor": processor, "stages": stages, "texels": report["counts"]["texels"],
            "pages": report["counts"]["pages"], "judged": with_float_pages(output)}


def errors(scene, judged_path, judged, cache):
    """Figures at texel centres and of texel means. Texels that lie inside a solid, all or in part, are left out: nobody sees what is there,
    and luxel writes what filters well. (Those of Cycles contain them, as right.)"""
    import gltfio
    import gltf_scene
    import numpy as np
    import pathtrace
    import truth
    from reference import BURIED_SHARE
    _, _, points, spp, box, _ = judged
    maps, tracer = truth.Lightmaps(gltfio.load(judged_path)), pathtrace.Tracer(gltf_scene.Scene(scene))
    out = {}
    for footprint in ("center", "texel"):
        chosen, _ = truth.choose_points(maps, points, footprint=footprint, box=None if box is None else np.array(box, float))
        light, error, _, _ = truth.reference_at(scene, chosen, spp, cache=cache)
        places = chosen["p"].shape[1]
        buried = tracer.buried(chosen["p"].reshape(-1, 3), chosen["ng"].reshape(-1, 3)).reshape(-1, places) > BURIED_SHARE
        open_ = ~buried.any(1)
        out[footprint] = {**truth.figures(chosen["value"][open_], light[open_], error[open_]), "buried": int(buried.any(1).sum())}
    return out


def two_digits(seconds):
    return f"{seconds:.0f}" if seconds >= 10 else f"{seconds:.2g}"


def seconds_to(runs, level):
    """Text: seconds until the error is at most `level`; runs: (seconds, error)."""
    front = []
    for seconds, error in sorted(runs):
        if not front or error < front[-1][1]:
            front.append((seconds, error))
    if front[0][1] <= level:
        return f"<= {two_digits(front[0][0])}"
    for (s0, e0), (s1, e1) in zip(front, front[1:]):
        if e1 <= level:
            return two_digits(s0 * (s1 / s0) ** (math.log(level / e0) / math.log(max(e1, 1e-9) / e0)))
    return f"> {two_digits(front[-1][0])}"


def print_runs(title, rows):
    print(f"\n### {title}: {rows[0][0]['texels']:,} texels on {rows[0][0]['pages']} page(s), "
          f"{rows[0][1]['center']['points']} judged, {rows[0][1]['center']['buried']} inside solids left out\n\n| setting | wall s | processor s / 2 | RMS centre | RMS texel mean | bias | median | p95 | truth's noise | stages over 0.02 s |\n"
          "|---|---|---|---|---|---|---|---|---|---|")
    for run, f in rows:
        c, parts = f["center"], [f"{name} {s:.2f}" for name, s in run["stages"].items() if s >= 0.02]
        print(f"| `{run['setting']}` | {run['wall']:.2f} | {run['processor'] / 2:.2f} | {c['relRMSE_net']:.2%} | {f['texel']['relRMSE_net']:.2%} | {c['bias']:+.2%} "
              f"| {c['median']:.2%} | {c['p95']:.1%} | {c['truth_relSE']:.2%} | {', '.join(parts)} |")


def print_summary(judged, rows, cycles):
    print(f"\n| {judged[0]}: seconds to an error | judged at | " + " | ".join(f"{level:.0%}" for level in LEVELS) + " |\n" + "|---" * 7 + "|")
    for footprint, words in (("center", "centre"), ("texel", "texel mean")):
        for oidn, baker in (("off", "Cycles"), ("lightmap", "Cycles, denoised")):
            cells = cycles.get((judged[1], oidn, footprint))
            if cells:
                print(f"| {baker} | {words} | " + " | ".join(cells) + " |")
        for key, share, baker in (("wall", 1, "luxel"), ("processor", 2, "luxel, processor s / 2")):
            runs = [(run[key] / share, f[footprint]["relRMSE_net"]) for run, f in rows]
            print(f"| {baker} | {words} | " + " | ".join(seconds_to(runs, level) for level in LEVELS) + " |")
    print("| goal of luxel | | " + " | ".join(f"{judged[5][v]:g}" if v in judged[5] else "" for v in LEVELS) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("luxel")
    parser.add_argument("--harness", default=os.path.join(ROOT, "../shared/harness"), metavar="DIR")
    parser.add_argument("--only", nargs="+", choices=list(SCENES), default=list(SCENES), metavar="SCENE")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--longest", type=float, default=60.0)
    parser.add_argument("--work", default=os.path.join(ROOT, "build/cycles_table"), metavar="DIR")
    options = parser.parse_args()
    harness, work = os.path.abspath(options.harness), os.path.abspath(options.work)
    missing = [f for f in ("make_scenes.py", "truth.py", "cycles_results.md") if not os.path.exists(os.path.join(harness, f))]
    if missing:
        sys.exit(f"cycles_table: the harness is not in {harness} (--harness); missing: {', '.join(missing)}")
    if "LUXEL_REFERENCE_PYTHON" not in os.environ:
        subprocess.run([os.path.join(ROOT, "tools/setup.sh"), "reference"], check=True)
    use_reference_python()
    sys.path.insert(0, harness)
    os.makedirs(work, exist_ok=True)
    cycles = cycles_seconds(harness)
    for name in options.only:
        side, texels, tables = SCENES[name]
        scene, density = prepared(harness, name, texels, work)
        runs = []
        for k, setting in enumerate(LADDER):
            runs.append(baked(options, scene, side, density, setting, os.path.join(work, f"{name}.{k}.glb")))
            if runs[-1]["wall"] > options.longest:
                break
        for judged in tables:
            rows = [(run, errors(scene, run["judged"], judged, os.path.join(work, "cache"))) for run in runs]
            print_runs(judged[0], rows)
            print_summary(judged, rows, cycles)


if __name__ == "__main__":
    main()
