"""Bytes of the form factors against the lecture's sums."""
import os

from lecture.common import bake, sample, table

# Name, scene, options. The last one is not part of the project: it is looked for in --scenes, and left out where it is not there.
SCENES = [("two_rooms", sample("two_rooms"), ["--texels-per-metre", "24"]), ("cornell_box", sample("cornell_box"), ["--texels-per-metre", "200"]),
          ("corridor_16", sample("corridor_16"), ["--texels-per-metre", "13"]),
          ("staircase", os.path.join("staircase", "staircase.glb"), ["--texels-per-metre", "12"])]
RAYS = [256, 4096]


def bytes_of(folder, kind):
    return sum(os.path.getsize(os.path.join(where, name)) for where, _, names in os.walk(folder) for name in names
               if (name if where == folder else os.path.relpath(where, folder)).startswith(kind))


def measure(setting, name, scene, options, rays):
    """The lecture's sums for a bake, and what it has on disk."""
    group = os.path.join("storage", f"{name}-{rays}")
    made = bake(setting, scene, group, "draft", ["--quality", "draft", "--importance", "off", "--rays", str(rays), *options])
    n, pairs = made.report["counts"]["patches"], made.report["counts"]["pairs"]
    stored = made.report["store"]["bytes"]
    half = n * (n - 1) // 2
    return {"patches": n, "rays": rays, "pairs": pairs, "non-zero": pairs / half, "square": 4 * n * n, "half": 4 * half, "bit index": half // 8 + 4 * pairs,
            "stored": stored, "evidence": bytes_of(os.path.join(setting.work, group, "work"), "evidence-")}


def size(value):
    unit, text = next((u, t) for u, t in ((1e9, "GB"), (1e6, "MB"), (1e3, "kB"), (1, "B")) if value >= u or u == 1)
    return f"{value / unit:.3g} {text}"


def main(setting):
    scenes, rays = ([("two_rooms", sample("two_rooms"), ["--texels-per-metre", "12"])], [256]) if setting.quick else (SCENES, RAYS)
    found = [(name, os.path.join(setting.scenes, scene), options) for name, scene, options in scenes]
    results = [(name, measure(setting, name, scene, options, count)) for name, scene, options in found if os.path.exists(scene) for count in rays]
    table(["scene", "patches N", "rays", "N² entries", "half", "not zero", "bit index and floats", "of the half", "luxel", "of the half", "evidence, both directions"],
          [[name, f"{r['patches']:,}", f"{r['rays']:,}", size(r["square"]), size(r["half"]), f"{100 * r['non-zero']:.2g} %", size(r["bit index"]),
            f"{100 * r['bit index'] / r['half']:.2g} %", size(r["stored"]), f"{100 * r['stored'] / r['half']:.2g} %", size(r["evidence"])] for name, r in results])
    return results


def check(results):
    for name, r in results:
        assert 0 < r["pairs"] <= r["patches"] * (r["patches"] - 1) // 2, f"{name}: more pairs than unordered pairs: {r}"
        assert r["half"] * 2 < r["square"], f"{name}: reciprocity does not halve: {r}"
        assert r["stored"] < r["bit index"] < r["half"], f"{name}: the index saves nothing: {r}"
        assert r["stored"] < r["evidence"], f"{name}: both directions pooled take more than each alone: {r}"
