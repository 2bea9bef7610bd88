#!/usr/bin/env python3
"""What luxel plan foresees, beside what the bake then takes: pairs, bytes on disk, memory and seconds, at draft and medium.

usage: forecast_test.py LUXEL [--scenes DIR] [--only NAME ...] [--density N]

--scenes DIR  where staircase/, hotel-room/, zdm2/ and lq-e1m1/ lie (default: ../shared/scenes beside the project); missing ones are left out
Prints a table of foreseen / true. Fails unless four fifths of all rows are within a factor of 1.5 in pairs, bytes and memory. Seconds are
printed with their share and never asserted: other programs may be running.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SAMPLES = ["cornell_box", "corridor_4", "corridor_16", "fence", "glass_room", "lamps_over_floor", "open_court", "painted_room", "sphere", "sun_room", "two_rooms"]
FOREIGN = {"staircase": "staircase/staircase.glb", "hotel-room": "hotel-room/hotel-room.glb", "zdm2": "zdm2/zdm2.glb", "lq-e1m1": "lq-e1m1/lq_e1m1.glb"}
FACTOR, SHARE = 1.5, 0.8
HEAD = ("| scene | quality | patches | pairs | pairs | bytes on disk | memory | seconds |\n"
        "|---|---|---|---|---|---|---|---|")


def run(luxel, *arguments):
    subprocess.run([luxel, *arguments, "-q"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def compare(luxel, name, scene, options, folder):
    """Rows of one scene: {what: foreseen / true} for each quality, printed."""
    report = os.path.join(folder, "report.json")
    run(luxel, "plan", scene, "--report", report, *options)
    plan = read(report)
    rows = []
    for foreseen in plan["forecasts"]:
        if foreseen["quality"] not in ("draft", "medium"):
            continue
        run(luxel, "bake", scene, "-o", os.path.join(folder, "out.glb"), "--quality", foreseen["quality"], "--report", report, *options)
        bake = read(report)
        true = {"pairs": bake["counts"]["pairs"], "matrix_bytes": bake["store"]["bytes"], "peak_bytes": bake["memory"]["peak_bytes"],
                "seconds": sum(stage["seconds"] for stage in bake["stages"])}
        ratio = {key: foreseen[key] / true[key] if true[key] else 1.0 for key in true}
        print(f"| {name} | {foreseen['quality']} | {plan['counts']['patches']} | {true['pairs']} | " + " | ".join(f"{ratio[k]:.2f}" for k in true) + " |", flush=True)
        rows.append(ratio)
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("luxel")
    parser.add_argument("--scenes", default=os.path.join(ROOT, "../shared/scenes"), metavar="DIR")
    parser.add_argument("--only", nargs="+", metavar="NAME")
    parser.add_argument("--density", metavar="N", help="texels per metre (default: as luxel chooses)")
    options = parser.parse_args()
    scenes = {name: os.path.join(ROOT, "samples", name, name + ".gltf") for name in SAMPLES}
    scenes |= {name: os.path.join(options.scenes, path) for name, path in FOREIGN.items()}
    rows = []
    print(HEAD, flush=True)
    with tempfile.TemporaryDirectory(prefix="luxel-forecast-") as folder:
        for name, scene in scenes.items():
            if options.only and name not in options.only:
                continue
            if not os.path.exists(scene):
                print(f"forecast_test: {name} is left out: {scene} is not there (see --scenes)", flush=True)
                continue
            rows += compare(options.luxel, name, scene, ["--texels-per-metre", options.density] if options.density else [], folder)
    good = True
    for key in rows[0]:
        near = sum(1 / FACTOR <= row[key] <= FACTOR for row in rows) / len(rows)
        print(f"{key}: {near:.0%} of {len(rows)} within a factor of {FACTOR}")
        good &= near >= SHARE or key == "seconds"
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
