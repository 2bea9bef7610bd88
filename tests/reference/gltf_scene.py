"""Reads a glTF scene into plain arrays: every triangle of every node in world metres, with its materials and lamps.

Written from the glTF 2.0 specification for the comparison with luxel and sharing no code with it. Emission is a luminance
in nits, point and spot lamps are in candela, directional ones in lux. Metals mirror: base colour * (1 - metallicFactor) is
diffuse; a metallic texture is not read and counts as 0. Alpha is coverage (MASK: 0 or 1 by the cutoff). KHR_materials_transmission
makes a part of what covers a thin pane in the base colour; the rest reflects. What emits transmits nothing, and reflects
1 - transmission. COLOR_0 multiplies base colour and alpha.
Compressed geometry (meshopt, Draco) is refused: give the baked file instead, which holds it decoded.
"""
import base64
import io
import json
import os
import struct
import urllib.parse

import numpy as np

COMPONENT = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
COMPRESSED = ("EXT_meshopt_compression", "KHR_draco_mesh_compression")


class Document:
    """The JSON of a file, and its buffers."""

    def __init__(self, path):
        self.folder = os.path.dirname(os.path.abspath(path))
        with open(path, "rb") as file:
            raw = file.read()
        self.chunk, self.buffers = None, {}
        if raw[:4] != b"glTF":
            self.json = json.loads(raw.decode("utf-8-sig"))
            return
        at = 12
        while at + 8 <= len(raw):
            size, kind = struct.unpack_from("<I4s", raw, at)
            body = raw[at + 8:at + 8 + size]
            if kind == b"JSON":
                self.json = json.loads(body)
            elif kind == b"BIN\0":
                self.chunk = body
            at += 8 + size

    def all(self, name):
        return self.json.get(name, [])

    def from_uri(self, uri):
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        with open(os.path.join(self.folder, urllib.parse.unquote(uri)), "rb") as file:
            return file.read()

    def view(self, index):
        """Bytes of a buffer view and its stride (0: packed)."""
        view = self.json["bufferViews"][index]
        number = view["buffer"]
        if number not in self.buffers:
            uri = self.json["buffers"][number].get("uri")
            self.buffers[number] = self.from_uri(uri) if uri else self.chunk
        start = view.get("byteOffset", 0)
        return self.buffers[number][start:start + view["byteLength"]], view.get("byteStride", 0)

    def _elements(self, view, offset, dtype, width, count):
        data, stride = self.view(view)
        return np.ndarray((count, width), dtype, data, offset, (stride or dtype.itemsize * width, dtype.itemsize))

    def accessor(self, index):
        """Elements as (count, width); integers as they are."""
        a = self.json["accessors"][index]
        dtype, width = np.dtype(COMPONENT[a["componentType"]]), WIDTH[a["type"]]
        values = np.zeros((a["count"], width), dtype)
        if "bufferView" in a:
            values[:] = self._elements(a["bufferView"], a.get("byteOffset", 0), dtype, width, a["count"])
        if "sparse" in a:
            s, count = a["sparse"], a["sparse"]["count"]
            where = self._elements(s["indices"]["bufferView"], s["indices"].get("byteOffset", 0),
                                   np.dtype(COMPONENT[s["indices"]["componentType"]]), 1, count)
            values[where[:, 0]] = self._elements(s["values"]["bufferView"], s["values"].get("byteOffset", 0), dtype, width, count)
        return values

    def numbers(self, index):
        """An accessor as float64, normalised integers divided (KHR_mesh_quantization leaves others as they are)."""
        values = self.accessor(index)
        if not self.json["accessors"][index].get("normalized") or values.dtype.kind == "f":
            return values.astype(np.float64)
        return np.maximum(values / float(np.iinfo(values.dtype).max), -1.0)

    def image(self, index, mode="RGB"):
        """Pixels as uint8 (height, width, 3), sRGB encoded; mode "RGBA": with alpha, 255 where there is none."""
        from PIL import Image
        entry = self.json["images"][index]
        data = self.from_uri(entry["uri"]) if "uri" in entry else self.view(entry["bufferView"])[0]
        with Image.open(io.BytesIO(data)) as picture:
            return np.asarray(picture.convert(mode))


