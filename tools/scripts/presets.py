#!/usr/bin/env python3
"""Measures the presets of --quality beside other settings, and derives them: prints the tables of docs/presets.md.

usage: tools/scripts/presets.py --work DIR [--luxel LUXEL] [--shared DIR] [--scenes NAME ...] [--grid FILE] [--measured] [--write] [--check]

Each scene (tools/scripts/ladder/scenes.py) is swept over the settings of tools/scripts/ladder/grid.json by `luxel sweep`; what the presets must keep is in
tools/scripts/ladder/rules.py.

--work DIR    the sweeps are kept there: an interrupted run goes on
--luxel       default: build/release/tools/luxel/luxel
--shared DIR  foreign scenes (default: ../shared/scenes beside the project); missing ones are named and left out
--scenes      only these
--measured    sweeps nothing: takes the sweeps that are finished
--write       puts the tables into docs/presets.md instead of printing them
--check       exit status 1 where the presets do not keep the rules
"""
import argparse
import os
import subprocess
import sys

ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from ladder import rules, scenes, sweeps, tables   # noqa: E402

DOCS = os.path.join(ROOT, "docs", "presets.md")
BEGIN, END = "<!-- presets.py writes from here -->\n", "<!-- to here -->\n"
# Error in the geometric mean over the scenes, at the densities of scenes.py. Chosen, not measured: a draft shows where light is; the noise of medium is hardly
# seen; that of high is less than a step of a picture of eight bits; the reference has half of that.
AIMS = {"draft": 0.2, "medium": 0.025, "high": 0.01, "reference": 0.005}


def measure(options):
    found = []
    for scene in scenes.SCENES:
        if options.scenes and scene.name not in options.scenes:
            continue
        folder = os.path.join(options.work, scene.name)
        if not os.path.exists(scene.path(options.shared)):
            print(f"presets: {scene.name} is left out: {scene.path(options.shared)} is not there (see --shared)", file=sys.stderr)
            continue
        if not options.measured:
            print(f"presets: {scene.name}", file=sys.stderr, flush=True)
            try:
                sweeps.run(options.luxel, scene, options.shared, folder, options.grid)
            except subprocess.CalledProcessError as error:
                sys.exit(f"presets: {scene.name}: luxel sweep ended with {error.returncode}")
        sweep = sweeps.load(scene, folder)
        if sweep:
            found.append(sweep)
        else:
            print(f"presets: {scene.name} is left out: it is not finished in {folder}", file=sys.stderr)
    return found


def report(found, aims):
    """Markdown, and whether the presets keep the rules."""
    figures = rules.Figures(found)
    for sweep in found:
        missing = [rung for rung in rules.RUNGS if rules.preset(rung) not in sweep.points]
        if missing:
            sys.exit(f"presets: {sweep.scene}: not measured: {', '.join(missing)}")
    if not figures.scenes:
        sys.exit("presets: light is exact in all of these scenes")
    own = [(rung, rules.preset(rung)) for rung in rules.RUNGS]
    derived = rules.derive(figures, aims)
    ladder = [(rung.name, rung.setting) for rung in derived]
    absent = [scene.name for scene in scenes.SCENES if scene.name not in figures.measured]
    text = "### Presets by scene\n\n" + tables.by_scene(figures, found)
    text += f"\nNot measured: {', '.join(absent)}.\n" if absent else ""
    text += "\n### The presets\n\n" + tables.rungs(figures, own, aims)
    text += "\n### The ladder that the rules give\n\n" + tables.rungs(figures, ladder, aims)
    text += "\n" + tables.verdict(figures, ladder)
    text += "\n### All settings\n\n" + tables.grid(figures)
    return text, all(tables.keeps(figures, own, k, aims) for k in range(len(own)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", required=True, metavar="DIR")
    parser.add_argument("--luxel", default=os.path.join(ROOT, "build", "release", "tools", "luxel", "luxel"))
    parser.add_argument("--shared", default=os.path.join(ROOT, "..", "shared", "scenes"), metavar="DIR")
    parser.add_argument("--scenes", nargs="+", choices=[scene.name for scene in scenes.SCENES], metavar="NAME")
    parser.add_argument("--grid", default=sweeps.GRID, metavar="FILE")
    parser.add_argument("--measured", action="store_true")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    found = measure(options)
    if not found:
        sys.exit("presets: nothing was measured")
    text, kept = report(found, AIMS)
    if options.write:
        with open(DOCS, encoding="utf-8") as file:
            before, rest = file.read().split(BEGIN)
        with open(DOCS, "w", encoding="utf-8") as file:
            file.write(before + BEGIN + text + END + rest.split(END)[1])
    else:
        print(text, end="")
    sys.exit(1 if options.check and not kept else 0)


if __name__ == "__main__":
    main()
