#!/usr/bin/env python3
"""The comparison of kept.py notices damage: a baked model is harmed in one place at a time, and each time there must be a line.

usage: kept_mutations_test.py LUXEL
"""
import copy
import os
import struct
import sys
import tempfile
import unittest

import everything
import gltf_file
import kept
import kept_test
import scenes

LUXEL = None


def primitive_of(document, name, index=0):
    """A primitive of the mesh that the node of this name shows."""
    node = next(item for item in document["nodes"] if item.get("name") == name)
    return document["meshes"][node["mesh"]]["primitives"][index]


def drop(*path):
    def harm(document, _):
        for key in path[:-1]:
            document = document[key]
        del document[path[-1]]
    return harm


def put(value, *path):
    def harm(document, _):
        for key in path[:-1]:
            document = document[key]
        document[path[-1]] = value
    return harm


def flip_bit(accessor_of):
    """Of the last byte of an array."""
    def harm(document, body):
        accessor = document["accessors"][accessor_of(document)]
        view = document["bufferViews"][accessor["bufferView"]]
        rows, columns = gltf_file.SHAPES[accessor["type"]]
        size = rows * columns * gltf_file.COMPONENT_BYTES[accessor["componentType"]]
        stride = view.get("byteStride", size)
        body[view["byteOffset"] + accessor.get("byteOffset", 0) + (accessor["count"] - 1) * stride + size - 1] ^= 0x10
    return harm


def attribute(name):
    return flip_bit(lambda document: primitive_of(document, "same name")["attributes"][name])


def picture_byte(document, body):
    view = document["bufferViews"][document["images"][0]["bufferView"]]
    body[view["byteOffset"] + view["byteLength"] - 20] ^= 1


def other_type(document, _):
    document["accessors"][primitive_of(document, "same name")["attributes"]["COLOR_0"]]["normalized"] = False


def turned(document, body):
    """Two corners of one triangle swapped."""
    accessor = document["accessors"][primitive_of(document, "same name")["indices"]]
    at = document["bufferViews"][accessor["bufferView"]]["byteOffset"]
    body[at:at + 2], body[at + 2:at + 4] = body[at + 2:at + 4], body[at:at + 2]


def shorter(document, _):
    document["accessors"][primitive_of(document, "same name")["indices"]]["count"] -= 3


HARM = {
    "a node's name": put("other", "nodes", 1, "name"), "the order of children": put([2, 1, 3, 5, 6, 7], "nodes", 0, "children"),
    "a node": drop("nodes", 7), "extras": drop("nodes", 0, "extras"), "deep extras": put(2, "nodes", 0, "extras", "list", 5, "deep", "texCoord"),
    "a number": put(0.1000001, "extras", "third"), "true for 1": put(True, "extras", "list", 0), "an unknown member": drop("unknownMember"),
    "an unknown extension": drop("scenes", 0, "extensions"), "its array": put(0, "extensions", "ACME_counted", "accessor"),
    "the default scene": drop("scene"), "a camera": put(0.8, "cameras", 0, "perspective", "yfov"),
    "a lamp": put(21, "extensions", "KHR_lights_punctual", "lights", 0, "intensity"),
    "a material that nobody uses": drop("materials", 3, "normalTexture"), "the first material": put("x", "materials", 0, "name"),
    "a sampler": put(9729, "samplers", 0, "magFilter"), "a texture": put(1, "textures", 0, "source"), "a picture": picture_byte,
    "a picture's name": put("x", "images", 0, "name"), "an animation": drop("animations", 0, "channels", 3),
    "its keys": flip_bit(lambda document: document["animations"][0]["samplers"][0]["output"]),
    "how they are interpolated": drop("animations", 0, "samplers", 2, "interpolation"), "a joint": put([5], "skins", 0, "joints"),
    "the bind matrices": flip_bit(lambda document: document["skins"][0]["inverseBindMatrices"]), "weights of a node": drop("nodes", 1, "weights"),
    "weights of a mesh": lambda document, _: document["meshes"][document["nodes"][1]["mesh"]].pop("weights"),
    "variants": lambda document, _: primitive_of(document, "same name")["extensions"].pop("KHR_materials_variants"),
    "a morph target": lambda document, _: primitive_of(document, "same name")["targets"].pop(),
    "its values": flip_bit(lambda document: primitive_of(document, "same name")["targets"][0]["POSITION"]),
    "a primitive": lambda document, _: document["meshes"][document["nodes"][3]["mesh"]]["primitives"].pop(),
    "the winding": turned, "a triangle": shorter, "what a colour is": other_type,
    "copyright": drop("asset", "copyright"), "extras of the asset": drop("asset", "extras", "kept"),
    **{f"values of {name}": attribute(name) for name in ("POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_2", "TEXCOORD_3", "COLOR_0",
                                                         "JOINTS_0", "WEIGHTS_0", "_TEMPERATURE", "_ID")},
}


