"""The sample scenes in the repository are what make_samples.py writes, and keep the promises of their README."""
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import unittest

SAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "samples")


def triangles(name, folder=SAMPLES):
    """World triangles of a sample: (node name, corners). Turns about Y, scale and translation only, as samples have."""
    with open(os.path.join(folder, name, name + ".gltf"), encoding="utf-8") as file:
        document = json.load(file)
    with open(os.path.join(folder, name, name + ".bin"), "rb") as file:
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


def sideways_area(faces):
    """x and z of the sum of all area vectors, m2: nothing for a closed surface. What rests on floors, ceilings or other
    pieces has no face there, so y is no test."""
    vector = [0.0, 0.0, 0.0]
    for _, (a, b, c) in faces:
        u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
        for k in range(3):
            vector[k] += (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]) / 2
    return vector[0], vector[2]


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
                for area in sideways_area(triangles(name)):
                    self.assertAlmostEqual(area, 0, places=2)

    def test_sizes(self):
        self.assertEqual(len(triangles("cornell_box")), 38)
        self.assertEqual(len(triangles("sphere")), 1280)
        self.assertLess(len(triangles("corridor_16")), 10000)
        self.assertGreater(len(triangles("corridor_64")), 3 * len(triangles("corridor_16")))


class SolverScenes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        subprocess.run([sys.executable, os.path.join(SAMPLES, "make_samples.py"), "--solver-scenes", "--out", cls.folder.name],
                       check=True, stdout=subprocess.DEVNULL)
        cls.scenes = {name: triangles(name, cls.folder.name) for name in sorted(os.listdir(cls.folder.name))}

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_all_are_written_and_closed(self):
        self.assertEqual(list(self.scenes), ["open_plan", "rooms_100", "rooms_36", "rooms_4", "rooms_64"])
        for name, faces in self.scenes.items():
            with self.subTest(name):
                for area in sideways_area(faces):
                    self.assertAlmostEqual(area, 0, places=2)

    def test_lamps_are_where_the_names_say(self):
        lit = {name: {n for n, _ in faces if n.endswith("lamp_panel")} for name, faces in self.scenes.items()}
        self.assertEqual(lit["rooms_4"], {"room_0_0_lamp_panel"})
        self.assertEqual(lit["rooms_64"], {"room_0_0_lamp_panel"})
        self.assertEqual(lit["rooms_100"], {"room_5_5_lamp_panel"})
        self.assertEqual(len(lit["rooms_36"]), 36)
        self.assertEqual(len(lit["open_plan"]), 8)

    def test_the_open_plan_is_one_hall_of_pieces_apart(self):
        faces = self.scenes["open_plan"]
        self.assertAlmostEqual(signed_volume([f for f in faces if f[0].startswith("hall_")]), -24 * 2.7 * 15, places=3)
        circles = []   # around each piece and each lamp, seen from above
        for name in sorted({n for n, _ in faces if not n.startswith("hall_") and not n.endswith("lamp_panel")}):
            piece = [f for f in faces if f[0] == name]
            points = [p for _, corners in piece for p in corners]
            centre = [(min(p[k] for p in points) + max(p[k] for p in points)) / 2 for k in (0, 2)]
            top = max(p[1] for p in points)
            if not name.endswith("lamp_housing"):
                self.assertGreater(signed_volume(piece), 0, name)
                self.assertEqual(min(p[1] for p in points), 0, name)
            self.assertLess(top, 2.7 + 1e-6, name)
            circles.append((centre, max(math.dist(centre, (p[0], p[2])) for p in points), name, top))
        self.assertEqual(len([c for c in circles if not c[2].endswith("lamp_housing")]), 60)
        for n, (centre, radius, name, top) in enumerate(circles):
            for other, reach, other_name, other_top in circles[:n]:
                if "lamp" in name + other_name and min(top, other_top) < 2.0:
                    continue   # a lamp hangs above the lower pieces
                self.assertGreater(math.dist(centre, other), radius + reach, f"{name} and {other_name}")


if __name__ == "__main__":
    unittest.main()
