#!/usr/bin/env python3
"""Measures what docs/extremes.md promises: prints its table of extremes, and draws the error against scale, emission, albedo and area.

usage: build/deps/reference/bin/python tools/scripts/stability.py [--build DIR] [--out docs/stability] [--quick]

Three closed cubes whose light is known exactly. All walls are of one grey and glow: every texel has H = M / (1 - rho). Only the ceiling glows: what
is emitted is absorbed. The same with black walls: the floor has what it sees of the ceiling. Each extreme changes these rooms. Columns:
  worst texel       of the first room, gathered: largest relative error
  all light         of the second room: relative error of what is absorbed
  floor             of the third room: relative error in the middle of the floor, gathered with 4,096 rays
  double, single    of the second room: the same matrix solved with all sums in one precision (tests/figures/accumulation.cpp)
--quick: some lines and points, no pictures; exit status 1 where an error is absurd.
"""
import argparse
import os
import sys
import tempfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path[:0] = [os.path.dirname(os.path.abspath(__file__)), os.path.join(ROOT, "tests", "reference"), os.path.join(ROOT, "samples")]
from interpreter import use_reference_python   # noqa: E402


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "dev"), metavar="DIR")
    parser.add_argument("--out", default=os.path.join(ROOT, "docs", "stability"), metavar="DIR")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    use_reference_python()
    from stable import curves, extremes
    with tempfile.TemporaryDirectory() as folder:
        rows = extremes.measure(os.path.abspath(options.build), folder, options.quick)
        extremes.show(rows)
        lines = curves.measure(os.path.abspath(options.build), folder, options.quick)
        curves.show(lines)
    if options.quick:
        extremes.check(rows)
        curves.check(lines)
    else:
        os.makedirs(options.out, exist_ok=True)
        curves.draw(lines, options.out)


if __name__ == "__main__":
    main()
