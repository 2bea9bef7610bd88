"""Imports a baked model into Blender, and compares what its meshes then have with the file. Runs in the Python with bpy.

usage: blender_check.py BAKED.glb

Compared, over all meshes that nodes of the file show: each triangle's positions and two UV sets, corner by corner, as a multiset
(Blender merges primitives). Blender has Z up and v upwards: (x, y, z) is (x, -z, y) there, and v is 1 - v.
Prints JSON: { triangles, with_both_sets, missing, extra, layers }.
"""
import collections
import json
import os
import struct
import sys

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import gltf_file  # noqa: E402


def as_float32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def file_triangles(path):
    """{corners: how many}; corners: 3 times (x, y, z, u0, v0, u1, v1) in Blender's axes."""
    file = gltf_file.GltfFile(path)
    found = collections.Counter()
    for mesh in {node["mesh"] for node in file.items("nodes") if "mesh" in node}:
        for primitive in file.items("meshes")[mesh]["primitives"]:
            if "TEXCOORD_1" not in primitive["attributes"]:
                continue
            arrays = (file.numbers(primitive["attributes"][name]) for name in ("POSITION", "TEXCOORD_0", "TEXCOORD_1"))
            corners = [(x, -z, y, u0, as_float32(1 - v0), u1, as_float32(1 - v1)) for (x, y, z), (u0, v0), (u1, v1) in zip(*arrays)]
            of = file.triangles(primitive)
            found.update(tuple(corners[i] for i in of[at:at + 3]) for at in range(0, len(of), 3))
    return found


def blender_triangles(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)
    found, layers = collections.Counter(), collections.Counter()
    for mesh in {item.data for item in bpy.data.objects if item.type == "MESH"}:
        layers[len(mesh.uv_layers)] += 1
        if len(mesh.uv_layers) < 2:
            continue
        loops = len(mesh.loops)
        place, corner = numpy.empty(len(mesh.vertices) * 3, "f"), numpy.empty(loops, "i")
        mesh.vertices.foreach_get("co", place)
        mesh.loops.foreach_get("vertex_index", corner)
        columns = [place.reshape(-1, 3)[corner]]
        for layer in mesh.uv_layers[:2]:
            uv = numpy.empty(loops * 2, "f")
            layer.uv.foreach_get("vector", uv)
            columns.append(uv.reshape(-1, 2))
        rows = [tuple(row) for row in numpy.hstack(columns).tolist()]
        found.update(tuple(rows[at:at + 3]) for at in range(0, loops, 3))
    return found, layers


def main():
    path = sys.argv[1]
    before = file_triangles(path)
    after, layers = blender_triangles(path)
    print(json.dumps({"triangles": sum(before.values()), "with_both_sets": sum(after.values()), "missing": sum((before - after).values()),
                      "extra": sum((after - before).values()), "layers": layers}))


if __name__ == "__main__":
    main()