def texture_use(info):
    """Texture index, UV set and the 2x3 matrix of KHR_texture_transform; None stays None."""
    if info is None:
        return None
    extra = info.get("extensions", {}).get("KHR_texture_transform", {})
    (sx, sy), (ox, oy), angle = extra.get("scale", (1, 1)), extra.get("offset", (0, 0)), extra.get("rotation", 0.0)
    c, s = np.cos(angle), np.sin(angle)
    return {"texture": info["index"], "uv_set": extra.get("texCoord", info.get("texCoord", 0)),
            "matrix": np.array([[c * sx, s * sy, ox], [-s * sx, c * sy, oy]])}


def read_material(entry):
    pbr, extensions = entry.get("pbrMetallicRoughness", {}), entry.get("extensions", {})
    strength = extensions.get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
    old = extensions.get("KHR_materials_pbrSpecularGlossiness")
    colour, texture = pbr.get("baseColorFactor", (1, 1, 1, 1)), pbr.get("baseColorTexture")
    if old is not None:
        colour, texture = old.get("diffuseFactor", (1, 1, 1, 1)), old.get("diffuseTexture")
    pane = extensions.get("KHR_materials_transmission", {})
    emission = np.array(entry.get("emissiveFactor", (0, 0, 0)), float) * strength
    through, emits = pane.get("transmissionFactor", 0.0), emission.max() > 0
    kept = 1 - through if emits else 1.0
    if old is None and "KHR_materials_unlit" not in extensions and "metallicRoughnessTexture" not in pbr:
        kept *= 1 - pbr.get("metallicFactor", 1.0)
    base = np.clip(np.array(colour[:3], float), 0, 1)
    return {"name": entry.get("name", ""), "albedo": base * kept, "albedo_texture": texture_use(texture), "emission": emission,
            "pane": base, "transmission": 0.0 if emits else through,
            "transmission_texture": None if emits or through == 0 else texture_use(pane.get("transmissionTexture")),
            "alpha_mode": {"MASK": 1, "BLEND": 2}.get(entry.get("alphaMode"), 0), "cutoff": entry.get("alphaCutoff", 0.5),
            "alpha": float(np.clip(colour[3], 0, 1)) if len(colour) > 3 else 1.0,
            "emission_texture": texture_use(entry.get("emissiveTexture")),
            "double_sided": bool(entry.get("doubleSided", False)), "lightmap": extensions.get("MOZ_lightmap")}


# What MX_lightmap's description says of every lightmap: RGBM, and base colour * texel * intensity is what is seen.
MX_MEANING = {"encoding": "rgbm8-mx", "range": 34.49, "irradianceFactor": np.pi}


def node_lightmap(node):
    """The MX_lightmap of a node as if it were a MOZ_lightmap; None where it has none. Copies have their places in attributes."""
    extensions = node.get("extensions", {})
    lightmap = extensions.get("MX_lightmap")
    if lightmap is None:
        return None
    use = {"texCoord": 1, **lightmap["lightMapTexture"], "intensity": lightmap.get("intensity", 1.0),
           "extras": {**MX_MEANING, **lightmap.get("extras", {})}}
    if "EXT_mesh_gpu_instancing" not in extensions:
        use["extensions"] = {"KHR_texture_transform": {k: lightmap[k] for k in ("scale", "offset") if k in lightmap}}
    return use