def node_lightmap(document):
    return next(node for node in document["nodes"] if node.get("name") == "same name")["extensions"]["MX_lightmap"]


HARM_OF_NODES = {
    "a node's lightmap": lambda document, _: next(n for n in document["nodes"] if n.get("name") == "same name")["extensions"].pop("MX_lightmap"),
    "its place": lambda document, _: node_lightmap(document).update(offset=[0.9, 0], scale=[0.2, 0.1]),
    "its intensity": lambda document, _: node_lightmap(document).update(intensity=0),
    "its page": lambda document, _: node_lightmap(document)["lightMapTexture"].update(index=0),
    "the second set of a primitive": lambda document, _: primitive_of(document, "same name")["attributes"].pop("TEXCOORD_1"),
}


class Mutations(unittest.TestCase):
    ARGUMENTS, HARM = (), HARM

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="luxel-mutations-")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.before = gltf_file.GltfFile(everything.write(cls.folder.name))
        baked = os.path.join(cls.folder.name, "baked.glb")
        scenes.bake(LUXEL, cls.before.path, baked, *cls.ARGUMENTS)
        cls.baked = gltf_file.GltfFile(baked)

    def lines(self, harm):
        document, body = copy.deepcopy(self.baked.json), bytearray(self.baked.body)
        harm(document, body)
        path = os.path.join(self.folder.name, "harmed.glb")
        gltf_file.write_glb(path, document, bytes(body))
        return kept.differences(self.before, self.before, gltf_file.GltfFile(path))

    def test_unharmed(self):
        self.assertEqual(self.lines(lambda document, body: None), [])

    def test_every_harm_is_noticed(self):
        for name, harm in self.HARM.items():
            with self.subTest(name):
                self.assertTrue(self.lines(harm), "nothing was noticed")


class MutationsOfNodes(Mutations):
    """Where nodes name the lightmaps."""
    ARGUMENTS, HARM = ("--profile", "mx"), {**HARM, **HARM_OF_NODES}


def first_array(name):
    """The accessor of a mesh that Draco held."""
    def find(document):
        primitive = next(p for mesh in document["meshes"] for p in mesh["primitives"] if kept.DRACO in p.get("extensions", {}))
        return primitive["indices"] if name == "indices" else primitive["attributes"][name]
    return find


def start_of(document, name):
    accessor = document["accessors"][first_array(name)(document)]
    return document["bufferViews"][accessor["bufferView"]]["byteOffset"] + accessor.get("byteOffset", 0)


def moved_place(document, body):
    """A corner of the sphere, of radius 1, by 3 of the 16,383 steps across it."""
    at = start_of(document, "POSITION")
    value, = struct.unpack_from("<f", body, at)
    struct.pack_into("<f", body, at, value + 3 * 2 / 16383)


def swapped_places(document, body):
    """Of two vertices: all numbers are there, but elsewhere."""
    at = start_of(document, "POSITION")
    body[at:at + 12], body[at + 600:at + 612] = body[at + 600:at + 612], body[at:at + 12]


def turned_draco(document, body):
    at, size = start_of(document, "indices"), gltf_file.COMPONENT_BYTES[document["accessors"][first_array("indices")(document)]["componentType"]]
    body[at:at + size], body[at + size:at + 2 * size] = body[at + size:at + 2 * size], body[at:at + size]


def shorter_draco(document, _):
    document["accessors"][first_array("indices")(document)]["count"] -= 3


@unittest.skipUnless(scenes.has_modules(), "Node or its packages are missing: tools/setup.sh consumers")
class MutationsOfDraco(unittest.TestCase):
    """What Draco has rounded and put into another order: less than its rounding is not noticed, all else is."""
    HARM = {"a place": moved_place, "two places": swapped_places, "the winding": turned_draco, "a triangle": shorter_draco}

    def test_every_harm_is_noticed(self):
        before = gltf_file.GltfFile(os.path.join(scenes.ROOT, "samples", "sphere", "sphere.gltf"))
        with tempfile.TemporaryDirectory(prefix="luxel-mutations-") as folder:
            baked, harmed = os.path.join(folder, "baked.glb"), os.path.join(folder, "harmed.glb")
            scenes.bake(LUXEL, before.path, baked, "--draco")
            plain = kept_test.unpacked(baked, folder)
            for name, harm in {"nothing": lambda document, body: None, **self.HARM}.items():
                document, body = copy.deepcopy(plain.json), bytearray(plain.body)
                harm(document, body)
                gltf_file.write_glb(harmed, document, bytes(body))
                lines = kept.differences(before, before, gltf_file.GltfFile(harmed), is_packed=True)
                with self.subTest(name):
                    self.assertEqual(bool(lines), name != "nothing", lines)


if __name__ == "__main__":
    LUXEL = sys.argv.pop(1)
    unittest.main()
