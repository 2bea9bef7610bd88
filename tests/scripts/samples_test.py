"""The sample scenes in the repository are what make_samples.py writes, and keep the promises of their README."""
import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest

SAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "samples")


def triangles(name):
    """World triangles of a sample: (node name, corners). Turns about Y, scale and translation only, as samples have."""
    with open(os.path.join(SAMPLES, name, name + ".gltf"), encoding="utf-8") as file:
        document = json.load(file)
    with open(os.path.join(SAMPLES, name, name + ".bin"), "rb") as file:
        blob = file.read()

    def numbers(index, letter):
        accessor = document["accessors"][index]
        width = 3 if accessor["type"] == "VEC3" else 1
        start = document["bufferViews"][accessor["bufferView"]]["byteOffset"]
        return struct.unpack_from(f"<{accessor['count'] * width}{letter}", blob, start)

    out = []
    for node in document["nodes"]:
        if "mesh" not in node:
            continue
        (primitive,) = document["meshes"][node["mesh"]]["primitives"]
        flat = numbers(primitive["attributes"]["POSITION"], "f")
        scale, shift = node.get("scale", (1, 1, 1)), node.get("translation", (0, 0, 0))
        _, s, _, c = node.get("rotation", (0, 0, 0, 1))
        cosine, sine = c * c - s * s, 2 * s * c
        points = []
        for k in range(0, len(flat), 3):
            x, y, z = (flat[k + i] * scale[i] for i in range(3))
            points.append((cosine * x + sine * z + shift[0], y + shift[1], -sine * x + cosine * z + shift[2]))
        wide = document["accessors"][primitive["indices"]]["componentType"] == 5125
        order = numbers(primitive["indices"], "I" if wide else "H")
        mirrored = scale[0] * scale[1] * scale[2] < 0
        for k in range(0, len(order), 3):
            corners = [points[i] for i in order[k:k + 3]]
            out.append((node["name"], corners[::-1] if mirrored else corners))
    return out


def signed_volume(faces):
    return sum(a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
               for _, (a, b, c) in faces) / 6


class Samples(unittest.TestCase):
    def test_files_are_what_the_script_writes(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, os.path.join(SAMPLES, "make_samples.py"), "--out", folder], check=True,
                           stdout=subprocess.DEVNULL)
            for name in sorted(os.listdir(folder)):
                for ending in (".gltf", ".bin"):
                    with self.subTest(name + ending), open(os.path.join(folder, name, name + ending), "rb") as made, \
                            open(os.path.join(SAMPLES, name, name + ending), "rb") as kept:
                        self.assertEqual(made.read(), kept.read())

    def test_cavities_are_closed_and_look_inward(self):
        # closed and seen from inside: the divergence theorem gives minus the volume of the air, wherever the origin is
        self.assertAlmostEqual(signed_volume(triangles("furnace")), -8, places=5)
        self.assertAlmostEqual(signed_volume(triangles("sphere")), -4.18879, delta=0.05)
        air = signed_volume(triangles("two_rooms"))
        # two rooms of 4 x 2.7 x 5, a door of 0.9 x 2.1 x 0.2, less the lamp's housing of 0.7 x 0.06 x 1.3, whose missing top
        # lies in the ceiling at 2.7
        self.assertAlmostEqual(air, -(2 * 54 + 0.378 - 0.0546) - 0.7 * 1.3 * 2.7 / 3, places=3)
        for name in ("two_rooms", "corridor_4", "corridor_16", "corridor_64"):
            with self.subTest(name):
                vector = [0.0, 0.0, 0.0]   # the area vectors of a closed surface add up to nothing
                for _, (a, b, c) in triangles(name):
                    u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
                    for k in range(3):
                        vector[k] += (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]) / 2
                self.assertAlmostEqual(vector[0], 0, places=2)
                self.assertAlmostEqual(vector[2], 0, places=2)

    def test_sizes(self):
        self.assertEqual(len(triangles("cornell_box")), 38)
        self.assertEqual(len(triangles("sphere")), 1280)
        self.assertLess(len(triangles("corridor_16")), 10000)
        self.assertGreater(len(triangles("corridor_64")), 3 * len(triangles("corridor_16")))


if __name__ == "__main__":
    unittest.main()
