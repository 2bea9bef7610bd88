#!/usr/bin/env python3
"""The trade of --store all|hot|none: bakes one scene with each and prints disk, time and rays as a table.

usage: store_modes.py LUXEL SCENE [--memory SIZE,SIZE...] [--hot SIZE,SIZE...] [-- bake options]

Every bake starts with an empty folder. Exit status 1 if two bakes differ in any byte of their outputs.
    disk      what is left in the bake folder of form factors: evidence, strips, directory, kept blocks
    peak      the most of it that was there at any time, looked at ten times a second
    processor user and system time of all threads, seconds
"""
import argparse
import hashlib
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time

MATRIX = ("evidence-", "strips-", "hot-", "directory-", "pooling-")


def matrix_bytes(folder):
    total = 0
    for where, _, names in os.walk(folder):
        part = os.path.relpath(where, folder)
        for name in names:
            if (name if part == "." else part).startswith(MATRIX):
                try:
                    total += os.path.getsize(os.path.join(where, name))
                except FileNotFoundError:
                    pass  # a temporary that has just been published
    return total


def outputs(folder):
    digest = hashlib.sha256()
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), "rb") as file:
            digest.update(name.encode() + file.read())
    return digest.hexdigest()


def bake(luxel, scene, options):
    place = tempfile.mkdtemp(prefix="luxel-store-")
    try:
        work, out, report = (os.path.join(place, name) for name in ("work", "out", "report.json"))
        os.makedirs(out)
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        process = subprocess.Popen([luxel, "bake", scene, "-o", os.path.join(out, "scene.glb"), "--work", work, "--report", report,
                                    "-q", *options])
        peak = 0
        while process.poll() is None:
            peak = max(peak, matrix_bytes(work))
            time.sleep(0.1)
        seconds, after = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
        if process.returncode:
            sys.exit(f"luxel bake {' '.join(options)}: exit code {process.returncode}")
        with open(report, encoding="utf-8") as file:
            found = json.load(file)
        found["seconds"], found["disk"], found["outputs"] = seconds, matrix_bytes(work), outputs(out)
        found["peak"] = max(peak, found["disk"])
        found["processor"] = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return found
    finally:
        shutil.rmtree(place, ignore_errors=True)


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1][7:])
    parser.add_argument("luxel")
    parser.add_argument("scene")
    parser.add_argument("--memory", default="2G")
    parser.add_argument("--hot", default="")
    end = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    a, options = parser.parse_args(sys.argv[1:end]), sys.argv[end + 1:]
    first = None
    print("| store | memory | disk, MB | peak, MB | seconds | processor | rays, million | of them again |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for memory in a.memory.split(","):
        choices = [("all", [])] + [("hot", ["--store-bytes", size]) for size in a.hot.split(",") if size]
        choices += [("hot", [])] * (not a.hot) + [("none", [])]
        for store, more in choices:
            r = bake(a.luxel, a.scene, ["--store", store, *more, "--memory", memory, *options])
            first = first or r
            rays, traced = r["evidence"]["rays"], r["evidence"]["rays_traced"]
            print(f"| {' '.join([store, *more[1:]])} | {memory} | {r['disk'] / 1e6:.3g} | {r['peak'] / 1e6:.3g} | {r['seconds']:.1f} | "
                  f"{r['processor']:.1f} | {traced / 1e6:.1f} | {(traced - rays) / 1e6:.1f} |", flush=True)
            if r["outputs"] != first["outputs"]:
                sys.exit("the outputs differ")
    counts = first["counts"]
    print(f"\n{counts['patches']} patches in {counts['chunks']} chunks, {counts['pairs']} pairs in {counts['blocks']} blocks; "
          "the same bytes as result each time.")


if __name__ == "__main__":
    main()
