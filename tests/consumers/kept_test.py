#!/usr/bin/env python3
"""Everything of the input is in the output: bakes scenes cheaply, and compares both documents (kept.py).

usage: kept_test.py LUXEL [--all] [--only TEXT]
  --all   the scenes of others too (LUXEL_SCENES, else ../shared/scenes beside the project), and every way of writing.
          Compressed ones are compared by their values where Node and `tools/setup.sh consumers` are there, else left out.
  --only  files whose path has this text

Without --all: a made model that has a bit of everything, and samples, as .glb, as .gltf and with lightmaps on nodes.
"""
import argparse
import os
import tempfile

import everything
import gltf_file
import kept
import scene_loop
import scenes


SHORT = {"glb", "gltf", "mx"}  # ways of a run without --all


def is_compressed(document):
    return any(name in document.get("extensionsUsed", []) for name in kept.COMPRESSION)


def decoded(source, folder):
    """The input with its arrays decoded; None where nothing is there to do so."""
    if not scenes.has_modules():
        return None
    target = os.path.join(folder, "decoded.glb")
    done = scenes.node(os.path.join(scenes.HERE, "decode.mjs"), source, target)
    if done.returncode:
        raise RuntimeError(f"decode.mjs: {done.stderr[-1000:]}")
    return gltf_file.GltfFile(target)


def unpacked(path, folder):
    """A baked model with its arrays decoded. Everything else is as the file has it: Node would round large numbers."""
    file = gltf_file.GltfFile(path)
    if not is_compressed(file.json):
        return file
    plain = decoded(path, folder)
    for accessor, other in zip(file.items("accessors"), plain.items("accessors")):
        accessor.update({key: other[key] for key in ("bufferView", "byteOffset", "count") if key in other})
    file.json.update({key: plain.json[key] for key in ("bufferViews", "buffers")})
    file.body = plain.body
    return file


def check(luxel, source, ways):
    """Bakes one scene in these ways; returns the lines of what is wrong."""
    wrong = []
    before = gltf_file.GltfFile(source)
    with tempfile.TemporaryDirectory(prefix="luxel-kept-") as folder:
        values = decoded(source, folder) if is_compressed(before.json) else before
        if values is None:
            print(f"{source}: left out, compressed, and decoders are missing (tools/setup.sh consumers)", flush=True)
            return []
        for way in ways:
            if way.is_packed and not scenes.has_modules():
                continue
            output = os.path.join(folder, way.name, "baked" + way.suffix)
            try:
                scenes.bake(luxel, source, output, "--work", os.path.join(folder, "work"), *way.arguments)
                wrong += [f"{way.name}: {line}" for line in kept.differences(before, values, unpacked(output, folder), way.is_packed)]
            except (RuntimeError, ValueError, OSError) as error:
                wrong.append(f"{way.name}: {error}")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("luxel")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    ways = [way for way in scenes.ways(options.luxel) if options.all or way.name in SHORT]
    with tempfile.TemporaryDirectory(prefix="luxel-everything-") as folder:
        paths = [everything.write(folder), *scenes.samples()]
        if options.all:
            foreign = scenes.foreign_scenes()
            if not foreign:
                scenes.skip(f"no scenes in {scenes.scenes_folder()}; LUXEL_SCENES names their folder")
            paths += foreign
        scene_loop.end_with([(path,) for path in paths if options.only in path], lambda path: check(options.luxel, path, ways))


if __name__ == "__main__":
    main()
