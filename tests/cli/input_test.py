"""Files that are given to the program and are no scene, or a broken one: what it says of them.

usage: input_test.py LUXEL [unittest arguments]
"""
import json
import os
import shutil
import struct
import sys
import unittest

import cli_test
from cli_test import BAD_INPUT, Case, read


class Input(Case):
    def test_missing(self):
        self.assert_refused(self.bake(source=self.path("nothing.glb")), BAD_INPUT, "nothing.glb")

    def test_folder(self):
        self.assert_refused(self.bake(source=self.folder), BAD_INPUT)

    def test_not_gltf(self):
        for name, content in (("text.gltf", b"hello"), ("text.glb", b"hello"), ("list.gltf", b"[]"), ("empty.gltf", b""),
                              ("deep.gltf", b"[" * 100000), ("nul.gltf", b"\0" * 100)):
            with self.subTest(name):
                with open(self.path(name), "wb") as file:
                    file.write(content)
                self.assert_refused(self.bake(source=self.path(name)), BAD_INPUT, name)

    def test_truncated_glb(self):
        whole = self.path("whole.glb")
        self.assert_done(self.bake(output=whole))
        content = read(whole)
        json_length = struct.unpack_from("<I", content, 12)[0]
        for length in (0, 3, 11, 12, 16, 20, 21, 20 + json_length // 2, 20 + json_length, 20 + json_length + 4,
                       20 + json_length + 8, len(content) // 2, len(content) - 1):
            with self.subTest(length):
                with open(self.path("cut.glb"), "wb") as file:
                    file.write(content[:length])
                self.assert_refused(self.bake(source=self.path("cut.glb")), BAD_INPUT, "cut.glb")

    def test_wrong_accessors(self):
        def change(index, **members):
            return lambda document: document["accessors"][index].update(members)

        def primitive(**members):
            return lambda document: document["meshes"][0]["primitives"][0].update(members)

        for name, edit in {
                "more elements than the view has": change(0, count=5000),
                "count of zero": change(0, count=0), "negative count": change(0, count=-1), "huge count": change(0, count=1 << 62),
                "no such view": change(0, bufferView=99), "no such component": change(0, componentType=7777),
                "positions of two numbers": change(0, type="VEC2"), "no such type": change(0, type="VEC9"),
                "offset beyond the view": change(0, byteOffset=40), "offset not aligned": change(1, byteOffset=1),
                "indices of floats": change(1, componentType=5126), "text as count": change(0, count="four"),
                "no such accessor": primitive(attributes={"POSITION": 99}), "no such indices": primitive(indices=99),
                "no positions at all": primitive(attributes={}), "no such material": primitive(material=99),
                "mode that does not exist": primitive(mode=9)}.items():
            with self.subTest(name):
                source = self.scene(edit)
                result = self.bake(source=source)
                if result.returncode == 0:
                    # What glTF lets a reader skip may be left out, with a word about it.
                    self.assertIn(name, ("no positions at all", "count of zero", "offset not aligned", "no such material",
                                         "mode that does not exist"))
                    self.assertIn("luxel: warning:", result.stderr)
                    shutil.rmtree(self.out)
                    continue
                self.assert_refused(result, BAD_INPUT, "scene.gltf")

    def test_index_beyond_the_vertices(self):
        source = self.scene(lambda document: None)
        with open(self.path("furnace.bin"), "r+b") as file:
            file.seek(48)
            file.write(struct.pack("<H", 60000))
        self.assert_refused(self.bake(source=source), BAD_INPUT, "scene.gltf")

    def test_external_buffer(self):
        source = self.scene(lambda document: None, buffer=False)
        self.assert_refused(self.bake(source=source), BAD_INPUT, "furnace.bin")
        with open(self.path("furnace.bin"), "wb") as file:
            file.write(b"\0" * 20)
        self.assert_refused(self.bake(source=source), BAD_INPUT, "360 bytes, found 20")

    def test_numbers_that_cannot_be(self):
        """By default a warning that names material, property and value; with --bad-values refuse that is the error."""
        def colour(*values):
            return lambda document: document["materials"][0]["pbrMetallicRoughness"].update(baseColorFactor=[*values, 1])

        def strength(value, factor=(1, 1, 1)):
            def edit(document):
                document["materials"][0]["emissiveFactor"] = list(factor)
                document["materials"][0]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = value
            return edit

        for words, edit in {"baseColorFactor is (1.5, 0.5, 0.5), expected 0 to 1": colour(1.5, 0.5, 0.5),
                            "baseColorFactor is (-0.25, 0, 0), expected 0 to 1": colour(-0.25, 0, 0),
                            "emissiveStrength is (-1, -1, -1), expected 0 to 1e+30": strength(-1),
                            "emissiveStrength is (1e+31, 0, 0), expected 0 to 1e+30": strength(1e31, (1, 0, 0)),
                            "emissiveStrength is (inf, 1e+300, 0), expected 0 to 1e+30": strength(1e300, (1e300, 1, 0))}.items():
            with self.subTest(words):
                # A wall is missing: a colour that is clamped to 1 is no room without an end of light.
                source = self.scene(lambda document: (edit(document), document["scenes"][0].update(nodes=[0, 1, 2, 3, 4])))
                refused = self.bake("--bad-values", "refuse", source=source)
                self.assert_refused(refused, BAD_INPUT, "scene.gltf", 'material "glow"', words)
                result = self.bake(source=source)
                self.assert_done(result)
                self.assertIn('luxel: warning: material "glow": ', result.stderr)
                self.assertIn(words, result.stderr)
                shutil.rmtree(self.out)
        # JSON has no infinity: what is too long for a number is no JSON that can be read.
        source = self.scene(strength(12345.5))
        with open(source, encoding="utf-8") as file:
            text = file.read().replace("12345.5", "1e999")
        with open(source, "w", encoding="utf-8") as file:
            file.write(text)
        self.assert_refused(self.bake(source=source), BAD_INPUT, "scene.gltf", "1e999")

    def test_light_that_never_ends(self):
        source = self.scene(lambda document: document["materials"][0]["pbrMetallicRoughness"].update(baseColorFactor=[1, 1, 1, 1]))
        self.assert_refused(self.bake(source=source), BAD_INPUT, "scene.gltf", 'material "glow"', "the light never ends")

    def test_settings_of_nodes(self):
        def settings(text):
            with open(self.path("luxel.json"), "w", encoding="utf-8") as file:
                file.write(text)
            return self.path("luxel.json")

        for text, words in (("{", "not valid JSON"), ('{"node": []}', "node: unknown"),
                            ('{"nodes": [{"match": "wall*"}, {"match": "wall*", "lightmap": 0}]}', "nodes[1]: lightmap: expected true or false"),
                            ('{"nodes": [{"match": "wall*", "texels": 8}]}', "texels: unknown"),
                            ('{"nodes": [{"match": "chair"}]}', '"chair" matches no node'),
                            ('{"nodes": [{"match": "*", "receive": false}]}', "no node has a lightmap")):
            with self.subTest(text):
                # The last is a fault of both files, and named by the scene.
                self.assert_refused(self.bake("--settings", settings(text)), BAD_INPUT, words)
        self.assert_refused(self.bake("--settings", self.path("gone.json")), BAD_INPUT, "gone.json")
        self.assert_done(self.bake("--settings", settings('{"nodes": [{"match": "/wall_plus_y", "lightmap": false}, {"match": "chair", "optional": true}]}')))

    def test_many_warnings_of_a_kind(self):
        for count, lines, more in ((4, 4, None), (5, 3, "2 more of this kind")):
            def flatten(document, count=count):
                for node in document["nodes"][:count]:
                    node["scale"] = [0, 0, 0]
            done = self.bake("--report", self.path("report.json"), source=self.scene(flatten))
            self.assert_done(done)
            said = [line for line in done.stderr.splitlines() if "[dropped-triangles]" in line]
            self.assertEqual(len([line for line in said if "without area" in line]), lines, done.stderr)
            self.assertEqual([line.split(": ")[2].split(";")[0] for line in said if "without area" not in line], [more] if more else [])
            with open(self.path("report.json"), encoding="utf-8") as file:
                self.assertEqual(len([w for w in json.load(file)["warnings"] if w["code"] == "dropped-triangles"]), count)

    def test_nothing_to_bake(self):
        source = self.scene(lambda document: document["scenes"][0].update(nodes=[]))
        self.assert_refused(self.bake(source=source), BAD_INPUT, "no triangle")


if __name__ == "__main__":
    cli_test.LUXEL = os.path.abspath(sys.argv.pop(1))
    unittest.main()
