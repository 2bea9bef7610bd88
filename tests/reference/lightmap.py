"""Reads the lightmaps of a baked glTF, and finds what a texel covers.

Values come from the float pages that `<baked>.lightmaps.json` lists, else from the pictures of the model, in any format but ktx2
(docs/lightmap-formats.md).
Texel (x, y) of a page covers [x, x+1) x [y, y+1), y downwards, as glTF's V does.
"""
import json
import os
import tempfile
import urllib.parse

import numpy as np

from gltf_scene import texture_use

LATTICE = (0.7548776662466927, 0.5698402909980532)   # 1/p, 1/p^2 of the plastic number p: M. Roberts, the R2 sequence


def read_picture(path, channels="RGB"):
    """Samples as floats, (height, width, channels): those of whole numbers divided by their largest."""
    import OpenImageIO as oiio
    wanted = oiio.ImageSpec()
    wanted["oiio:UnassociatedAlpha"] = 1
    picture = oiio.ImageInput.open(path, wanted)
    if picture is None:
        raise OSError(f"{path}: {oiio.geterror()}")
    spec = picture.spec()
    names = list(spec.channelnames)
    values = np.asarray(picture.read_image("float"), np.float64).reshape(spec.height, spec.width, spec.nchannels)
    picture.close()
    return values[..., [names.index(c) for c in channels]]


def read_exr(path):
    return read_picture(path)


def decode(samples, encoding, scale=1.0):
    """What samples in 0..1 (floats: as they are) stand for, before the intensity. scale: the range of rgbm8 and rgbm8-mx."""
    if encoding == "rgbm8":
        return samples[..., :3] * samples[..., 3:] * scale
    if encoding == "rgbm8-mx":
        return samples[..., :3] * samples[..., 3:] ** 2.2 * scale
    if encoding == "srgb8":
        return np.where(samples <= 0.04045, samples / 12.92, ((samples + 0.055) / 1.055) ** 2.4)
    if encoding in ("linear8", "linear16", "rgbe8", "half"):
        return samples
    raise ValueError(f"unknown encoding {encoding}")


def source_of(texture):
    """The image that a texture of ours shows: its own, or the one that its extension names."""
    if "source" in texture:
        return texture["source"]
    return next(e["source"] for e in texture["extensions"].values() if "source" in e)


class Lightmaps:
    """pages: (height, width, 3) irradiance in lux. page, uv: per triangle of the scene its page (-1: none) and its corners
    in texels of that page, (T, 3, 2). sources: where the values of each page come from."""

    def __init__(self, scene, path):
        self.scene, self.path = scene, path
        self.pages, self.sources, self.known = [], [], {}
        sidecar = path + ".lightmaps.json"
        self.listed = {}
        if os.path.exists(sidecar):
            with open(sidecar, encoding="utf-8") as file:
                for page in json.load(file)["pages"]:
                    picture = page.get("picture", page.get("png", {}))
                    if "name" in picture:
                        self.listed[picture["name"]] = page
        self.page = np.full(len(scene.material), -1)
        self.uv = np.zeros((len(scene.material), 3, 2))
        for own, lightmap in scene.lightmap_uses():
            page = self._load(lightmap)
            height, width = self.pages[page].shape[:2]
            self.page[own] = page
            use = texture_use(lightmap)
            corners = scene.uv[lightmap.get("texCoord", 1)][own]
            self.uv[own] = (corners @ use["matrix"][:, :2].T + use["matrix"][:, 2]) * (width, height)

    def _load(self, use):
        texture = self.scene.document.json["textures"][use["index"]]
        key = source_of(texture)
        if key in self.known:
            return self.known[key]
        image = self.scene.document.json["images"][key]
        entry = self.listed.get(image.get("name"))
        if entry and "exr" in entry and "uri" in entry["exr"]:
            name = os.path.join(os.path.dirname(os.path.abspath(self.path)), urllib.parse.unquote(entry["exr"]["uri"]))
            values, source = read_exr(name) * entry["exr"].get("intensity", 1.0), os.path.basename(name)
        else:
            values, source = self._picture(key, use), "picture " + str(image.get("name", key))
        self.known[key] = len(self.pages)
        self.pages.append(values)
        self.sources.append(source)
        return self.known[key]

    def _picture(self, key, use):
        """Irradiance from the picture in the model, by what the material says of it."""
        extras = use.get("extras", {})
        encoding = extras.get("encoding", "srgb8")
        document, entry = self.scene.document, self.scene.document.json["images"][key]
        data = document.from_uri(entry["uri"]) if "uri" in entry else document.view(entry["bufferView"])[0]
        if extras.get("format") == "ktx2":
            raise ValueError(f"{self.path}: KTX 2.0 is not read here; keep the float pages and their list beside the model")
        suffix = {"rgbe": ".hdr", "exr": ".exr"}.get(extras.get("format"), ".png")
        with tempfile.NamedTemporaryFile(suffix=suffix) as file:
            file.write(data)
            file.flush()
            samples = read_picture(file.name, "RGBA" if encoding.startswith("rgbm8") else "RGB")
        return decode(samples, encoding, extras.get("range", 1.0)) * use.get("intensity", 1.0) * extras.get("irradianceFactor", 1.0)

    def value(self, page, x, y):
        return self.pages[page][y, x]

    def sample(self, triangles, weights):
        """Bilinear irradiance (N, 3) at points of triangles, as a viewer reads it."""
        out = np.zeros((len(triangles), 3))
        at = (self.uv[triangles] * weights[..., None]).sum(1) - 0.5
        for page, values in enumerate(self.pages):
            own = self.page[triangles] == page
            if not own.any():
                continue
            size = np.array(values.shape[1::-1])
            low = np.floor(at[own])
            f = at[own] - low
            for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1)):
                cell = np.clip(low + (dx, dy), 0, size - 1).astype(int)
                share = (f[:, 0] if dx else 1 - f[:, 0]) * (f[:, 1] if dy else 1 - f[:, 1])
                out[own] += values[cell[:, 1], cell[:, 0]] * share[:, None]
        return out


