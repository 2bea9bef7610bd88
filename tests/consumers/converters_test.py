#!/usr/bin/env python3
"""gltfpack and glTF-Transform read baked models and write them again, and no lightmap is lost.

usage: converters_test.py LUXEL

For each of a few models (many meshes, several pages, textures, two UV sets), and each way of converting: every triangle still has
its picture, byte for byte, its intensity and extras, and its lightmap coordinates (lightmap_set.py). The commands are those that
docs/viewers.md shows. Without them both tools drop lightmaps, which is tested too: when that changes, the page has to.
Needs `tools/setup.sh consumers`; skipped without.
"""
import os
import subprocess
import sys
import tempfile

import everything
import gltf_file
import scene_loop
import scenes
from lightmap_set import lightmap_set, lost, moved

GLTFPACK = os.path.join(scenes.MODULES, "node_modules", "gltfpack", "cli.js")
PACK_LIGHTMAPS = os.path.join(scenes.ROOT, "tools", "gltfpack", "pack-lightmaps.mjs")
TRANSFORM = os.path.join(scenes.HERE, "transform_check.mjs")


def gltfpack_alone(source, target):
    """All flags that keep things: the lightmaps are gone all the same."""
    return ["node", GLTFPACK, "-i", source, "-o", target, "-noq", "-kv", "-ke", "-km", "-kn"]


def pack(*options):
    return lambda source, target: ["node", PACK_LIGHTMAPS, source, target, *options]


def transform(*steps):
    return lambda source, target: ["node", "--import", os.path.join(scenes.HERE, "modules.mjs"), TRANSFORM, source, target, *steps]


# gltfpack rounds floats to the bits of -vt, unless it is told -noq: 16 of them are within 2^-16 of a page, 0.06 texels of 4,096.
ROUNDED = 2.0 ** -16
KEEPING = {
    "gltfpack": pack(), "gltfpack -cc -kn": pack("-cc", "-kn"), "gltfpack -noq": pack("-noq"),
    "glTF-Transform": transform(), "glTF-Transform dedup, prune, weld": transform("dedup", "prune", "weld"),
    "glTF-Transform flatten, join, prune": transform("flatten", "join", "prune"), "glTF-Transform meshopt": transform("meshopt"),
}
# glTF-Transform's encoder does not take indices of one byte, which the made model has where nothing is baked.
IMPOSSIBLE = {("everything.gltf", "glTF-Transform meshopt")}
LOSING = {"gltfpack alone": gltfpack_alone, "glTF-Transform without the extension class": transform("without-extension")}


def run(command):
    done = subprocess.run(command, env={**os.environ, "LUXEL_MODULES": scenes.MODULES, "GLTFPACK": GLTFPACK}, text=True, errors="replace",
                          check=False, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr[-1500:]}{done.stdout[-500:]}")


def decoded(path, folder):
    """A file whose arrays can be read here."""
    if not any("meshopt" in name for name in gltf_file.GltfFile(path).items("extensionsUsed")):
        return path
    target = os.path.join(folder, "decoded.glb")
    done = scenes.node(os.path.join(scenes.HERE, "decode.mjs"), path, target)
    if done.returncode:
        raise RuntimeError(done.stderr[-1500:])
    return target


def check(luxel, folder, source, way):
    baked = os.path.join(folder, way.name, "baked.glb")
    scenes.bake(luxel, source, baked, *way.arguments)
    wrong, before, target = [], lightmap_set(baked), os.path.join(folder, "converted.glb")
    for name, command in {**KEEPING, **LOSING}.items():
        if (os.path.basename(source), name) in IMPOSSIBLE:
            continue
        try:
            run(command(baked, target))
            after = lightmap_set(decoded(target, folder))
            if name in KEEPING:
                is_rounded = name.startswith("gltfpack") and "-noq" not in name
                wrong += [f"{name}: {line}" for line in (moved(before, after, ROUNDED) if is_rounded else lost(before, after))]
            elif after:
                wrong.append(f"{name}: lightmaps survive now; docs/viewers.md says they do not")
        except RuntimeError as error:
            wrong.append(f"{name}: {error}")
    return wrong


def main():
    luxel = sys.argv[1]
    if not scenes.has_modules():
        scenes.skip("node or its packages are missing: tools/setup.sh consumers")
    with tempfile.TemporaryDirectory(prefix="luxel-converters-") as folder:
        sources = [os.path.join(scenes.ROOT, "samples", name, name + ".gltf") for name in ("cornell_box", "painted_room", "corridor_4")]
        sources.append(everything.write(folder))
        sources += [path for path in scenes.foreign_scenes() if os.path.basename(path) in ("staircase.glb", "house.glb", "lq_e1m1.glb")]
        jobs = [(source, scenes.ALL_WAYS[0]) for source in sources]
        # Neither knows lightmaps of nodes (docs/viewers.md).
        jobs += [(sources[0], way) for way in scenes.ways(luxel) if {"--lightmap-format", "--profile"} & set(way.arguments) and "mx" not in way.arguments]
        scene_loop.end_with(jobs, lambda source, way: check(luxel, folder, source, way), bad="LOST")


if __name__ == "__main__":
    main()
