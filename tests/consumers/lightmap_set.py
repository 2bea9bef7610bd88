"""The lightmap set of a model: which lightmap each triangle has, and where on it. For comparing files that tools have rewritten.

Two models have the same set when the same triangles (lightmap coordinates, corner by corner) have the same picture (every byte),
intensity, sampler and extras. Tools may move, merge and reorder everything else. Standard library only.
"""
import collections
import hashlib
import json

from gltf_file import GltfFile


def as_told(value):
    """JSON with all numbers as floats: 1 and 1.0 are the same."""
    if isinstance(value, dict):
        return {key: as_told(item) for key, item in value.items()}
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


class _Lightmaps:
    """Says which lightmap a material has: a text that is the same for the same lightmap in any file, and its UV set."""

    def __init__(self, file):
        self.file, self.pictures = file, {}

    def of(self, primitive):
        material = self.file.items("materials")[primitive["material"]] if "material" in primitive else {}
        lightmap = material.get("extensions", {}).get("MOZ_lightmap")
        if not lightmap:
            return None, None
        texture = self.file.items("textures")[lightmap["index"]]
        told = {key: value for key, value in lightmap.items() if key not in ("index", "texCoord")}
        sampler = dict(self.file.items("samplers")[texture["sampler"]]) if "sampler" in texture else {}
        sampler.pop("name", None)
        return json.dumps(as_told({**told, "sampler": sampler, "picture": self.picture(texture)}), sort_keys=True), lightmap["texCoord"]

    def picture(self, texture):
        named = [texture, *texture.get("extensions", {}).values()]
        image = next(item["source"] for item in named if "source" in item)
        if image not in self.pictures:
            self.pictures[image] = hashlib.sha256(self.file.picture(image)).hexdigest()
        return self.pictures[image]


def lightmap_set(path):
    """{lightmap: [triangle]}; a triangle is three (u, v), or None where its UV set is gone."""
    file, found = GltfFile(path), collections.defaultdict(list)
    lightmaps = _Lightmaps(file)
    for mesh in (node["mesh"] for node in file.items("nodes") if "mesh" in node):
        for primitive in file.items("meshes")[mesh]["primitives"]:
            lightmap, uv_set = lightmaps.of(primitive)
            if lightmap is None:
                continue
            name = f"TEXCOORD_{uv_set}"
            uv = file.numbers(primitive["attributes"][name]) if name in primitive["attributes"] else None
            of = file.triangles(primitive)
            found[lightmap] += [tuple(uv[i] for i in of[at:at + 3]) if uv else None for at in range(0, len(of), 3)]
    return found


def lost(before, after, tolerance=0.0):
    """A line that says how many triangles of one set are not in the other, if there are any. tolerance: of a coordinate."""
    if not any(before.values()):
        return ["there are no lightmaps to lose"]
    missing = sum(len(_unmatched(triangles, after.get(lightmap, []), tolerance)) for lightmap, triangles in before.items())
    total, gone = sum(map(len, before.values())), set(before) - set(after)
    added = sum(map(len, after.values())) - total + missing
    return [f"{missing} of {total} triangles have lost their place on a lightmap, {added} have another one; "
            f"{len(gone)} lightmaps are gone or have changed"] if missing or added or gone else []


def _unmatched(wanted, given, tolerance):
    """Triangles that have no partner. Tools may turn a triangle, which is the same one. Cells of the first corner find candidates."""
    cell = max(4 * tolerance, 1e-6)
    waiting = collections.defaultdict(list)
    for number, triangle in enumerate(given):
        for turn in range(3 if triangle else 0):
            waiting[int(triangle[turn][0] / cell), int(triangle[turn][1] / cell)].append((number, triangle[turn:] + triangle[:turn]))
    taken, alone = set(), []
    for triangle in wanted:
        partner = _partner(triangle, waiting, taken, cell, tolerance)
        if partner is None:
            alone.append(triangle)
        else:
            taken.add(partner)
    return alone


def _partner(triangle, waiting, taken, cell, tolerance):
    if triangle is None:
        return None
    column, row = int(triangle[0][0] / cell), int(triangle[0][1] / cell)
    for place in ((column + x, row + y) for x in (0, -1, 1) for y in (0, -1, 1)):
        for number, other in waiting.get(place, ()):
            if number not in taken and all(abs(a - b) <= tolerance for one, two in zip(triangle, other) for a, b in zip(one, two)):
                return number
    return None
