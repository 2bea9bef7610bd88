#!/usr/bin/env python3
"""Bakes scenes and holds their lightmaps against path tracing of the source scene; the table is truth_cases.py.

usage: truth_test.py LUXEL [--short | --only NAME ...] [--quality Q ...] [--points N] [--spp N] [--scenes DIR] [--work DIR] [--scalar]

--short       few texels of a few small scenes at medium
--scenes DIR  foreign scenes (default: ../shared/scenes beside the project); a missing one is named and left out
--work DIR    keep bakes and figures there
--scalar      do as on a machine without LLVM: Mitsuba's own integrator in scalar_rgb, few paths, plain scenes only
Prints a table in Markdown. Exit status 1: a limit is passed; 77: nothing could be compared.
Needs the Python environment of `tools/setup.sh reference`, or LUXEL_REFERENCE_PYTHON, an interpreter that has its packages.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from interpreter import ROOT, SKIPPED, use_reference_python   # noqa: E402
from truth_cases import CASES, GOALS   # noqa: E402

SHORT_POINTS, SHORT_SPP, SCALAR_SPP = 150, 8192, 256


def light_of(case):
    import lights
    parser = argparse.ArgumentParser()
    lights.add_options(parser)
    return lights.from_options(parser.parse_args(case.light.split()))


def bake(luxel, case, scene, quality, folder):
    """Path of the bake, seconds."""
    output = os.path.join(folder, f"{case.name}.{quality}.glb")
    begin = time.time()
    subprocess.run([luxel, "bake", scene, "-o", output, "--quality", quality, "-q", "--report", output + ".report.json",
                    *case.options.split(), *case.light.split()], check=True)
    return output, time.time() - begin


def limits_of(case, quality, short, figures):
    """Figure -> limit. A slow tracer has few paths: its noise is added."""
    limits = dict(case.short) if short else {**GOALS[quality], **case.missed.get(quality, {})}
    if figures["tracer"] == "stock":
        limits["median"] += 2 * figures["noise_median"]
        limits["p95"] += 2 * figures["noise_p95"]
        limits["bias"] += 3 * figures["bias_se"]
    return limits


def verdict(case, quality, short, figures):
    """Text, and whether the limits hold."""
    words, good = [], True
    for key, limit in limits_of(case, quality, short, figures).items():
        value, goal = abs(figures[key]), GOALS[quality][key]
        if value > limit:
            good = False
            words.append(f"FAILED: {key} is above {limit:.2%}")
        elif not short and value > goal:
            words.append(f"{key} misses {goal:.1%}")
        elif not short and limit > goal and value < 0.9 * goal:
            words.append(f"{key} is met: its line of `missed` can go")
    if figures["bad_values"]:
        good = False
        words.append(f"FAILED: {figures['bad_values']} values are not numbers")
    return "; ".join(words) or "met", good


def one(case, scene, options, module):
    """Bakes at each quality, compares with one truth, prints rows. Returns whether all limits hold."""
    import reference
    good, truth = True, None
    with tempfile.TemporaryDirectory(prefix="luxel-truth-") as place:
        folder = options.work or place
        os.makedirs(folder, exist_ok=True)
        for quality in options.quality:
            baked, seconds = bake(options.luxel, case, scene, quality, folder)
            begin = time.time()
            if truth is None:
                points = options.points or (SHORT_POINTS if options.short else 2000)
                spp = options.spp or (SCALAR_SPP if module.__name__ == "stock" else SHORT_SPP if options.short else case.spp)
                truth = reference.Truth(scene, baked, points, spp, light=light_of(case), module=module)
            figures, _, _ = truth.against(baked)
            text, held = verdict(case, quality, options.short, figures)
            good &= held
            figures.update(case=case.name, quality=quality, bake_seconds=seconds, truth_seconds=time.time() - begin, verdict=text)
            with open(baked + ".truth.json", "w", encoding="utf-8") as file:
                json.dump(figures, file, indent=1)
            print(row(figures), flush=True)
    return good


HEAD = ("| scene | quality | texels | median | p95 | bias | truth's own median | truth's own p95 | truth's own bias | bake s | goals |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|")


def row(f):
    return (f"| {f['case']} | {f['quality']} | {f['points']} | {f['median']:.2%} | {f['p95']:.2%} | {f['bias']:+.2%} | {f['noise_median']:.2%} "
            f"| {f['noise_p95']:.2%} | {f['bias_se']:.2%} | {f['bake_seconds']:.1f} | {f['verdict']} |")


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("luxel")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--short", action="store_true")
    which.add_argument("--only", nargs="+", choices=[c.name for c in CASES], metavar="NAME")
    parser.add_argument("--quality", nargs="+", choices=list(GOALS), metavar="Q")
    parser.add_argument("--points", type=int)
    parser.add_argument("--spp", type=int, help="paths per texel")
    parser.add_argument("--scenes", default=os.path.join(ROOT, "../shared/scenes"), metavar="DIR")
    parser.add_argument("--work", metavar="DIR")
    parser.add_argument("--scalar", action="store_true")
    options = parser.parse_args()
    options.quality = options.quality or (["medium"] if options.short else ["medium", "high"])
    return options


def main():
    options = parse()
    use_reference_python()
    if options.scalar:
        import stock as module
    else:
        import reference
        module = reference.path_tracer()
    chosen = [c for c in CASES if (c.short if options.short else not options.only or c.name in options.only)]
    good, compared = True, 0
    print(HEAD, flush=True)
    for case in chosen:
        scene = os.path.normpath(os.path.join(ROOT, case.scene.format(scenes=os.path.abspath(options.scenes))))
        if not os.path.exists(scene):
            print(f"truth_test: {case.name} is left out: {scene} is not there (see --scenes)", flush=True)
            continue
        try:
            good &= one(case, scene, options, module)
            compared += 1
        except ValueError as error:
            if module.__name__ != "stock":
                raise
            print(f"truth_test: {case.name} is left out: {error}", flush=True)
    if not compared:
        sys.exit(SKIPPED)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
