"""Writes small glTF 2.0 files: polygons in, NAME.gltf + NAME.bin out. Standard library only.

Lengths are metres, Y is up. A face is a list of corners, counter-clockwise seen from its front. Faces keep their own
vertices and no NORMAL is written, so shading is flat by the specification.
"""
import json
import math
import os
import struct
import zlib


def subtract(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def facing(corners, direction):
    """The face, wound so that its front looks along `direction`."""
    normal = cross(subtract(corners[1], corners[0]), subtract(corners[2], corners[0]))
    return list(corners) if dot(normal, direction) > 0 else list(reversed(corners))


def rectangle(axis, at, low, high, sign):
    """Rectangle in the plane axis = at, between `low` and `high` (the two other coordinates, in the order x, y, z),
    front towards sign * axis."""
    corners = []
    for u, v in ((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])):
        point = [u, v]
        point.insert(axis, at)
        corners.append(tuple(point))
    direction = [0, 0, 0]
    direction[axis] = sign
    return facing(corners, direction)


def box(low, high, omit=()):
    """Faces of a box, fronts outward. omit: names of faces to leave out, such as "-y" for a box standing on a floor."""
    faces = []
    for axis, letter in enumerate("xyz"):
        others = [k for k in range(3) if k != axis]
        for sign, at in ((-1, low[axis]), (1, high[axis])):
            if ("-" if sign < 0 else "+") + letter not in omit:
                faces.append(rectangle(axis, at, [low[k] for k in others], [high[k] for k in others], sign))
    return faces


def lathe(profile, segments):
    """Surface of revolution about Y, fronts outward; profile: (radius, height) upwards. A radius of 0 closes it."""
    ring = [(math.cos(2 * math.pi * k / segments), math.sin(2 * math.pi * k / segments)) for k in range(segments)]
    faces = []
    for (r0, y0), (r1, y1) in zip(profile, profile[1:]):
        for k in range(segments):
            (c0, s0), (c1, s1) = ring[k], ring[(k + 1) % segments]
            corners = [(r0 * c0, y0, r0 * s0), (r1 * c0, y1, r1 * s0), (r1 * c1, y1, r1 * s1), (r0 * c1, y0, r0 * s1)]
            unique = [p for n, p in enumerate(corners) if p not in corners[:n]]
            if len(unique) >= 3:
                faces.append(unique)
    return faces