def clip_to_texel(corners, x, y):
    """The polygon of barycentric weights (n, 3) that a triangle (3, 2), in texels, shares with texel (x, y)."""
    polygon = [(corners[k], np.eye(3)[k]) for k in range(3)]
    for axis, limit, sign in ((0, x, 1), (0, x + 1, -1), (1, y, 1), (1, y + 1, -1)):
        inside = [sign * (p[axis] - limit) for p, _ in polygon]
        kept = []
        for k, (point, weight) in enumerate(polygon):
            following = (k + 1) % len(polygon)
            if inside[k] >= 0:
                kept.append((point, weight))
            if inside[k] * inside[following] < 0:
                t = inside[k] / (inside[k] - inside[following])
                kept.append((point + t * (polygon[following][0] - point), weight + t * (polygon[following][1] - weight)))
        polygon = kept
        if len(polygon) < 3:
            return None
    return np.array([w for _, w in polygon])


class Footprint:
    """Points spread over the part of one texel that surface covers, uniform by world area."""

    def __init__(self, maps, page, x, y, candidates, places, noise):
        scene = maps.scene
        triangles, areas, shapes = [], [], []
        for t in candidates:
            polygon = clip_to_texel(maps.uv[t], x, y)
            if polygon is None:
                continue
            world = polygon @ scene.corners[t]
            for k in range(1, len(polygon) - 1):
                area = np.linalg.norm(np.cross(world[k] - world[0], world[k + 1] - world[0])) / 2
                triangles.append(t), areas.append(area), shapes.append(polygon[[0, k, k + 1]])
        self.page, self.x, self.y, self.area = page, x, y, float(sum(areas))
        if self.area <= 0:
            return
        # the plastic-number lattice, shifted: one coordinate runs along the areas and then within the triangle it has met;
        # in random order, because the paths take their directions from the same lattice
        u, v = (np.array(LATTICE)[:, None] * noise.permutation(places) + noise.random((2, 1))) % 1
        end, along = np.cumsum(areas), u * self.area
        pick = np.minimum(np.searchsorted(end, along), len(areas) - 1)
        root = np.sqrt(np.clip(1 - (end[pick] - along) / np.array(areas)[pick], 0, 1))
        inner = np.stack([1 - root, root * (1 - v), root * v], 1)
        self.triangles = np.array(triangles)[pick]
        self.weights = np.einsum("nk,nkc->nc", inner, np.array(shapes)[pick])
        self.points = np.einsum("nk,nkc->nc", self.weights, scene.corners[self.triangles])
        self.flat = scene.flat[self.triangles]
        normals = np.einsum("nk,nkc->nc", self.weights, scene.normals[self.triangles])
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        self.normals = np.where(length > 1e-6, normals / np.maximum(length, 1e-6), self.flat)


def choose_texels(maps, count, places, seed):
    """Footprints of `count` texels, drawn in proportion to their area (so that plain means are means over area)."""
    scene = maps.scene
    noise = np.random.default_rng([seed, 1])
    mapped = np.nonzero(maps.page >= 0)[0]
    if len(mapped) == 0:
        raise ValueError(f"{maps.path}: no material has MOZ_lightmap, and no node MX_lightmap")
    drawn = noise.choice(mapped, count, p=scene.areas[mapped] / scene.areas[mapped].sum())
    weights = noise.dirichlet([1, 1, 1], count)
    texels = np.floor((maps.uv[drawn] * weights[..., None]).sum(1)).astype(int)
    low, high = maps.uv.min(1), maps.uv.max(1)
    out = []
    for (x, y), triangle in zip(texels, drawn):
        page = maps.page[triangle]
        height, width = maps.pages[page].shape[:2]
        x, y = min(max(x, 0), width - 1), min(max(y, 0), height - 1)
        near = np.nonzero((maps.page == page) & (low[:, 0] < x + 1) & (high[:, 0] > x) & (low[:, 1] < y + 1) & (high[:, 1] > y))[0]
        footprint = Footprint(maps, page, x, y, near, places, noise)
        if footprint.area > 0:
            out.append(footprint)
    return out