def node_matrix(node):
    """Column-vector matrix of one node."""
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    matrix = np.eye(4)
    matrix[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                      [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                      [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    matrix[:3, :3] *= np.array(node.get("scale", (1, 1, 1)), float)
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix


def triangle_corners(mode, order):
    """Corner numbers (count, 3) of a primitive with the given vertex order; None for points and lines."""
    count = len(order)
    if mode == 4:
        return order[:count // 3 * 3].reshape(-1, 3)
    if mode == 5 and count >= 3:
        rows = np.stack([order[:-2], order[1:-1], order[2:]], 1)
        rows[1::2] = rows[1::2][:, [0, 2, 1]]
        return rows
    if mode == 6 and count >= 3:
        return np.stack([np.full(count - 2, order[0]), order[1:-1], order[2:]], 1)
    return None


class Scene:
    """corners (T, 3, 3) world metres, front counter-clockwise; normals (T, 3, 3) unit, geometric where the file has none;
    uv: UV set -> (T, 3, 2); colours: (T, 3, 4) of the vertices, or None where all are white; material, object (T,); objects: names; node_lightmaps: per object, or None; lamps: dicts with kind, position, direction, colour, radius (metres) or sine (of half the apparent diameter).
    lamp_radius, sun_angle: metres and degrees, of lamps that the file gives no size."""

    def __init__(self, path, lamp_radius=0.0, sun_angle=0.0):
        self.sizes = {"radius": lamp_radius, "angle": sun_angle}
        self.document = Document(path)
        needed = [e for e in self.document.all("extensionsRequired") if e in COMPRESSED]
        if needed:
            raise ValueError(f"{path}: {needed[0]} is not read here; use a decoded copy of the scene")
        self.materials = [read_material(m) for m in self.document.all("materials")]
        self.materials.append(read_material({"name": "default"}))
        self.objects, self.node_lightmaps, self.lamps, self.parts = [], [], [], []
        self._walk()
        self._join()

    def _walk(self):
        document = self.document
        scenes = document.all("scenes")
        roots = scenes[document.json.get("scene", 0)].get("nodes", []) if scenes else range(len(document.all("nodes")))
        pending = [(n, np.eye(4)) for n in reversed(list(roots))]
        while pending:
            index, parent = pending.pop()
            node = document.json["nodes"][index]
            world = parent @ node_matrix(node)
            pending += [(child, world) for child in reversed(node.get("children", []))]
            lamp = node.get("extensions", {}).get("KHR_lights_punctual")
            if lamp is not None:
                self._lamp(document.json["extensions"]["KHR_lights_punctual"]["lights"][lamp["light"]], world, node.get("extras", {}))
            if "mesh" in node:
                for copy, place in self._copies(node):
                    for number, primitive in enumerate(document.json["meshes"][node["mesh"]]["primitives"]):
                        self._primitive(primitive, world @ copy, place, f"{node.get('name', index)}/{number}", node_lightmap(node))

    def _copies(self, node):
        """Matrices of EXT_mesh_gpu_instancing, with the scale and offset of each copy's second UV set; one without the extension."""
        columns = node.get("extensions", {}).get("EXT_mesh_gpu_instancing", {}).get("attributes")
        if columns is None:
            yield np.eye(4), None
            return
        values = {k: self.document.numbers(v) for k, v in columns.items()}
        names = {"TRANSLATION": "translation", "ROTATION": "rotation", "SCALE": "scale"}
        for k in range(min(len(v) for v in values.values())):
            place = (values["_LIGHTMAP_SCALE"][k], values["_LIGHTMAP_OFFSET"][k]) if "_LIGHTMAP_SCALE" in values else None
            yield node_matrix({names[n]: v[k] for n, v in values.items() if n in names}), place

    def _lamp(self, light, world, extras):
        sizes = {**self.sizes, **light.get("extras", {}), **extras}
        spot, direction = light.get("spot", {}), world[:3, :3] @ np.array([0, 0, -1.0])
        self.lamps.append({
            "kind": light["type"], "position": world[:3, 3], "direction": direction / np.linalg.norm(direction),
            "colour": np.array(light.get("color", (1, 1, 1)), float) * light.get("intensity", 1.0),
            "radius": 0.0 if light["type"] == "directional" else sizes["radius"],
            "sine": np.sin(np.radians(sizes["angle"]) / 2) if light["type"] == "directional" else 0.0,
            "range": light.get("range", 0.0), "cos_inner": np.cos(spot.get("innerConeAngle", 0.0)),
            "cos_outer": np.cos(spot.get("outerConeAngle", np.pi / 4))})

    def _primitive(self, primitive, world, place, name, lightmap):
        attributes, document = primitive["attributes"], self.document
        if "POSITION" not in attributes:
            return
        points = document.numbers(attributes["POSITION"]) @ world[:3, :3].T + world[:3, 3]
        order = (document.accessor(primitive["indices"])[:, 0].astype(np.int64) if "indices" in primitive
                 else np.arange(len(points)))
        rows = triangle_corners(primitive.get("mode", 4), order)
        if rows is None or len(rows) == 0:
            return
        if np.linalg.det(world[:3, :3]) < 0:
            rows = rows[:, [0, 2, 1]]
        normals = None
        if "NORMAL" in attributes:
            # inverse transposed, applied to rows; pinv stays defined for flattened instances
            normals = (document.numbers(attributes["NORMAL"]) @ np.linalg.pinv(world[:3, :3]))[rows]
        uv = {int(k[9:]): document.numbers(v)[rows] for k, v in attributes.items() if k.startswith("TEXCOORD_")}
        if place is not None and 1 in uv:
            uv[1] = uv[1] * place[0] + place[1]
        colours = None
        if "COLOR_0" in attributes:
            found = np.clip(document.numbers(attributes["COLOR_0"]), 0, 1)
            colours = np.concatenate([found, np.ones((len(found), 4 - found.shape[1]))], 1)[rows]
        self.objects.append(name)
        self.node_lightmaps.append(lightmap)
        self.parts.append((points[rows], normals, uv, colours, primitive.get("material", len(self.materials) - 1), len(self.objects) - 1))

    def lightmap_uses(self):
        """(which triangles, their lightmap): of materials, and of nodes."""
        for of, uses in ((self.material, [m["lightmap"] for m in self.materials]), (self.object, self.node_lightmaps)):
            yield from ((of == number, use) for number, use in enumerate(uses) if use is not None)

    def _join(self):
        kept = []
        for corners, normals, uv, colours, material, number in self.parts:
            good = np.isfinite(corners).all((1, 2))
            with np.errstate(invalid="ignore"):
                vector = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
                good &= np.linalg.norm(vector, axis=1) > 0
            flat = vector[good] / np.linalg.norm(vector[good], axis=1, keepdims=True)
            smooth = np.repeat(flat[:, None], 3, 1)
            if normals is not None:
                with np.errstate(all="ignore"):
                    unit = normals[good] / np.linalg.norm(normals[good], axis=2, keepdims=True)
                smooth = np.where(np.isfinite(unit).all(2, keepdims=True), unit, smooth)
            kept.append((corners[good], smooth, {k: v[good] for k, v in uv.items()},
                         np.full(good.sum(), material), np.full(good.sum(), number),
                         np.ones((good.sum(), 3, 4)) if colours is None else colours[good]))
        sets = sorted({k for part in kept for k in part[2]} | {0})
        join = lambda arrays, shape: np.concatenate(list(arrays) or [np.zeros(shape)])
        self.corners, self.normals = join((p[0] for p in kept), (0, 3, 3)), join((p[1] for p in kept), (0, 3, 3))
        self.uv = {k: join((p[2].get(k, np.zeros((len(p[0]), 3, 2))) for p in kept), (0, 3, 2)) for k in sets}
        self.material = join((p[3] for p in kept), 0).astype(int)
        self.object = join((p[4] for p in kept), 0).astype(int)
        self.colours = join((p[5] for p in kept), (0, 3, 4)) if any(p[3] is not None for p in self.parts) else None
        vector = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        self.areas = np.linalg.norm(vector, axis=1) / 2
        self.flat = vector / np.maximum(2 * self.areas, 1e-300)[:, None]
        del self.parts

    def texture_pixels(self, texture):
        """uint8 RGBA pixels, (wrap_s, wrap_t), nearest; None where the texture has no image that can be read."""
        entry = self.document.json["textures"][texture]
        source = entry.get("extensions", {}).get("EXT_texture_webp", {}).get("source", entry.get("source"))
        if source is None:
            return None
        sampler = self.document.json["samplers"][entry["sampler"]] if "sampler" in entry else {}
        return (self.document.image(source, "RGBA"), (sampler.get("wrapS", 10497), sampler.get("wrapT", 10497)),
                sampler.get("magFilter") == 9728)
