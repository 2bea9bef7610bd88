"""A small model with a bit of everything that glTF allows, for seeing whether all of it is kept. Standard library only.

Two scenes, four kinds of primitives, a mesh that three nodes show (one of them in the other scene), one that a node shows many times, two UV sets that textures
use, an unlit third one, skins, morph targets, all kinds of animation samplers, cameras, lamps, variants, sparse arrays,
interleaved arrays, quantised arrays, custom attributes, matrices with padded columns, pictures in a view, in a data URI and in
a file (its name needs escapes), extensions and members that nobody knows, on every kind of object, one of them with an array
of its own, and extras everywhere.
"""
import base64
import json
import os
import struct
import zlib

FLOAT, U32, U16, U8, I16, I8 = 5126, 5125, 5123, 5121, 5122, 5120
LETTER = {FLOAT: "f", U32: "I", U16: "H", U8: "B", I16: "h", I8: "b"}
WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT4": 16}


def odd(number):
    """Extras and members that no specification names; numbers that a careless writer would change."""
    return {"extras": {"number": number, "list": [1, 2.5, None, True, "\u00e4\n\"", {"deep": {"texCoord": 1}}], "tiny": 1e-300,
                       "third": 0.1, "big": 9007199254740993, "negative": -0.0},
            "unknownMember": {"kept": number}, "extensions": {"ACME_unknown": {"note": f"number {number}", "flag": True}}}


def png(red, green, blue):
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
    pixels = b"".join(b"\0" + bytes((red, green, blue)) * 4 for _ in range(4))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 4, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(pixels)) + chunk(b"tEXt", b"Comment\0kept byte for byte") + chunk(b"IEND", b""))


class Writer:
    def __init__(self):
        self.body, self.views, self.accessors = bytearray(), [], []

    def view(self, content, **members):
        self.body += bytes(-len(self.body) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.body), "byteLength": len(content), **members})
        self.body += content
        return len(self.views) - 1

    def array(self, kind, component, values, **members):
        """One number after the other; matrices of bytes get padded columns by the caller."""
        view = self.view(struct.pack(f"<{len(values)}{LETTER[component]}", *values))
        return self.accessor(kind, component, len(values) // WIDTH[kind], bufferView=view, **members)

    def points(self, values, **members):
        low, high = ([f([*values[axis::3]]) for axis in range(3)] for f in (min, max))
        return self.array("VEC3", FLOAT, values, min=low, max=high, **members)

    def accessor(self, kind, component, count, **members):
        self.accessors.append({"componentType": component, "type": kind, "count": count, **members})
        return len(self.accessors) - 1


SQUARE = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]
UV = [0, 0, 1, 0, 1, 1, 0, 1]


def rich_primitive(w):
    """A square with every attribute, two morph targets and variants."""
    tangents = w.array("VEC4", FLOAT, [1, 0, 0, 1] * 4)
    normals = w.array("VEC3", I8, [0, 0, 127, 0] * 4)  # columns of 3 bytes, 4 apart
    w.accessors[normals].update(count=4, normalized=True)
    w.views[w.accessors[normals]["bufferView"]]["byteStride"] = 4
    shift = w.accessor("VEC3", FLOAT, 4, sparse={
        "count": 1, "indices": {"bufferView": w.view(struct.pack("<H", 2)), "componentType": U16},
        "values": {"bufferView": w.view(struct.pack("<3f", 0, 0, 0.25))}}, min=[0, 0, 0], max=[0, 0, 0.25])
    return {
        "attributes": {
            "POSITION": w.points(SQUARE, name="corners", **odd(1)), "NORMAL": normals, "TANGENT": tangents,
            "TEXCOORD_0": w.array("VEC2", U16, [0, 0, 65535, 0, 65535, 65535, 0, 65535], normalized=True),
            "TEXCOORD_1": w.array("VEC2", FLOAT, [v * 0.5 for v in UV], name="old second set"),
            "TEXCOORD_2": w.array("VEC2", FLOAT, [v * 0.25 for v in UV]),
            "COLOR_0": w.array("VEC4", U8, list(range(200, 216)), normalized=True),
            "JOINTS_0": w.array("VEC4", U8, [0, 1, 0, 0] * 4), "WEIGHTS_0": w.array("VEC4", FLOAT, [0.75, 0.25, 0, 0] * 4),
            "_TEMPERATURE": w.array("SCALAR", FLOAT, [20.5, 21, 21.5, 22]), "_ID": w.array("VEC2", U16, list(range(8)))},
        "indices": w.array("SCALAR", U8, [0, 1, 2, 0, 2, 3], name="faces"), "material": 1,
        "targets": [{"POSITION": shift}, {"POSITION": w.points([0, 0, 0.5] * 4), "NORMAL": w.array("VEC3", FLOAT, [0, 0, 0.5] * 4)}],
        "extensions": {"KHR_materials_variants": {"mappings": [{"material": 2, "variants": [0], "name": "old"},
                                                               {"material": 1, "variants": [1]}]},
                       "ACME_unknown": {"note": "of a primitive"}},
        "extras": {"primitive": "rich"}, "unknownMember": 3}