def png(width, height, rgba):
    """An uncompressed PNG, so that the bytes are the same with every zlib; rgba: bytes, row 0 at the top."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    raw = b"".join(b"\0" + rgba[4 * width * y:4 * width * (y + 1)] for y in range(height))
    blocks = b"".join(struct.pack("<BHH", at + 65535 >= len(raw), len(part), 65535 - len(part)) + part
                      for at in range(0, len(raw), 65535) for part in [raw[at:at + 65535]])
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", b"\x78\x01" + blocks + struct.pack(">I", zlib.adler32(raw))) + chunk(b"IEND", b""))


class Gltf:
    """One scene under construction. Materials and meshes are kept under their names and shared."""

    def __init__(self):
        self.materials, self.meshes, self.nodes = [], [], []
        self.views, self.accessors, self.roots = [], [], []
        self.blob = bytearray()
        self.material_ids, self.mesh_ids = {}, {}
        self.images, self.lamps = [], []
        self.extensions = []

    def material(self, name, reflectance, nits=None, double_sided=False):
        """Diffuse material; nits: luminance per linear Rec.709 channel of an emissive one. Returns its index."""
        if name not in self.material_ids:
            entry = {"name": name, "pbrMetallicRoughness": {
                "baseColorFactor": [*map(float, reflectance), 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0}}
            if nits is not None:
                strength = max(nits)
                entry["emissiveFactor"] = [n / strength for n in nits]
                entry["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": float(strength)}}
                self._use("KHR_materials_emissive_strength")
            if double_sided:
                entry["doubleSided"] = True
            self.material_ids[name] = len(self.materials)
            self.materials.append(entry)
        return self.material_ids[name]

    def _use(self, extension):
        if extension not in self.extensions:
            self.extensions.append(extension)

    def _picture(self, picture):
        """A texture of PNG bytes, repeated; returns its index."""
        while len(self.blob) % 4:
            self.blob.append(0)
        self.views.append({"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(picture)})
        self.blob += picture
        self.images.append({"bufferView": len(self.views) - 1, "mimeType": "image/png"})
        return len(self.images) - 1

    def paint(self, material, picture):
        """Multiplies the reflectance by a picture (PNG bytes, sRGB); returns the material."""
        self.materials[material]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": self._picture(picture)}
        return material

    def mask(self, material, picture, cutoff=0.5):
        """Cuts holes where alpha of the picture (PNG bytes, repeated) is below the cutoff; its colours count too."""
        self.paint(material, picture)
        self.materials[material].update(alphaMode="MASK", alphaCutoff=cutoff)
        return material

    def shine(self, material, picture):
        """Multiplies the luminance of an emissive material by a picture (PNG bytes, sRGB); returns the material."""
        self.materials[material]["emissiveTexture"] = {"index": self._picture(picture)}
        return material

    def glass(self, material, transmission=1.0):
        """A thin pane in the material's colour."""
        self.materials[material]["extensions"] = {"KHR_materials_transmission": {"transmissionFactor": transmission}}
        self._use("KHR_materials_transmission")
        return material

    def _accessor(self, data, component, kind, count, target, **limits):
        while len(self.blob) % 4:
            self.blob.append(0)
        self.views.append({"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data), **({"target": target} if target else {})})
        self.blob += data
        self.accessors.append({"bufferView": len(self.views) - 1, "componentType": component, "count": count,
                               "type": kind, **limits})
        return len(self.accessors) - 1

    def mesh(self, name, faces, material, uv=None, color=None):
        """Indexed triangles of convex faces; returns the mesh index. A second call with a known name shares the mesh.
        uv: from a corner to its texture coordinates. color: to its linear r, g, b."""
        if name in self.mesh_ids:
            return self.mesh_ids[name]
        points, indices = [], []
        for face in faces:
            first = len(points)
            points += [struct.unpack("<3f", struct.pack("<3f", *p)) for p in face]
            for k in range(1, len(face) - 1):
                indices += [first, first + k, first + k + 1]
        limits = {"min": [min(p[k] for p in points) for k in range(3)], "max": [max(p[k] for p in points) for k in range(3)]}
        position = self._accessor(b"".join(struct.pack("<3f", *p) for p in points), 5126, "VEC3", len(points), 34962, **limits)
        wide = len(points) > 65535
        index = self._accessor(struct.pack(f"<{len(indices)}{'I' if wide else 'H'}", *indices), 5125 if wide else 5123,
                               "SCALAR", len(indices), 34963)
        attributes = {"POSITION": position}
        if uv is not None:
            attributes["TEXCOORD_0"] = self._accessor(b"".join(struct.pack("<2f", *uv(p)) for p in points), 5126, "VEC2", len(points), 34962)
        if color is not None:
            attributes["COLOR_0"] = self._accessor(b"".join(struct.pack("<3f", *color(p)) for p in points), 5126, "VEC3", len(points), 34962)
        self.mesh_ids[name] = len(self.meshes)
        self.meshes.append({"name": name, "primitives": [
            {"attributes": attributes, "indices": index, "material": material, "mode": 4}]})
        return self.mesh_ids[name]

    def node(self, name, mesh=None, parent=None, translation=None, turn_degrees=0.0, scale=None):
        """Adds a node, turned about Y; returns its index."""
        entry = {"name": name}
        if mesh is not None:
            entry["mesh"] = mesh
        if translation is not None:
            entry["translation"] = [float(v) for v in translation]
        if turn_degrees:
            half = math.radians(turn_degrees) / 2
            entry["rotation"] = [0.0, math.sin(half), 0.0, math.cos(half)]
        if scale is not None:
            entry["scale"] = [float(v) for v in scale]
        self.nodes.append(entry)
        index = len(self.nodes) - 1
        (self.roots if parent is None else self.nodes[parent].setdefault("children", [])).append(index)
        return index

    def copies(self, name, mesh, places):
        """A node with EXT_mesh_gpu_instancing; places: translation, rotation (x, y, z, w) and scale of each copy. Returns its index."""
        columns = {}
        for semantic, member, width in (("TRANSLATION", "translation", 3), ("ROTATION", "rotation", 4), ("SCALE", "scale", 3)):
            data = b"".join(struct.pack(f"<{width}f", *place[member]) for place in places)
            columns[semantic] = self._accessor(data, 5126, f"VEC{width}", len(places), None)
        index = self.node(name, mesh)
        self.nodes[index]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": columns}}
        self._use("EXT_mesh_gpu_instancing")
        return index

    def lamp(self, name, light, position, direction=(0, 0, -1), extras=None):
        """A node with a light of KHR_lights_punctual: light as in that extension, direction where it shines to."""
        self.lamps.append({"name": name, **light})
        self._use("KHR_lights_punctual")
        length = math.sqrt(dot(direction, direction))
        x, y, z = (c / length for c in direction)
        # the shortest turn from -Z; straight back it is about Y
        turn = (0.0, 1.0, 0.0, 0.0) if z > 1 - 1e-12 else (y, -x, 0.0, 1 - z)
        size = math.sqrt(sum(c * c for c in turn))
        index = self.node(name, translation=position)
        self.nodes[index]["rotation"] = [c / size for c in turn]
        self.nodes[index]["extensions"] = {"KHR_lights_punctual": {"light": len(self.lamps) - 1}}
        if extras:
            self.nodes[index]["extras"] = extras
        return index

    def piece(self, name, faces, material, parent=None, uv=None, color=None):
        """A node with a mesh of its own."""
        return self.node(name, self.mesh(name, faces, material, uv, color), parent)

    def triangle_count(self):
        """Triangles of all instances."""
        def of_mesh(index):
            return sum(self.accessors[p["indices"]]["count"] // 3 for p in self.meshes[index]["primitives"])
        return sum(of_mesh(n["mesh"]) for n in self.nodes if "mesh" in n)

    def save(self, folder, name):
        """Writes folder/NAME.gltf and folder/NAME.bin."""
        os.makedirs(folder, exist_ok=True)
        document = {"asset": {"version": "2.0", "generator": "luxel samples/make_samples.py"}, "scene": 0,
                    "scenes": [{"name": name, "nodes": self.roots}], "nodes": self.nodes, "meshes": self.meshes,
                    "materials": self.materials, "accessors": self.accessors, "bufferViews": self.views,
                    "buffers": [{"uri": name + ".bin", "byteLength": len(self.blob)}]}
        if self.images:
            document["images"] = self.images
            document["textures"] = [{"source": k} for k in range(len(self.images))]
        if self.lamps:
            document["extensions"] = {"KHR_lights_punctual": {"lights": self.lamps}}
        if self.extensions:
            document["extensionsUsed"] = self.extensions
        with open(os.path.join(folder, name + ".bin"), "wb") as file:
            file.write(self.blob)
        with open(os.path.join(folder, name + ".gltf"), "w", encoding="utf-8", newline="\n") as file:
            json.dump(document, file, separators=(",", ":"))
            file.write("\n")
