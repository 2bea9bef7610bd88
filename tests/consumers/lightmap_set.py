"""The lightmap set of a model: which lightmap each triangle has, and where on it. For comparing files that tools have rewritten.

Two models have the same set when the same triangles (lightmap coordinates, corner by corner) have the same picture (every byte),
intensity, sampler and extras: lost(). moved() is for tools that round coordinates. Tools may move, merge and reorder everything else. Standard library only.
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


def lost(before, after):
    """A line that says how many triangles of one set are not in the other, bit by bit, if there are any."""
    if not any(before.values()):
        return ["there are no lightmaps to lose"]
    had, has = (collections.Counter((lightmap, _turned(triangle)) for lightmap, triangles in which.items() for triangle in triangles)
                for which in (before, after))
    missing, added, gone = sum((had - has).values()), sum((has - had).values()), set(before) - set(after)
    return [f"{missing} of {sum(had.values())} triangles have lost their place on a lightmap, {added} have another one; "
            f"{len(gone)} lightmaps are gone or have changed"] if missing or added else []


def _turned(triangle):
    """Tools may turn a triangle, which is the same one."""
    return triangle and min(triangle[first:] + triangle[:first] for first in range(3))


# Linear functions of a corner, as factors of u and v.
DIRECTIONS = ((1, 0), (0, 1), (1, 1), (1, -1), (2, 1), (1, -2))


def moved(before, after, tolerance):
    """A line where coordinates were rounded by more than the tolerance. Where every one of many numbers moves by at most t, so
    does each place of their sorted list: sorted lists of corners, and of triangles' sums of corners, seen from several directions
    must agree. No partners need to be found, which nearby small triangles would make ambiguous."""
    if not any(before.values()):
        return ["there are no lightmaps to lose"]
    if set(before) != set(after) or any(len(before[key]) != len(after[key]) or None in after[key] for key in before):
        return ["lightmaps or triangles on them are gone, or were added"]
    worst = max(_largest_step(before[key], after[key], direction) for key in before for direction in DIRECTIONS)
    return [f"coordinates have moved by up to {worst:.3g}, allowed {tolerance:.3g}"] if worst > tolerance else []


def _largest_step(before, after, direction):
    """Between the sorted lists, as a move of a single coordinate."""
    length, steps = sum(map(abs, direction)), []
    for corners in (False, True):
        lists = []
        for triangles in (before, after):
            seen = [[direction[0] * u + direction[1] * v for u, v in triangle] for triangle in triangles]
            lists.append(sorted([value for three in seen for value in three] if corners else [sum(three) / 3 for three in seen]))
        steps += [abs(one - other) / length for one, other in zip(*lists)]
    return max(steps, default=0)
