"""A table of broken and odd scenes: each is refused with its message, or baked with its warning, quickly and in little memory.

usage: broken_test.py LUXEL [--show] [unittest arguments]

--show  prints what the program says to each
"""
import base64
import copy
import json
import os
import struct
import subprocess
import sys
import tempfile
import threading
import unittest
import zlib

import cli_test
from cli_test import BAD_INPUT, FURNACE, SAMPLES, SMALL, read

FUZZ_CORPUS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "fuzz", "corpus")
LONGEST_S = 30
MOST_EXTRA_MEMORY = 100 << 20   # over what the whole scene takes


def png(width, height, rows=b""):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def data_uri(content, kind="application/octet-stream"):
    return f"data:{kind};base64," + base64.b64encode(content).decode()


class Made:
    """The furnace: its JSON and its buffer, to be broken."""

    def __init__(self):
        with open(FURNACE, encoding="utf-8") as file:
            self.json = json.load(file)
        self.bytes = bytearray(read(os.path.join(SAMPLES, "furnace", "furnace.bin")))
        self.name, self.raw = "scene.gltf", None

    def text(self):
        return json.dumps(self.json).encode()

    def glb(self, body=None, version=2, kinds=(b"JSON", b"BIN\0"), length=None, first_length=None):
        self.json["buffers"][0].pop("uri", None)
        text = self.text() if body is None else body
        text += b" " * (-len(text) % 4)
        chunks = (struct.pack("<I4s", len(text) if first_length is None else first_length, kinds[0]) + text +
                  struct.pack("<I4s", len(self.bytes), kinds[1]) + self.bytes)
        self.name = "scene.glb"
        self.raw = b"glTF" + struct.pack("<II", version, 12 + len(chunks) if length is None else length) + chunks

    def write(self, folder):
        with open(os.path.join(folder, "furnace.bin"), "wb") as file:
            file.write(self.bytes)
        path = os.path.join(folder, self.name)
        with open(path, "wb") as file:
            file.write(self.text() if self.raw is None else self.raw)
        return path

    def floats(self, view, values):
        struct.pack_into(f"<{len(values)}f", self.bytes, self.json["bufferViews"][view]["byteOffset"], *values)

    def texture(self, uri, **image):
        self.json.update(images=[{"uri": uri, **image}], textures=[{"source": 0}])
        self.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}

    def accessor(self, values, code, component, kind):
        """Index of a new one with its own buffer."""
        content = struct.pack(f"<{len(values)}{code}", *values)
        self.json["buffers"].append({"byteLength": len(content), "uri": data_uri(content)})
        self.json["bufferViews"].append({"buffer": len(self.json["buffers"]) - 1, "byteLength": len(content)})
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[kind]
        self.json["accessors"].append({"bufferView": len(self.json["bufferViews"]) - 1, "componentType": component,
                                       "count": len(values) // width, "type": kind})
        return len(self.json["accessors"]) - 1

    def primitive(self):
        return self.json["meshes"][0]["primitives"][0]


NAN, INF, HUGE = float("nan"), float("inf"), 1 << 62
CASES = []


def case(name, *words):
    """words: what the message holds; "warning: ..." means that it is baked."""
    def keep(edit):
        CASES.append((name, edit, words))
    return keep


def edit(name, *words, **members):
    """Changes members of the document's first accessor, buffer ...: accessors__count=5."""
    def change(made):
        for key, value in members.items():
            *way, last = key.split("__")
            place = made.json
            for step in way:
                place = place[int(step) if step.isdigit() else step]
            place[int(last) if last.isdigit() else last] = value
    CASES.append((name, change, words))


# --- the document
edit("no asset", "asset", asset=None)
edit("asset is a list", "asset", asset=[])
edit("version 1", "version", asset__version="1.0")
edit("version 3", "version", asset__version="3.0")
edit("version is a number", "version", asset__version=2)
edit("scenes is an object", "scene", scenes={})
edit("scene out of range", "scene", scene=7)
edit("scene is text", "scene", scene="furnace")
edit("node out of range", "node 99", scenes__0__nodes=[0, 99])
edit("node is negative", "node", scenes__0__nodes=[-1])
edit("node is its own child", "cycle", nodes__0__children=[0])
edit("two nodes are each other's child", "cycle", nodes=[{"children": [1]}, {"children": [0]}], scenes__0__nodes=[0])
edit("a node with two parents", "more than one parent", nodes__0__children=[5])
edit("a node twice in the scene", "listed twice", scenes__0__nodes=[0, 0])
edit("a tree of 3000 levels", "deeper than", nodes=[{"children": [k + 1]} for k in range(3000)] + [{"mesh": 0}], scenes__0__nodes=[0])
edit("mesh out of range", "mesh", nodes__0__mesh=6)
edit("name with a newline", "warning: /wall\\x0aluxel: warning", nodes__0__name="wall\nluxel: warning: x", nodes__0__scale=[0, 0, 0])
edit("name that steers terminals", "warning: /wall\\x1b[2J", nodes__0__name="wall\x1b[2J", nodes__0__scale=[0, 0, 0])
edit("name that steers terminals in UTF-8", "warning: /wall\\xc2", nodes__0__name="wall\u009b2J", nodes__0__scale=[0, 0, 0])
edit("name of a megabyte", "warning: ", nodes__0__name="x" * (1 << 20), nodes__0__scale=[0, 0, 0])
edit("name is a number", "name", nodes__0__name=5)
edit("required extension that nobody knows", "EXT_unheard_of", extensionsRequired=["EXT_unheard_of"])
edit("extensionsRequired is text", "extensionsRequired", extensionsRequired="KHR_x")


@case("name that is no UTF-8", "UTF-8")
def _(made):
    made.raw = made.text().replace(b"wall_minus_x", b"wall_\xff\xfe_x")


@case("a key twice", "done")
def _(made):
    made.raw = made.text().replace(b'"scene": 0,', b'"scene": 0, "scene": 0,')


# --- buffers, views, accessors
edit("buffer shorter than it says", "4000 bytes, found 360", buffers__0__byteLength=4000)
edit("buffer of negative length", "byteLength", buffers__0__byteLength=-1)
edit("buffer of 2^62 bytes", "byteLength", buffers__0__byteLength=HUGE)
edit("buffer above the folder", "leads out of the folder", buffers__0__uri="../furnace.bin")
edit("buffer above the folder, in disguise", "leads out of the folder", buffers__0__uri="a/%2e%2e/%2E./furnace.bin")
edit("buffer at an absolute path", "absolute path", buffers__0__uri="/etc/hostname")
edit("buffer on the net", "http: is not followed", buffers__0__uri="http://localhost/furnace.bin")
edit("buffer that is a folder", "cannot read", buffers__0__uri=".")
edit("data URI that is no base64", "base64", buffers__0__uri="data:application/octet-stream;base64,%%%")
edit("data URI without a comma", "comma", buffers__0__uri="data:application/octet-stream;base64")
edit("view of no buffer", "buffer", bufferViews__0__buffer=3)
edit("view beyond its buffer", "bufferView", bufferViews__0__byteLength=4800)
edit("view whose end overflows", "bufferView", bufferViews__0__byteOffset=(1 << 64) - 8)
edit("stride of 3", "byteStride", bufferViews__0__byteStride=3)
edit("stride of 1000", "byteStride", bufferViews__0__byteStride=1000)
edit("stride beyond the view", "accessor 0", bufferViews__0__byteStride=252)
edit("accessor whose offset overflows", "accessor 0", accessors__0__byteOffset=(1 << 63) - 1)
edit("count times size overflows", "accessor 0", accessors__0__count=(1 << 64) // 12 + 1)
edit("accessor without a view, of 2^62 elements", "accessor 0", accessors__0={"componentType": 5126, "count": HUGE, "type": "VEC3"})
edit("accessor without a view, of 2^32 elements", "accessor 0", accessors__0={"componentType": 5126, "count": 1 << 32, "type": "VEC3"})
SPARSE = {"componentType": 5126, "count": 4, "type": "VEC3"}


def sparse(name, *words, indices=(0, 1), count=None):
    def change(made):
        index = made.accessor(indices, "H", 5123, "SCALAR")
        value = made.accessor([0.5] * 3 * len(indices), "f", 5126, "VEC3")
        made.json["accessors"][0]["sparse"] = {
            "count": len(indices) if count is None else count,
            "indices": {"bufferView": made.json["accessors"][index]["bufferView"], "componentType": 5123},
            "values": {"bufferView": made.json["accessors"][value]["bufferView"]}}
    CASES.append((name, change, words))


sparse("sparse index beyond the accessor", "sparse", indices=(0, 4))
sparse("sparse indices that descend", "warning: ", indices=(2, 1))
sparse("more sparse values than elements", "sparse", indices=(0, 1, 2, 3, 3))
sparse("sparse count that is a lie", "sparse", count=HUGE)


# --- meshes
@case("one position is not a number", "warning: /wall_minus_x", "corners that are not finite")
def _(made):
    made.floats(0, [NAN])


@case("a position is infinite", "warning: /wall_minus_x", "corners that are not finite")
def _(made):
    made.floats(0, [INF, -INF])


@case("no position is a number", "no triangle")
def _(made):
    for view in range(0, 12, 2):
        made.floats(view, [NAN] * 12)


@case("a wall of 1e38 metres", "warning: /wall_minus_x", "beyond 1e9 m")
def _(made):
    made.floats(0, [-1e38, 0, 0, 1e38])


@case("triangles without area", "warning: /wall_minus_x", "without area")
def _(made):
    made.floats(0, [1] * 12)


@case("the same triangle twice", "done")
def _(made):
    made.primitive()["indices"] = made.accessor([0, 1, 2, 0, 1, 2], "H", 5123, "SCALAR")


@case("five indices", "warning: ", "not a multiple of 3")
def _(made):
    made.primitive()["indices"] = made.accessor([0, 1, 2, 0, 1], "H", 5123, "SCALAR")


@case("index 65535, which restarts", "65535")
def _(made):
    made.primitive()["indices"] = made.accessor([0, 1, 65535], "H", 5123, "SCALAR")


edit("mesh of no primitives", "done", meshes__0__primitives=[])
edit("mesh without primitives", "done", meshes__0={"name": "x"})
edit("primitives is an object", "primitives", meshes__0__primitives={})


@case("fewer normals than positions", "NORMAL")
def _(made):
    made.primitive()["attributes"]["NORMAL"] = made.accessor([0, 1, 0], "f", 5126, "VEC3")


@case("normals that are not numbers", "done")
def _(made):
    made.primitive()["attributes"]["NORMAL"] = made.accessor([NAN, INF, 0] * 4, "f", 5126, "VEC3")


@case("texture coordinates that are not numbers", "warning: ")
def _(made):
    made.texture(data_uri(png(1, 1, b"\0\x80\x80\x80"), "image/png"))
    made.primitive()["attributes"]["TEXCOORD_0"] = made.accessor([NAN, INF] * 4, "f", 5126, "VEC2")


edit("scale of nothing", "warning: ", nodes__0__scale=[0, 0, 0])
edit("scale of 1e300", "warning: ", nodes__0__scale=[1e300, 1e300, 1e300])
edit("rotation of nothing", "done", nodes__0__rotation=[0, 0, 0, 0])
edit("matrix of three numbers", "16 numbers", nodes__0__matrix=[1, 2, 3])


# --- materials and pictures
def picture(name, *words, **image):
    CASES.append((name, lambda made: made.texture(**image), words))


picture("picture of no bytes", "warning: ", uri="data:image/png;base64,")
picture("picture of 0 x 0", "warning: ", uri=data_uri(png(0, 0), "image/png"))
picture("picture that says 60000 x 60000", "warning: ", uri=data_uri(png(60000, 60000), "image/png"))
picture("picture that ends early", "warning: ", uri=data_uri(png(64, 64, b"\0" * 100), "image/png"))
picture("picture of noise", "warning: ", uri=data_uri(bytes(range(256)), "image/png"))
picture("picture above the folder", "warning: ", "leads out of the folder", uri="../secret.png")
picture("picture at an absolute path", "warning: ", "absolute path", uri="/etc/hostname")
picture("picture that is a folder", "warning: ", uri=".")
picture("picture that is missing", "warning: ", uri="gone.png")


@case("texture of no picture", "source")
def _(made):
    made.texture("gone.png")
    made.json["textures"][0]["source"] = 5


@case("material of no texture", "baseColorTexture")
def _(made):
    made.texture("gone.png")
    made.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 5


@case("20,000 materials", "done")
def _(made):
    made.json["materials"] = [copy.deepcopy(made.json["materials"][0]) for _ in range(20000)]


edit("alpha mode that nobody knows", "warning: ", "alphaMode", materials__0__alphaMode="HOLY")
edit("colour of two numbers", "baseColorFactor", materials__0__pbrMetallicRoughness__baseColorFactor=[1, 1])


# --- lamps
def lamp(name, *words, index=0, **light):
    def change(made):
        made.json.setdefault("extensions", {})["KHR_lights_punctual"] = {"lights": [{"type": "point", **light}]}
        made.json["nodes"][0]["extensions"] = {"KHR_lights_punctual": {"light": index}}
    CASES.append((name, change, words))


lamp("lamp of a kind that nobody knows", "type", type="laser")
lamp("lamp out of range", "light", index=1)
lamp("lamp of negative light", "warning: ", intensity=-5)
lamp("lamp whose range is negative", "warning: ", range=-1)
lamp("spot whose cones are the wrong way round", "warning: ", type="spot", spot={"innerConeAngle": 1, "outerConeAngle": 0.5})


# --- compressed meshes
def meshopt(name, *words, **extension):
    def change(made):
        made.json["bufferViews"][0]["extensions"] = {"EXT_meshopt_compression": {
            "buffer": 0, "byteOffset": 0, "byteLength": 48, "byteStride": 12, "count": 4, "mode": "ATTRIBUTES", **extension}}
        made.json["extensionsUsed"].append("EXT_meshopt_compression")
    CASES.append((name, change, words))


meshopt("meshopt: bytes that are none", "meshopt")
meshopt("meshopt: a count that overflows", "\"count\"", count=HUGE)
meshopt("meshopt: a stride of 1000", "meshopt", byteStride=1000)
meshopt("meshopt: a mode that nobody knows", "meshopt", mode="MAGIC")
meshopt("meshopt: bytes beyond the buffer", "meshopt", byteLength=4800)


def draco(name, stream, *words):
    def change(made):
        made.json["bufferViews"].append({"buffer": 0, "byteOffset": len(made.bytes), "byteLength": len(stream)})
        made.bytes += stream
        made.json["buffers"][0]["byteLength"] = len(made.bytes)
        made.primitive()["extensions"] = {"KHR_draco_mesh_compression": {
            "bufferView": len(made.json["bufferViews"]) - 1, "attributes": {"POSITION": 0}}}
        made.json["extensionsUsed"].append("KHR_draco_mesh_compression")
    CASES.append((name, change, words))


draco("Draco: bytes that are none", bytes(48), "Draco")
draco("Draco: 2^29 - 1 triangles in 25 bytes", b"DRACO\2\2\1\0\0\0" + 2 * b"\xff\xff\xff\xff\1" + bytes(4), "Draco", "536870911 triangles")
draco("Draco: 10^9 orientations in 700 bytes", read(os.path.join(FUZZ_CORPUS, "draco", "found_orientations"))[3:],
      "Draco", "1380197517 orientations")


# --- the container
@case("GLB of version 1", "version")
def _(made):
    made.glb(version=1)


@case("GLB longer than it says", "warning: ")
def _(made):
    made.json["nodes"][0]["scale"] = [0, 0, 0]
    made.glb()
    made.raw += b"more"


@case("GLB shorter than it says", "scene.glb")
def _(made):
    made.glb(length=1 << 20)


@case("GLB whose JSON says 2^32 - 1 bytes", "scene.glb")
def _(made):
    made.glb(first_length=0xffffffff)


@case("GLB that begins with another chunk", "scene.glb")
def _(made):
    made.glb(kinds=(b"BIN\0", b"JSON"))


@case("GLB whose JSON is none", "scene.glb")
def _(made):
    made.glb(body=b"\0" * 64)


def run_measured(arguments):
    """Exit code, stderr, peak bytes."""
    with tempfile.TemporaryFile() as errors:
        child = subprocess.Popen([cli_test.LUXEL, *arguments], stdout=subprocess.DEVNULL, stderr=errors)
        timer = threading.Timer(LONGEST_S, child.kill)
        timer.start()
        _, status, usage = os.wait4(child.pid, 0)
        timer.cancel()
        child.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        return child.returncode, errors.read().decode(errors="replace"), usage.ru_maxrss * 1024


class Broken(cli_test.Case):
    def one(self, made):
        return run_measured(["bake", made.write(self.folder), "-o", self.output, *SMALL])

    def test_table(self):
        self.assertGreaterEqual(len(CASES), 60)
        code, text, whole = self.one(Made())
        self.assertEqual(code, 0, text)
        for name, change, words in CASES:
            with self.subTest(name):
                made = Made()
                change(made)
                code, text, peak = self.one(made)
                if SHOW:
                    print(f"--- {name}: {code}, {(peak - whole) >> 20} MB\n{text[:600]}")
                    continue
                is_baked = words[0] == "done" or words[0].startswith("warning: ")
                self.assertEqual(code, 0 if is_baked else BAD_INPUT, text)
                self.assertEqual(text.count("luxel: error: "), 0 if is_baked else 1, text)
                for word in words:
                    if word != "done":
                        self.assertIn(word, text)
                self.assertLess(peak - whole, MOST_EXTRA_MEMORY, "bytes more than the whole scene takes")


SHOW = "--show" in sys.argv

if __name__ == "__main__":
    cli_test.LUXEL = os.path.abspath(sys.argv.pop(1))
    if SHOW:
        sys.argv.remove("--show")
    unittest.main()
