#!/usr/bin/env python3
"""Copies of a mesh around a point lamp: each texel shows the light of its own copy, however the geometry is shared.

usage: copies_test.py LUXEL

Wedges stand in a ring around a lamp: plain, turned, mirrored, half as large, flattened. They are black and see the lamp freely, so the truth is E = I cos / r2 on what faces it, and 0 elsewhere. Read by the viewers'
rules: MOZ_lightmap with KHR_texture_transform, or the attributes of EXT_mesh_gpu_instancing; and with --profile mx by MX_lightmap, from the
pictures in the model alone.
"""
import json
import math
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from interpreter import ROOT, use_reference_python   # noqa: E402

sys.path.insert(0, os.path.join(ROOT, "samples"))
from gltf_writer import Gltf, facing   # noqa: E402

CANDELA, RING_M, POINTS = 1000.0, 4.0, 4000
SCALES = [(1, 1, 1), (1, 1, 1), (-1, 1, 1), (0.5, 0.5, 0.5), (1, 0.4, 0.8)]

WEDGE = [[(0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0)], [(0, 0, 0), (0, 1.5, 0), (0, 0, 1)], [(0, 0, 0), (1, 0, 0), (0, 1.5, 0)],
         [(0, 1.5, 0), (1, 0, 0), (1, 0, 1)], [(0, 1.5, 0), (1, 0, 1), (0, 0, 1)]]


def outward(face, sign=1):
    """Wound so that its front looks away from the wedge's middle; with sign -1 towards it."""
    way = [sign * (sum(p[k] for p in face) / len(face) - (0.3, 0.4, 0.4)[k]) for k in range(3)]
    return facing(face, way)


def placements():
    for k, scale in enumerate(SCALES):
        angle = 2 * math.pi * k / len(SCALES)
        turn = 0.0 if k == 0 else 0.8 * k
        yield {"translation": [RING_M * math.cos(angle), 0.2 * k, RING_M * math.sin(angle)],
               "rotation": [0, math.sin(turn / 2), 0, math.cos(turn / 2)], "scale": list(scale)}


def scene(by_attributes):
    gltf = Gltf()
    gltf.lamp("lamp", {"type": "point", "intensity": CANDELA}, (0, 0.5, 0), (0, 0, -1))
    wedge = gltf.mesh("wedge", [outward(f) for f in WEDGE], gltf.material("black", (0, 0, 0)))
    if by_attributes:
        gltf.copies("ring", wedge, list(placements()))
        return gltf
    for k, place in enumerate(placements()):
        gltf.nodes[gltf.node(f"copy {k}", wedge)].update(place)
    return gltf


def expected(points, normals):
    import numpy as np
    way = np.array([0, 0.5, 0]) - points
    distance = np.linalg.norm(way, axis=1)
    return CANDELA * np.maximum((way * normals).sum(1), 0) / distance ** 3


def check(luxel, by_attributes, mode, profile, folder):
    import numpy as np
    from gltf_scene import Scene
    from lightmap import Lightmaps
    name = f"{'attributes' if by_attributes else 'nodes'}-{mode}-{profile}"
    source, baked = os.path.join(folder, name + ".gltf"), os.path.join(folder, name + ".glb")
    scene(by_attributes).save(folder, name)
    subprocess.run([luxel, "bake", source, "-o", baked, "--quality", "medium", "--texels-per-metre", "24", "--atlas-size", "256", "--instances", mode, "--profile", profile,
                    "-q"], check=True, timeout=300)
    if profile == "mx":
        os.remove(baked + ".lightmaps.json")  # it leads the reader to the float pages
    read = Scene(baked)
    maps = Lightmaps(read, baked)
    noise = np.random.default_rng(7)
    triangle = noise.choice(len(read.areas), POINTS, p=read.areas / read.areas.sum())
    weights = noise.dirichlet([2, 2, 2], POINTS)
    points = np.einsum("nk,nkc->nc", weights, read.corners[triangle])
    truth = expected(points, read.flat[triangle])
    found = maps.sample(triangle, weights).mean(1)
    lit = truth > 2
    error = np.abs(found - truth)[lit] / truth[lit]
    median, p95, dark = np.median(error), np.quantile(error, 0.95), np.abs(found[truth == 0]).max()
    document = read.document.json
    numbers = [n["mesh"] for n in document["nodes"] if "mesh" in n]
    meshes = [document["meshes"][number] for number in numbers]
    arrays = {json.dumps(m["primitives"][0]["attributes"], sort_keys=True) for m in meshes}
    print(f"{name}: {len(meshes)} nodes with {len(set(numbers))} meshes, {len(arrays)} geometries, error median {100 * median:.2f} %, 95 % {100 * p95:.1f} %, "
          f"in the dark at most {dark:.2f} lx; {len(read.areas)} triangles")
    # One texel across the smallest copy is a few per cent of its size: bilinear light of a curved function is off by less than that.
    good = median < 0.005 and p95 < 0.03 and len(read.areas) == len(SCALES) * 6
    if profile == "mx":
        good = good and len(set(numbers)) == len(arrays) and len(document["materials"]) == 1 and all("picture" in source for source in maps.sources)
    return good and (len(arrays) == 1) == (mode == "share") and (len(meshes) == 1) == (by_attributes and mode == "share")


def main():
    use_reference_python()
    luxel = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory(prefix="luxel-copies-") as folder:
        results = [check(luxel, by_attributes, mode, profile, folder) for by_attributes in (False, True) for mode in ("share", "split")
                   for profile in ("three", "mx")]
    sys.exit(0 if all(results) else 1)


if __name__ == "__main__":
    main()