def plain_primitives(w):
    """A strip, a fan, triangles without indices, lines and points; interleaved positions and coordinates."""
    both = b"".join(struct.pack("<5f", *SQUARE[3 * i:3 * i + 3], *UV[2 * i:2 * i + 2]) for i in (0, 1, 3, 2))
    view = w.view(both, byteStride=20)
    strip = {"POSITION": w.accessor("VEC3", FLOAT, 4, bufferView=view, min=[0, 0, 0], max=[1, 1, 0]),
             "TEXCOORD_0": w.accessor("VEC2", FLOAT, 4, bufferView=view, byteOffset=12)}
    square = w.points(SQUARE)
    soup = w.points([0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1])
    line = w.points([0, 0, 0, 1, 1, 1])
    return [{"attributes": strip, "mode": 5, "material": 2}, {"attributes": {"POSITION": square}, "mode": 6},
            {"attributes": {"POSITION": soup}, "material": 0}, {"attributes": {"POSITION": line}, "mode": 1, "extras": {"kind": "line"}},
            {"attributes": {"POSITION": line}, "mode": 0, "material": 0}]


def crowd(w):
    """A node that shows a mesh many times: turned, mirrored, of two sizes, with an attribute of somebody else."""
    count = 60
    places = [number for k in range(count) for number in (float(k % 10), 5.0, 2.0 * (k // 10))]
    sizes = [number for k in range(count) for number in ((-1, 1, 1), (0.5, 0.5, 0.5), (1, 1, 1))[k % 3]]
    return {"name": "crowd", "mesh": 3, "extras": {"of": "many"}, "extensions": {"ACME_unknown": {"note": "of a node"}, "EXT_mesh_gpu_instancing": {
        "attributes": {"TRANSLATION": w.array("VEC3", FLOAT, places), "ROTATION": w.array("VEC4", I16, [0, 23170, 0, 23170] * count, normalized=True),
                       "SCALE": w.array("VEC3", FLOAT, sizes), "_KIND": w.array("SCALAR", U16, list(range(count)), name="kinds")},
        "extras": {"kept": True}}}}


def animations(w):
    times = w.array("SCALAR", FLOAT, [0, 0.5, 1], min=[0], max=[1])
    samplers = [
        {"input": times, "output": w.array("VEC3", FLOAT, [0, 0, 0, 0, 1, 0, 0, 0, 0]), "interpolation": "LINEAR"},
        {"input": times, "output": w.array("VEC4", I16, [0, 0, 0, 32767] * 3, normalized=True), "interpolation": "STEP", "extras": {"step": 1}},
        {"input": times, "output": w.array("VEC3", FLOAT, [1] * 27), "interpolation": "CUBICSPLINE"},
        {"input": times, "output": w.array("SCALAR", U8, [0, 255, 127, 0, 255, 255], normalized=True)}]
    paths = ("translation", "rotation", "scale", "weights")
    return [{"name": "wave", "samplers": samplers, **odd(2),
             "channels": [{"sampler": i, "target": {"node": 2, "path": path, "extras": {"i": i}}} for i, path in enumerate(paths)]}]


def materials():
    def texture(index, **members):
        return {"index": index, **members}
    return [
        {"name": "plain"},
        {"name": "both sets", **odd(3), "doubleSided": True, "alphaMode": "MASK", "alphaCutoff": 0.25,
         "pbrMetallicRoughness": {"baseColorTexture": texture(0, extensions={"KHR_texture_transform": {"scale": [2, 2], "texCoord": 1}}),
                                  "baseColorFactor": [0.1, 0.2, 0.3, 1], "metallicFactor": 0, "extras": {"pbr": 1}},
         "occlusionTexture": texture(1, texCoord=1, strength=0.5), "emissiveTexture": texture(2, texCoord=2), "emissiveFactor": [1, 0.5, 0.25]},
        {"name": "glow", "emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 5}}},
        {"name": "unused", "normalTexture": texture(1, scale=0.5), "extensions": {"KHR_materials_unlit": {}}},
    ]


def write(folder):
    """Writes everything.gltf with its files; returns its path."""
    os.makedirs(folder, exist_ok=True)
    w = Writer()
    rich, plain = rich_primitive(w), plain_primitives(w)
    moving = animations(w)
    bind = w.array("MAT4", FLOAT, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] * 2)
    secret = w.array("MAT2", U8, [1, 2, 0, 0, 3, 4, 0, 0], name="only an unknown extension names this")
    w.accessors[secret]["count"] = 1
    picture = w.view(png(200, 10, 10))
    with open(os.path.join(folder, "blue picture.png"), "wb") as file:
        file.write(png(10, 10, 200))
    document = {
        "asset": {"version": "2.0", "generator": "everything.py", "copyright": "none", "extras": {"kept": [1, 2]},
                  "extensions": {"ACME_unknown": {}}},
        "scene": 1, **odd(0),
        "scenes": [{"name": "other", "nodes": [4], **odd(4)}, {"name": "main", "nodes": [0]}],
        "nodes": [
            {"name": "root", "children": [1, 2, 3, 5, 6, 7, 8], **odd(5)},
            {"name": "same name", "mesh": 0, "weights": [0.5, 0], "translation": [0, 0, 2]},
            {"name": "same name", "mesh": 0, "skin": 0, "rotation": [0, 0, 0, 1], "scale": [1, 1, 1], "translation": [2, 0, 0]},
            {"mesh": 1, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 3, 0, 1], "extras": {"luxel": {"unknown": "to luxel"}}},
            {"name": "elsewhere", "mesh": 0}, {"name": "eye", "camera": 0, "translation": [0, 0, 5]},
            {"name": "lamp", "extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0.5, 0.5, 4]},
            {"name": "second eye", "camera": 1}, crowd(w)],
        "cameras": [{"name": "wide", "type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1, "extras": {"f": 35}}, **odd(6)},
                    {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 10, "znear": 0}}],
        "meshes": [{"name": "rich", "primitives": [rich], "weights": [0.25, 0.75], **odd(7)}, {"primitives": plain},
                   {"name": "shown by nobody", "primitives": [dict(plain[0])]}, {"name": "one of many", "primitives": [dict(plain[1])]}],
        "skins": [{"name": "bones", "joints": [5, 6], "inverseBindMatrices": bind, "skeleton": 0, **odd(8)}],
        "animations": moving, "materials": materials(),
        "textures": [{"source": 0, "sampler": 0, "name": "red", **odd(9)}, {"source": 1}, {"source": 2, "sampler": 0}],
        "samplers": [{"magFilter": 9728, "minFilter": 9987, "wrapS": 33648, "wrapT": 33071, "name": "mirror", **odd(10)}],
        "images": [{"bufferView": picture, "mimeType": "image/png", "name": "in a view", **odd(11)},
                   {"uri": "data:image/png;base64," + base64.b64encode(png(10, 200, 10)).decode(), "name": "in the text"},
                   {"uri": "blue%20picture.png", "extras": {"outside": True}}],
        "extensionsUsed": ["ACME_unknown", "KHR_materials_variants", "KHR_lights_punctual", "KHR_texture_transform", "KHR_materials_unlit",
                           "KHR_materials_emissive_strength", "KHR_mesh_quantization", "ACME_counted", "EXT_mesh_gpu_instancing"],
        "extensionsRequired": ["KHR_mesh_quantization"], "accessors": w.accessors, "bufferViews": w.views,
        "buffers": [{"byteLength": len(w.body), "uri": "everything.bin", "name": "body"}]}
    document["extensions"].update({
        "KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 20, "name": "bulb", "extras": {"watt": 60}}]},
        "KHR_materials_variants": {"variants": [{"name": "day"}, {"name": "night", "extras": {"dark": True}}]},
        "ACME_counted": {"accessor": secret}})
    with open(os.path.join(folder, "everything.bin"), "wb") as file:
        file.write(w.body)
    path = os.path.join(folder, "everything.gltf")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(document, file, indent=1)
    return path
