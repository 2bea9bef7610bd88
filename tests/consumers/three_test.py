#!/usr/bin/env python3
"""three.js shows reflectance / pi * irradiance * exposure, from every kind of lightmap page: in a real browser.

usage: three_test.py LUXEL

Bakes the Cornell box once per kind of page, loads it by GLTFLoader with tools/three/luxel-lightmap.js in headless Chromium, and
compares pixels of lit walls with the float pages (read by three's EXRLoader, not by luxel): linear values before tone mapping,
and the canvas with linear tone mapping at a given exposure. Needs `tools/setup.sh consumers`; skipped without.
"""
import json
import os
import re
import shutil
import statistics
import struct
import sys
import tempfile

import gltf_file
import scenes

VIEW = {"from": [0.278, 0.273, -0.8], "at": [0.278, 0.273, 0.2], "fov": 39}
BAKE = ("--quality", "draft", "--texels-per-metre", "120", "--rays", "256")
KINDS = [scenes.Way("srgb8", ".glb", ("--encoding", "srgb8")), scenes.Way("linear8", ".glb", ("--encoding", "linear8")),
         scenes.Way("mx, several pages", ".glb", ("--profile", "mx", "--atlas-size", "128", "--padding", "1"))]
TOLERANCE = 0.02
# Lit: at least this share of the page's largest value. Half a step of a linear byte is 1 % there.
LIT = 0.2
EXPOSURE = 2.5


def check(folder, call, options, file=None, **arguments):
    """Calls a function of three_page.js; `file`: where a picture of the canvas goes."""
    job = {"call": call, "file": file, "arguments": {"options": options, **arguments}}
    done = scenes.node(os.path.join(scenes.HERE, "three_check.mjs"), folder, input=json.dumps(job), timeout=300)
    if done.returncode:
        raise RuntimeError(f"three_check.mjs: {done.stderr[-2000:]}")
    answer = json.loads(done.stdout)
    for line in answer["complaints"]:
        print("    the page says:", line)
    return answer.get("result")


def pages_of(folder, stem):
    return sorted(f"/baked/{name}" for name in os.listdir(folder) if re.fullmatch(re.escape(stem) + r"\.lightmap\d+\.exr", name))


def srgb(value):
    value = min(max(value, 0.0), 1.0)
    return 255 * (12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055)


def lit_values(pixels):
    """(pixel, channel, expected) of what is lit."""
    return [(pixel, channel, pixel["expected"][channel]) for pixel in pixels for channel in range(3)
            if pixel["lux"][channel] >= LIT * pixel["largest"]]


def judge(name, pixels, wrong):
    """Compares lit pixels with reflectance / pi * irradiance; appends what is wrong, and prints one line."""
    errors, bytes_off, objects = [], 0, set()
    for pixel, channel, expected in lit_values(pixels):
        objects.add(pixel["object"])
        errors.append(pixel["linear"][channel] / expected - 1)
        low, high = (srgb(expected * EXPOSURE * (1 + sign * TOLERANCE)) + sign * 0.5 for sign in (-1, 1))
        bytes_off += not low - 1e-3 <= pixel["exposed"][channel] <= high + 1e-3
    if len(errors) < 1000 or len(objects) < 3:
        wrong.append(f"{name}: only {len(errors)} lit values of {len(objects)} objects")
        return
    worst, mean = max(map(abs, errors)), statistics.fmean(errors)
    print(f"{name:22} {len(errors):6} values of {len(objects)} objects, error: mean {100 * mean:+.3f} %, largest {100 * worst:.2f} %; "
          f"{bytes_off} bytes of the canvas off")
    if worst > TOLERANCE:
        wrong.append(f"{name}: a pixel is {100 * worst:.2f} % off, allowed {100 * TOLERANCE:.0f} %")
    if abs(mean) > TOLERANCE / 4:
        wrong.append(f"{name}: all pixels together are {100 * mean:+.2f} % off")
    if bytes_off:
        wrong.append(f"{name}: {bytes_off} bytes of the canvas are not reflectance / pi * irradiance * exposure")


def judge_standard(pixels, wrong):
    """three's standard material keeps a part of the diffuse light for its mirror-like part: 1.5 % head-on at roughness 1, more the
    flatter one looks. It must not keep more than that, nor give any."""
    shares = [pixel["linear"][channel] / expected for pixel, channel, expected in lit_values(pixels)]
    print(f"{'standard material':22} {len(shares):6} values, {min(shares):.3f} to {max(shares):.3f} of the light, "
          f"mean {statistics.fmean(shares):.3f}")
    if not 0.9 < min(shares) <= max(shares) < 1 + TOLERANCE or not 0.95 < statistics.fmean(shares) < 0.99:
        wrong.append("standard material: shows another share of the light than docs/viewers.md says")


def rewrite(source, target, edit):
    """A copy of a GLB, changed by edit(document, body)."""
    file = gltf_file.GltfFile(source)
    body = bytearray(file.body)
    edit(file, body)
    gltf_file.write_glb(target, file.json, bytes(body))


