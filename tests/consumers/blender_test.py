#!/usr/bin/env python3
"""Blender imports baked models with both UV sets, every value of them.

usage: blender_test.py LUXEL

Needs `tools/setup.sh consumers`, which installs Blender as a Python module (1 GB); skipped without.
"""
import json
import os
import subprocess
import sys
import tempfile

import scene_loop
import scenes

PYTHON = os.path.join(scenes.MODULES, "blender", "bin", "python")


def check(luxel, source, folder):
    wrong = []
    for suffix in (".glb", ".gltf"):
        baked = os.path.join(folder, "baked" + suffix)
        scenes.bake(luxel, source, baked)
        done = subprocess.run([PYTHON, "-B", os.path.join(scenes.HERE, "blender_check.py"), baked], text=True, errors="replace", check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        if done.returncode:
            return [f"{suffix}: {done.stderr[-1500:]}"]
        found = json.loads(done.stdout.splitlines()[-1])
        if found["triangles"] == 0 or found["missing"] or found["extra"]:
            wrong.append(f"{suffix}: {found}")
        else:
            print(f"    {suffix}: {found}", flush=True)
    return wrong


def main():
    luxel = sys.argv[1]
    if not os.path.exists(PYTHON):
        scenes.skip("Blender's Python module is missing: tools/setup.sh consumers")
    with tempfile.TemporaryDirectory(prefix="luxel-blender-") as folder:
        sources = [os.path.join(scenes.ROOT, "samples", name, name + ".gltf") for name in ("cornell_box", "painted_room")]
        sources += [path for path in scenes.foreign_scenes() if os.path.basename(path) in ("staircase.glb", "house.glb", "lq_e1m1.glb")]
        scene_loop.end_with([(source,) for source in sources], lambda source: check(luxel, source, folder), bad="WRONG")


if __name__ == "__main__":
    main()
