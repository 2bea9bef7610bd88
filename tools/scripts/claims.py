#!/usr/bin/env python3
"""Measures what the lecture claims of radiosity; prints the tables and draws the pictures of docs/claims.md.

usage: build/deps/reference/bin/python tools/scripts/claims.py [--only NAME ...] [--build DIR] [--scenes DIR] [--work DIR] [--out DIR] [--quick]

alias      form factors of the hemicube, and how little of their error reaches the picture
storage    bytes of the form factors against the lecture's sums
course     gathering against shooting: what a partial solution is worth; and what the ambient term does to it
spreading  constant, linear, cubic: is cubic worth it?
shadow     the edge of a shadow across regular patches

--build DIR  a build with tests and benchmarks (build/dev): cmake --preset dev -DLUXEL_BENCH=ON
--scenes DIR foreign scenes (default: ../shared/scenes beside the project); a missing one is left out
--work DIR   keep the bakes there, and use them again
--quick      the smallest cases, without pictures; exit status 1 where figures are absurd
"""
import argparse
import importlib
import os
import sys
import tempfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path[:0] = [os.path.dirname(os.path.abspath(__file__)), os.path.join(ROOT, "tests", "reference")]
from interpreter import use_reference_python   # noqa: E402

PARTS = ["alias", "storage", "course", "spreading", "shadow"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS, metavar="NAME")
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "dev"), metavar="DIR")
    parser.add_argument("--scenes", default=os.path.join(ROOT, "..", "shared", "scenes"), metavar="DIR")
    parser.add_argument("--work", metavar="DIR")
    parser.add_argument("--out", default=os.path.join(ROOT, "docs", "claims"), metavar="DIR")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    use_reference_python()
    from lecture.common import Setting
    with tempfile.TemporaryDirectory() as temporary:
        setting = Setting(os.path.abspath(options.build), os.path.abspath(options.scenes), options.work or temporary, options.out, options.quick)
        for name in options.only:
            part = importlib.import_module("lecture." + name)
            print(f"## {name}\n", flush=True)
            results = part.main(setting)
            if options.quick:
                part.check(results)


if __name__ == "__main__":
    main()
