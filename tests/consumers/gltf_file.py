"""glTF files as the tests of this folder read them: the JSON as it is, and the bytes that it names.

Written from the specification (glTF 2.0), on its own: it shares nothing with luxel's reader. Standard library only.
Elements of arrays are bytes, so that comparing them compares every bit in its component type.
"""
import base64
import json
import os
import struct
import urllib.parse

COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
INDEX_FORMAT = {5121: "B", 5123: "H", 5125: "I"}
SHAPES = {"SCALAR": (1, 1), "VEC2": (2, 1), "VEC3": (3, 1), "VEC4": (4, 1), "MAT2": (2, 2), "MAT3": (3, 3), "MAT4": (4, 4)}  # rows, columns
TRIANGLES, STRIP, FAN = 4, 5, 6


class GltfFile:
    """One file: `json` is the document; views, arrays and pictures are read when they are asked for."""

    def __init__(self, path):
        self.path = path
        self.folder = os.path.dirname(path)
        with open(path, "rb") as file:
            content = file.read()
        self.body = b""
        if content[:4] == b"glTF":
            length, = struct.unpack_from("<I", content, 12)
            text = content[20:20 + length]
            if len(content) > 20 + length:
                size, = struct.unpack_from("<I", content, 20 + length)
                self.body = content[28 + length:28 + length + size]
        else:
            text = content
        self.json = json.loads(text)
        self._uris = {}

    def items(self, name):
        return self.json.get(name, [])

    def uri(self, uri):
        if uri not in self._uris:
            if uri.startswith("data:"):
                self._uris[uri] = base64.b64decode(uri.split(",", 1)[1])
            else:
                with open(os.path.join(self.folder, urllib.parse.unquote(uri)), "rb") as file:
                    self._uris[uri] = file.read()
        return self._uris[uri]

    def view(self, index):
        view = self.items("bufferViews")[index]
        buffer = self.items("buffers")[view["buffer"]]
        content = self.uri(buffer["uri"]) if "uri" in buffer else self.body
        start = view.get("byteOffset", 0)
        if start + view["byteLength"] > len(content):
            raise ValueError(f"{self.path}: bufferView {index} ends after its buffer")
        return content[start:start + view["byteLength"]]

    def picture(self, index):
        """The bytes of an image."""
        image = self.items("images")[index]
        return self.view(image["bufferView"]) if "bufferView" in image else self.uri(image["uri"])

    def elements(self, index):
        """The elements of an accessor: a list of bytes, each packed, padding of matrix columns taken out."""
        accessor = self.items("accessors")[index]
        rows, columns = SHAPES[accessor["type"]]
        column = rows * COMPONENT_BYTES[accessor["componentType"]]
        step = -(-column // 4) * 4 if columns > 1 else column
        count = accessor["count"]
        if "bufferView" in accessor:
            content = self.view(accessor["bufferView"])
            stride = self.items("bufferViews")[accessor["bufferView"]].get("byteStride") or step * columns
            found = _cut(content, accessor.get("byteOffset", 0), stride, column, step, columns, count)
        else:
            found = [bytes(column * columns)] * count
        if "sparse" in accessor:
            sparse = accessor["sparse"]
            places = self._part(sparse["indices"], COMPONENT_BYTES[sparse["indices"]["componentType"]], 1, 1, sparse["count"])
            values = self._part(sparse["values"], column, step, columns, sparse["count"])
            for place, value in zip(places, values):
                found[int.from_bytes(place, "little")] = value
        return found

    def _part(self, part, column, step, columns, count):
        stride = column if columns == 1 else step * columns
        return _cut(self.view(part["bufferView"]), part.get("byteOffset", 0), stride, column, step, columns, count)

    def numbers(self, index):
        """The elements of an accessor as tuples of numbers (not scaled where they are normalized)."""
        accessor = self.items("accessors")[index]
        rows, columns = SHAPES[accessor["type"]]
        letter = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}[accessor["componentType"]]
        return list(struct.iter_unpack(f"<{rows * columns}{letter}", b"".join(self.elements(index))))

    def indices(self, primitive):
        if "indices" not in primitive:
            return list(range(self.items("accessors")[primitive["attributes"]["POSITION"]]["count"]))
        accessor = self.items("accessors")[primitive["indices"]]
        content = b"".join(self.elements(primitive["indices"]))
        return [value for value, in struct.iter_unpack("<" + INDEX_FORMAT[accessor["componentType"]], content)]

    def triangles(self, primitive):
        """Three vertices per triangle, in the winding of the specification; None where a primitive has no triangles."""
        mode = primitive.get("mode", TRIANGLES)
        if mode not in (TRIANGLES, STRIP, FAN):
            return None
        of = self.indices(primitive)
        if mode == TRIANGLES:
            return of[:len(of) // 3 * 3]
        found = []
        for i in range(len(of) - 2):
            found += [of[i], of[i + 1 + i % 2], of[i + 2 - i % 2]] if mode == STRIP else [of[i + 1], of[i + 2], of[0]]
        return found


def _cut(content, offset, stride, column, step, columns, count):
    if count and offset + (count - 1) * stride + (columns - 1) * step + column > len(content):
        raise ValueError("an array ends after its buffer view")
    if columns == 1:
        return [content[at:at + column] for at in range(offset, offset + count * stride, stride)]
    return [b"".join(content[at + c * step:at + c * step + column] for c in range(columns))
            for at in range(offset, offset + count * stride, stride)]


def write_glb(path, document, body):
    """`document` with buffer 0 as `body`, in one file."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body += bytes(-len(body) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(body)) + struct.pack("<I4s", len(text), b"JSON") + text +
                   struct.pack("<I4s", len(body), b"BIN\0") + body)