OFFSET, SCALE = (0.25, -0.5), (2.0, 4.0)


def move_coordinates(file, body):
    """Puts lightmap coordinates into a corner of UV space: coordinate on the page = the new one * SCALE + OFFSET."""
    done = set()
    for mesh in file.items("meshes"):
        for primitive in mesh["primitives"]:
            index = primitive["attributes"]["TEXCOORD_1"]
            accessor = file.items("accessors")[index]
            view = file.items("bufferViews")[accessor["bufferView"]]
            start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
            if start in done:
                continue
            done.add(start)
            for number, pair in enumerate(file.numbers(index)):
                moved = [(value - o) / s for value, o, s in zip(pair, OFFSET, SCALE)]
                struct.pack_into("<2f", body, start + number * view.get("byteStride", 8), *moved)


def transformed(file, body):
    """A transform takes the coordinates out of their corner."""
    move_coordinates(file, body)
    for material in file.items("materials"):
        if "MOZ_lightmap" in material.get("extensions", {}):
            material["extensions"]["MOZ_lightmap"]["extensions"] = {"KHR_texture_transform": {"offset": OFFSET, "scale": SCALE}}
    file.json["extensionsUsed"].append("KHR_texture_transform")


def placed(file, body):
    """The places of nodes do."""
    move_coordinates(file, body)
    for node in file.items("nodes"):
        if "MX_lightmap" in node.get("extensions", {}):
            node["extensions"]["MX_lightmap"].update(offset=OFFSET, scale=SCALE)


def copied(file, body):
    """Attributes of copies do: each node shows itself, and a copy far behind the camera with another place."""
    move_coordinates(file, body)

    def column(kind, values):
        body.extend(bytes(-len(body) % 4))
        file.json["bufferViews"].append({"buffer": 0, "byteOffset": len(body), "byteLength": 4 * len(values)})
        body.extend(struct.pack(f"<{len(values)}f", *values))
        file.json["accessors"].append({"bufferView": len(file.json["bufferViews"]) - 1, "componentType": 5126, "type": kind, "count": 2})
        return len(file.json["accessors"]) - 1

    attributes = {"TRANSLATION": column("VEC3", [0, 0, 0, 0, 0, -90]), "_LIGHTMAP_OFFSET": column("VEC2", [*OFFSET, 0.9, 0.9]),
                  "_LIGHTMAP_SCALE": column("VEC2", [*SCALE, 0.01, 0.01])}
    for node in file.items("nodes"):
        if "mesh" in node:
            node.setdefault("extensions", {})["EXT_mesh_gpu_instancing"] = {"attributes": attributes}
    file.json["extensionsUsed"].append("EXT_mesh_gpu_instancing")
    file.json["buffers"][0]["byteLength"] = len(body)


def unlit(file, body):
    del body
    for material in file.items("materials"):
        material.setdefault("extensions", {})["KHR_materials_unlit"] = {}
    file.json["extensionsUsed"].append("KHR_materials_unlit")


def main():
    luxel = sys.argv[1]
    if not scenes.has_modules() or not shutil.which(os.environ.get("LUXEL_CHROMIUM", "chromium")):
        scenes.skip("node, its packages or chromium are missing: tools/setup.sh consumers")
    wrong = []
    box = os.path.join(scenes.ROOT, "samples", "cornell_box", "cornell_box.gltf")
    with tempfile.TemporaryDirectory(prefix="luxel-three-") as folder:
        kinds = {way.name: way for way in [*KINDS, *(way for way in scenes.ways(luxel) if {"--lightmap-format", "--profile"} & set(way.arguments) and not way.is_packed)]}
        for kind, way in kinds.items():
            scenes.bake(luxel, box, os.path.join(folder, kind + way.suffix), "--work", os.path.join(folder, "work"), *way.arguments, options=BAKE)
        first = KINDS[0].name
        for name, edit in (("transform", transformed), ("copies", copied), ("unlit", unlit)):
            rewrite(os.path.join(folder, first + ".glb"), os.path.join(folder, name + ".glb"), edit)
        rewrite(os.path.join(folder, "mx.glb"), os.path.join(folder, "placed.glb"), placed)

        def compare(model, pages, suffix=".glb", **options):
            return check(folder, "compare", options, model=f"/baked/{model}{suffix}", pages=pages_of(folder, pages), camera=VIEW, exposure=EXPOSURE)

        for kind, way in kinds.items():
            judge(kind, compare(kind, kind, way.suffix, lambert=True), wrong)
        judge("KHR_texture_transform", compare("transform", first, lambert=True), wrong)
        judge("places of nodes", compare("placed", "mx", lambert=True), wrong)
        judge("copies of nodes", compare("copies", first, lambert=True), wrong)
        judge("unlit", compare("unlit", first), wrong)
        judge_standard(compare(first, first), wrong)
    print(*wrong, sep="\n", file=sys.stderr)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
