#!/usr/bin/env python3
"""The sum of the lecture for real bakes: n patches have n^2 form factors; what of them is kept, in how many bytes, and how long that takes.

usage: headline.py LUXEL SCENE[:BAKE_OPTION...] ... [--memory 1G] [--rays 256]

Bakes each scene to its patches (draft: no texel is gathered) in an empty folder and prints one column per scene, as Markdown.
An entry is a scene and the options that set its patches, separated by colons:
    headline.py build/release/tools/luxel/luxel samples/corridor_16/corridor_16.gltf:--texels-per-metre=16
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile


def bake(luxel, entry, memory, rays):
    scene, *options = entry.split(":")
    with tempfile.TemporaryDirectory(prefix="luxel-headline-") as place:
        report = os.path.join(place, "report.json")
        command = [luxel, "bake", scene, "-o", os.path.join(place, "out.glb"), "--work", os.path.join(place, "work"), "--report", report,
                   "--quality", "draft", "--rays", str(rays), "--memory", memory, "-q", *options]
        if subprocess.run(command, check=False).returncode:
            sys.exit("headline: failed: " + " ".join(command))
        with open(report, encoding="utf-8") as file:
            return os.path.splitext(os.path.basename(scene))[0], json.load(file)


def bytes_text(value):
    for unit, size in (("TB", 1e12), ("GB", 1e9), ("MB", 1e6)):
        if value >= size:
            return f"{value / size:,.3g} {unit}"
    return f"{value:,.0f} B"


def column(name, report):
    counts, store = report["counts"], report["store"]
    patches, pairs, size = counts["patches"], counts["pairs"], store["bytes"]
    seconds = {}
    for stage in report["stages"]:
        seconds[stage["name"]] = seconds.get(stage["name"], 0) + stage["seconds"]
    half = patches * patches * 4 // 2
    return [name, f"{patches:,}", f"{patches ** 2:.3g}", bytes_text(half), bytes_text(half / 4), f"{pairs:,}",
            f"{100 * pairs / (patches * patches / 2):.2f} %", bytes_text(size), f"{store['bytes_per_pair']:.2f}", f"{half / size:,.0f}",
            f"{report['evidence']['rays']:,}", f"{seconds.get('evidence', 0):.1f} s", f"{seconds.get('pooling', 0):.1f} s",
            f"{seconds.get('closure', 0):.1f} s", f"{seconds.get('solve', 0):.1f} s", f"{sum(seconds.values()):.0f} s",
            bytes_text(report["memory"]["peak_bytes"] - report["memory"]["geometry_bytes"]), bytes_text(report["memory"]["geometry_bytes"])]


ROWS = ["", "patches n", "form factors n^2", "half of them, 4 bytes each (lecture: reciprocity)", "a quarter of that (lecture: 'possibly', bit index)",
        "pairs stored", "of n^2 / 2", "bytes on disk, index and counts", "bytes per pair", "times smaller than the half matrix", "rays",
        "evidence, all rounds", "pooling", "closure", "solve, 1e-2 and final tolerance", "whole bake to patches",
        "peak memory beside geometry", "geometry, texels and patches"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("luxel")
    parser.add_argument("scenes", nargs="+", metavar="SCENE[:OPTION...]")
    parser.add_argument("--memory", default="1G")
    parser.add_argument("--rays", type=int, default=256)
    options = parser.parse_args()
    columns = [column(*bake(options.luxel, entry, options.memory, options.rays)) for entry in options.scenes]
    for k, label in enumerate(ROWS):
        print("| " + " | ".join([label] + [c[k] for c in columns]) + " |")
        if k == 0:
            print("|" + " --- |" * (len(columns) + 1))


if __name__ == "__main__":
    main()
