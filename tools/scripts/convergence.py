#!/usr/bin/env python3
"""Draws docs/solvers/convergence.svg: true error against reads of the half matrix, one line per solver. Python 3.9 or newer, standard
library only.

usage: tools/scripts/convergence.py [--bench BUILD/tests/bench/solver_bench] [--out docs/solvers/convergence.svg] [--keep DIR]

Bakes two scenes of samples/make_samples.py --solver-scenes (four furnished rooms with one lamp, an open plan), solves each with every
solver behind a cache of 5 % of the decoded blocks, and writes the picture. --keep: keeps the bake folders there, and uses them again.
"""
import argparse
import csv
import math
import os
import subprocess
import sys
import tempfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SOLVERS = [("shoot", "#c0392b"), ("cg", "#2471a3"), ("gather", "#239b56"), ("jacobi", "#7d6608"), ("shoot-patch", "#8e44ad")]
# Title, scene, texels per metre, patches per chunk, albedo.
PANELS = [("four rooms, one lamp", "rooms_4", 16, 512, 0.8), ("four rooms, one lamp", "rooms_4", 16, 512, 0.95),
          ("open plan", "open_plan", 10, 1024, 0.8), ("open plan", "open_plan", 10, 1024, 0.95)]
WIDTH, HEIGHT, MARGIN = 430, 300, 52
READS, ERRORS = (0.05, 500.0), (1e-5, 1.0)


def courses(bench, panel, folder):
    """Per solver: [(reads, error)]."""
    _, scene, density, chunk, albedo = panel
    table = os.path.join(folder, "course.csv")
    subprocess.run([bench, os.path.join(folder, "scenes", scene, scene + ".gltf"), "--density", str(density), "--chunk-patches", str(chunk),
                    "--patch-texels", "4", "--work", os.path.join(folder, f"{scene}-{chunk}"), "--cache", "0.05", "--albedo", str(albedo),
                    "--solver", *[name for name, _ in SOLVERS], "--error", "1e-4", "--csv", table], check=True)
    lines = {name: [] for name, _ in SOLVERS}
    with open(table, encoding="utf-8", newline="") as file:
        for _, _, solver, reads, error, _ in csv.reader(file):
            lines[solver].append((float(reads), float(error)))
    return lines


def place(value, limits, size, up):
    share = (math.log(min(max(value, limits[0]), limits[1])) - math.log(limits[0])) / (math.log(limits[1]) - math.log(limits[0]))
    return MARGIN + (1 - share if up else share) * (size - 2 * MARGIN)


def panel_svg(panel, lines, left, top):
    title, _, _, _, albedo = panel
    out = [f'<g transform="translate({left} {top})">',
           f'<text x="{WIDTH / 2}" y="{MARGIN - 14}" text-anchor="middle" font-size="14">{title}, mean albedo {albedo}</text>']
    for decade in range(-5, 1):
        y = place(10.0 ** decade, ERRORS, HEIGHT, True)
        out.append(f'<line x1="{MARGIN}" x2="{WIDTH - MARGIN}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ddd"/>')
        out.append(f'<text x="{MARGIN - 6}" y="{y + 4:.1f}" text-anchor="end">1e{decade}</text>')
    for reads in (0.1, 1, 10, 100):
        x = place(reads, READS, WIDTH, False)
        out.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{MARGIN}" y2="{HEIGHT - MARGIN}" stroke="#ddd"/>')
        out.append(f'<text x="{x:.1f}" y="{HEIGHT - MARGIN + 16}" text-anchor="middle">{reads:g}</text>')
    out.append(f'<text x="{WIDTH / 2}" y="{HEIGHT - 14}" text-anchor="middle">reads of the half matrix</text>')
    for number, (name, colour) in enumerate(SOLVERS):
        points = [(reads, error) for reads, error in lines[name] if READS[0] <= reads <= READS[1] and error >= ERRORS[0]]
        shown = " ".join(f"{place(r, READS, WIDTH, False):.1f},{place(e, ERRORS, HEIGHT, True):.1f}" for r, e in points)
        out.append(f'<polyline points="{shown}" fill="none" stroke="{colour}" stroke-width="1.6"/>')
        y = HEIGHT - MARGIN - 8 - 14 * (len(SOLVERS) - 1 - number)
        out.append(f'<text x="{MARGIN + 8}" y="{y}" fill="{colour}">{name}</text>')
    return "\n".join(out + ["</g>"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bench", default=os.path.join(ROOT, "build", "bench", "tests", "bench", "solver_bench"))
    parser.add_argument("--out", default=os.path.join(ROOT, "docs", "solvers", "convergence.svg"))
    parser.add_argument("--keep", metavar="DIR")
    options = parser.parse_args()
    if not os.path.exists(options.bench):
        sys.exit(f"{options.bench} is missing: cmake --preset bench && cmake --build build/bench --target solver_bench")
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or temporary
        subprocess.run([sys.executable, os.path.join(ROOT, "samples", "make_samples.py"), "rooms_4", "open_plan",
                        "--out", os.path.join(folder, "scenes")], check=True)
        panels = [panel_svg(panel, courses(options.bench, panel, folder), WIDTH * (k % 2), HEIGHT * (k // 2)) for k, panel in enumerate(PANELS)]
    rows = (len(PANELS) + 1) // 2
    with open(options.out, "w", encoding="utf-8") as file:
        file.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * WIDTH}" height="{rows * HEIGHT}" font-family="sans-serif" '
                   f'font-size="11">\n<rect width="100%" height="100%" fill="white"/>\n' + "\n".join(panels) + "\n</svg>\n")
    print(options.out)


if __name__ == "__main__":
    main()
