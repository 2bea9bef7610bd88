"""Smaller results and results in parts: --draco, --meshopt, --split.

usage: packed_test.py LUXEL [unittest arguments]
"""
import json
import os
import struct
import sys
import unittest

import cli_test
from cli_test import SAMPLES, USAGE, Case, files_below, read

ROOMS = os.path.join(SAMPLES, "corridor_4", "corridor_4.gltf")
SPLIT = ["--split", "chunks", "--chunk-patches", "64"]


def gltf_json(path):
    content = read(path)
    return json.loads(content[20:20 + struct.unpack_from("<I", content, 12)[0]])


class Packed(Case):
    def test_options_that_need_another(self):
        self.assert_refused(self.bake("--draco-bits", "POSITION=12"), USAGE, "--draco-bits", "--draco")
        self.assert_refused(self.bake("--split-triangles", "12"), USAGE, "--split-triangles", "--split")
        for part in ("POSITION=0", "POSITION=25", "NORMAL=1", "HEIGHT=3", "LIGHTMAP=none", ""):
            with self.subTest(part):
                self.assert_refused(self.bake("--draco", "--draco-bits", part), USAGE, "--draco-bits", part.split("=")[0])

    def test_the_result_is_smaller_and_can_be_baked_again(self):
        sizes = {}
        draco, meshopt = "KHR_draco_mesh_compression", "EXT_meshopt_compression"
        # with both, meshopt has nothing left to do in a scene of triangles alone
        for name, options, required in (("plain", [], []), ("draco", ["--draco"], [draco]), ("meshopt", ["--meshopt"], [meshopt]),
                                        ("both", ["--draco", "--meshopt"], [draco])):
            with self.subTest(name):
                output = self.path(name + ".glb")
                self.assert_done(self.bake(*options, source=os.path.join(SAMPLES, "sphere", "sphere.gltf"), output=output))
                sizes[name] = os.path.getsize(output)
                self.assertEqual(gltf_json(output).get("extensionsRequired", []), required)
                self.assert_done(self.bake(source=output, output=self.path(name + ".again.glb")))
        self.assertLess(sizes["meshopt"], sizes["plain"])
        self.assertLess(sizes["draco"], sizes["meshopt"])


class Split(Case):
    def index(self):
        with open(os.path.join(self.out, "scene.chunks.json"), encoding="utf-8") as file:
            return json.load(file)

    def split(self, *options):
        self.assert_done(self.bake(*SPLIT, "--split-triangles", "0", *options, source=ROOMS))
        return self.index()

    def test_index_and_files_agree(self):
        index = self.split("--report", self.path("report.json"))
        self.assertGreater(len(index["chunks"]), 2)
        listed = [index["model"]] + [chunk["uri"] for chunk in index["chunks"]] + index["pictures"]
        listed += [index["common"]["uri"]] if "common" in index else []
        for name in listed:
            self.assertTrue(os.path.isfile(os.path.join(self.out, name)), name)
        others = [name for name in files_below(self.out) if not name.endswith((".exr", ".json"))]
        self.assertEqual(sorted(listed), others, "nothing that the index does not name")
        paths = [path for chunk in index["chunks"] for path in chunk["nodes"]]
        self.assertEqual(len(paths), len(set(paths)))
        whole = gltf_json(self.output)
        shown = sum("mesh" in node for node in whole["nodes"])
        self.assertEqual(len(paths), shown)
        for number, chunk in enumerate(index["chunks"]):
            self.assertEqual(chunk["bytes"], os.path.getsize(os.path.join(self.out, chunk["uri"])))
            document = gltf_json(os.path.join(self.out, chunk["uri"]))
            self.assertEqual(sum("mesh" in node for node in document["nodes"]), len(chunk["nodes"]))
            self.assertEqual(sum(document["accessors"][p["indices"]]["count"] // 3 for m in document["meshes"] for p in m["primitives"]), chunk["triangles"])
            self.assertTrue(all(low <= high for low, high in zip(chunk["min"], chunk["max"])))
            for neighbour in chunk["neighbours"]:
                back = [n["rays"] for n in index["chunks"][neighbour["chunk"]]["neighbours"] if n["chunk"] == number]
                self.assertEqual(back, [neighbour["rays"]], "who sees is seen")
        with open(self.path("report.json"), encoding="utf-8") as file:
            outputs = [os.path.basename(o["path"]) for o in json.load(file)["outputs"]]
        self.assertIn("scene.chunks.json", outputs)
        self.assertIn(index["chunks"][0]["uri"], outputs)

    def test_the_whole_model_does_not_depend_on_it(self):
        self.split()
        whole = read(self.output)
        self.assert_done(self.bake("--chunk-patches", "64", source=ROOMS, output=self.path("plain.glb")))
        self.assertEqual(whole, read(self.path("plain.glb")))

    def test_threads_do_not_decide(self):
        self.split("--threads", "1")
        first = {name: read(os.path.join(self.out, name)) for name in files_below(self.out)}
        self.split("--threads", "2")
        self.assertEqual(first, {name: read(os.path.join(self.out, name)) for name in files_below(self.out)})

    def test_small_parts_join(self):
        many = len(self.split()["chunks"])
        self.assert_done(self.bake(*SPLIT, "--split-triangles", "1000000", source=ROOMS, output=os.path.join(self.folder, "one", "scene.glb")))
        with open(os.path.join(self.folder, "one", "scene.chunks.json"), encoding="utf-8") as file:
            one = json.load(file)
        self.assertEqual(len(one["chunks"]), 1)
        self.assertEqual(one["chunks"][0]["neighbours"], [])
        self.assertGreater(many, 1)


if __name__ == "__main__":
    cli_test.LUXEL = os.path.abspath(sys.argv.pop(1))
    unittest.main()
