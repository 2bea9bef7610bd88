#!/usr/bin/env python3
"""Proves reference.py on scenes with closed forms: a made-up bake with the exact answer in its texels must be found right.

usage: check_reference.py [--points 300] [--spp 4096]      exit status 1 if a check fails

  furnace, sphere   every texel holds H = M / (1 - rho) = 2 lm/m2
  two squares       texels hold Lambert's formula for the sender, unoccluded, and their mean is the form factor
  lamps over floor  texels hold the sum of three lamps; with radii the same; under a constant sky pi L more; under a picture
                    whose light comes from +X and -Z only, what a tilted pixel gives to the floor
  see through       a sun through the open half of a mask, a tinted pane and a sheet of alpha 0.3: the product per channel
  sheet             two squares with a sheet of alpha 0.25 between: three quarters of Lambert's formula
  a wrong bake      2 % too bright must be reported as a bias of 2 %
"""
import argparse
import json
import os
import struct
import sys
import tempfile

import numpy as np

SAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "samples")
sys.path[:0] = [os.path.dirname(os.path.abspath(__file__)), SAMPLES]
import gltf_scene   # noqa: E402
import lights       # noqa: E402
import reference    # noqa: E402
from gltf_writer import Gltf, png, rectangle   # noqa: E402

CELL, FINE_CELL = 24, 96   # texels: each triangle lies in its own square of a page; finer where there are few


def polygon_irradiance(points, normal, polygon, nits):
    """Lambert 1760: irradiance of an unoccluded polygon wholly above the horizon of each point."""
    total = np.zeros(len(points))
    rays = [p - points for p in polygon]
    for a, b in zip(rays, rays[1:] + rays[:1]):
        side = np.cross(a, b)
        length = np.linalg.norm(side, axis=1)
        angle = np.arctan2(length, (a * b).sum(1))
        total += np.where(length > 0, angle * (side @ normal) / np.maximum(length, 1e-30), 0)
    return np.abs(total) * nits / 2


def write_exr(path, values):
    import OpenImageIO as oiio
    spec = oiio.ImageSpec(values.shape[1], values.shape[0], 3, "float")
    picture = oiio.ImageOutput.create(path)
    picture.open(path, spec)
    picture.write_image(np.ascontiguousarray(values, np.float32))
    picture.close()


def fake_bake(scene, folder, irradiance):
    """A GLB with one chart per triangle; irradiance(object name, points), one number or three, fills the texels. Returns its path."""
    count = len(scene.corners)
    cell = FINE_CELL if count < 10 else CELL
    columns = int(np.ceil(np.sqrt(count)))
    side = columns * cell
    page = np.zeros((side, side, 3))
    uv = np.zeros((count, 3, 2))
    for t in range(count):
        origin = np.array([t % columns, t // columns]) * cell
        uv[t] = origin + np.array([[2, 2], [cell - 3, 2], [2, cell - 3]])
        inverse = np.linalg.inv(np.column_stack([uv[t, 1] - uv[t, 0], uv[t, 2] - uv[t, 0]]))
        x, y = np.meshgrid(np.arange(cell), np.arange(cell))
        at = (np.stack([x.ravel(), y.ravel()], 1) + 0.5 + origin - uv[t, 0]) @ inverse.T
        at = np.clip(at, 0, 1)
        points = scene.corners[t, 0] + at @ (scene.corners[t, 1:] - scene.corners[t, 0])
        value = irradiance(scene.objects[scene.object[t]], points)
        page[origin[1]:origin[1] + cell, origin[0]:origin[0] + cell] = np.reshape(value, (cell, cell, -1))
    write_exr(os.path.join(folder, "page.exr"), page)
    blob = scene.corners.astype("<f4").tobytes() + (uv / side).astype("<f4").tobytes()
    size = count * 36
    primitives, accessors = [], []
    for material in np.unique(scene.material):
        own = np.nonzero(scene.material == material)[0]
        indices = (own[:, None] * 3 + np.arange(3)).astype("<u4").tobytes()
        accessors.append({"bufferView": 2 + len(primitives), "componentType": 5125, "count": len(own) * 3, "type": "SCALAR"})
        primitives.append((int(material), len(blob), indices))
        blob += indices
    views = [{"buffer": 0, "byteOffset": 0, "byteLength": size}, {"buffer": 0, "byteOffset": size, "byteLength": count * 24}]
    views += [{"buffer": 0, "byteOffset": start, "byteLength": len(data)} for _, start, data in primitives]
    both = [{"bufferView": 0, "componentType": 5126, "count": count * 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": count * 3, "type": "VEC2"}]
    materials = [dict(m) for m in scene.document.json["materials"]]
    for m in materials:
        m["extensions"] = {**m.get("extensions", {}), "MOZ_lightmap": {"index": 0, "texCoord": 1, "intensity": 1.0}}
    document = {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "all"}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_1": 1}, "indices": 2 + k, "material": m}
                                           for k, (m, _, _) in enumerate(primitives)]}],
                "materials": materials, "textures": [{"source": 0}], "images": [{"name": "lightmap0", "uri": "page.exr"}],
                "accessors": both + accessors, "bufferViews": views, "buffers": [{"byteLength": len(blob)}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    blob += b"\0" * (-len(blob) % 4)
    path = os.path.join(folder, "fake.glb")
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(blob)) + struct.pack("<I4s", len(text), b"JSON") + text +
                   struct.pack("<I4s", len(blob), b"BIN\0") + blob)
    with open(path + ".lightmaps.json", "w", encoding="utf-8") as file:
        json.dump({"schema": 1, "pages": [{"index": 0, "exr": {"uri": "page.exr", "encoding": "linear", "intensity": 1},
                                           "png": {"name": "lightmap0", "encoding": "srgb8", "intensity": 1}}]}, file)
    return path


def squares(name):
    sender = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], float)
    normal = np.array([0, -1.0, 0]) if name.endswith("parallel") else np.array([1.0, 0, 0])

    def value(object_name, points):
        if object_name.startswith("sender"):
            return np.zeros(len(points))
        return polygon_irradiance(points + normal * 1e-9, normal, sender, 1 / np.pi)
    return value


def lamps_over_floor(_, points):
    total = np.zeros((len(points), 3))
    for colour, intensity, at, reach, axis in (((1, 0.8, 0.6), 100, (-1.5, 2, -1), 0, None), ((0.5, 0.7, 1), 40, (1.5, 1, -1.5), 2.5, None),
                                               ((1, 1, 1), 200, (1, 2.5, 1.5), 0, (-0.3, -1, 0.1))):
        way = np.array(at) - points
        d = np.linalg.norm(way, axis=1)
        light = intensity * way[:, 1] / d ** 3
        if reach:
            light *= np.clip(1 - (d / reach) ** 4, 0, 1)
        if axis:
            along = -(way @ np.array(axis)) / d / np.linalg.norm(axis)
            light *= np.clip((along - np.cos(0.5)) / (np.cos(0.2) - np.cos(0.5)), 0, 1) ** 2
        total += light[:, None] * np.array(colour)
    return total


def write_sky(path):
    """32 x 16 pixels: 1000 nits where the pixel right above the middle of the picture is, 400 at a quarter to its left."""
    pixels = np.zeros((16, 32, 3))
    pixels[4, 16], pixels[6, 8] = 1000, 400
    write_exr(path, pixels)
    edges = np.cos(np.pi * np.arange(17) / 16)
    flat = lambda row: (edges[row] ** 2 - edges[row + 1] ** 2) / 2 * 2 * np.pi / 32    # integral of y over the pixel
    return 1000 * flat(4) + 400 * flat(6)


TINT = np.array([0.25, 0.8, 0.4])


def see_through_scene():
    """Black layers under a sun of 3 lux: mask (its left half is a hole), pane, sheet, floor. Halves are pieces of their own."""
    gltf = Gltf()
    black = gltf.material("black", (0, 0, 0))
    mask = gltf.mask(gltf.material("mask", (0, 0, 0)), png(2, 1, b"\0\0\0\0\0\0\0\xff"))
    pane = gltf.glass(gltf.material("pane", TINT))
    sheet = gltf.material("sheet", (0, 0, 0))
    gltf.materials[sheet].update(alphaMode="BLEND")
    gltf.materials[sheet]["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.3
    for side, x0, x1 in (("left", -1, 0), ("right", 0, 1)):
        at = 0.25 if side == "left" else 0.75
        gltf.piece("mask_" + side, [rectangle(1, 1.5, (x0, -1), (x1, 1), 1)], mask, uv=lambda p, at=at: (at, 0.5))
        gltf.piece("pane_" + side, [rectangle(1, 1.0, (x0, -1), (x1, 1), 1)], pane)
        gltf.piece("sheet_" + side, [rectangle(1, 0.5, (x0, -1), (x1, 1), 1)], sheet)
        gltf.piece("floor_" + side, [rectangle(1, 0.0, (x0, -1), (x1, 1), 1)], black)
    gltf.lamp("sun", {"type": "directional", "intensity": 3.0}, (0, 5, 0), (1e-4, -1, 1e-4))
    return gltf


def see_through_light(object_name, points):
    layer, side = object_name.split("/")[0].split("_")
    share = {"mask": np.ones(3), "pane": np.ones(3), "sheet": TINT, "floor": 0.7 * TINT}[layer]
    lit = layer == "mask" or side == "left"
    return np.tile(3 * lit * share, (len(points), 1))


def sheet_scene():
    gltf = Gltf()
    black = gltf.material("black", (0, 0, 0))
    sheet = gltf.material("sheet", (0, 0, 0))
    gltf.materials[sheet].update(alphaMode="BLEND")
    gltf.materials[sheet]["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.25
    gltf.piece("sender", [rectangle(1, 0.0, (0, 0), (1, 1), 1)], gltf.material("sender", (0, 0, 0), [1 / np.pi] * 3))
    gltf.piece("sheet", [rectangle(1, 0.5, (0, 0), (1, 1), -1)], sheet)
    gltf.piece("receiver", [rectangle(1, 1.0, (0, 0), (1, 1), -1)], black)
    return gltf


def sheet_light(object_name, points):
    return squares("parallel")(object_name, points) * (0.75 if object_name.startswith("receiver") else 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=300)
    parser.add_argument("--spp", type=int, default=4096)
    options = parser.parse_args()
    constant = lambda value: lambda _, points: np.full(len(points), value)
    skies = tempfile.TemporaryDirectory()
    sky = os.path.join(skies.name, "sky.exr")
    of_sky = write_sky(sky)
    plain, light = lights.Light(), lights.Light
    floor = lambda more: lambda name, points: lamps_over_floor(name, points) + more
    lit = [("lamps_over_floor", floor(0), 0.0, None, plain), ("lamps_over_floor", floor(0), 0.0, None, light(lamp_radius=0.3)),
           ("lamps_over_floor", floor(10 * np.pi), 0.0, None, light(sky_color=(5, 5, 5), sky_scale=2)),
           ("lamps_over_floor", floor(of_sky), 0.0, None, light(sky=sky, sky_rotate=33))]
    cases = [("furnace", constant(2.0), 0.0, None), ("sphere", constant(2.0), 0.0, None),
             ("two_squares_parallel", squares("parallel"), 0.0, 0.199825 / 2),
             ("two_squares_perpendicular", squares("perpendicular"), 0.0, 0.200044 / 2), ("furnace", constant(2.04), 0.02, None),
             ("see_through", see_through_light, 0.0, None), ("sheet", sheet_light, 0.0, None)]
    made = {"see_through": see_through_scene, "sheet": sheet_scene}
    failed = 0
    for name, value, bias, mean, given in [(*case, plain) for case in cases] + lit:
        source = os.path.join(SAMPLES, name, name + ".gltf")
        with tempfile.TemporaryDirectory() as folder:
            if name in made:
                source = os.path.join(folder, name + ".gltf")
                made[name]().save(folder, name)
            baked = fake_bake(gltf_scene.Scene(source), folder, value)
            result, arrays, _ = reference.compare(source, baked, options.points, options.spp, light=given)
        # facets of the sphere and the size of the texels: a mean may be off by 3e-3, single texels by 0.02
        good = abs(result["bias"] - bias) < 4 * result["bias_se"] + 3e-3 and result["relRMSE_net"] < abs(bias) + 0.02
        if mean is not None:   # both squares have the same area and the sender receives nothing
            spread = arrays["truth"][:, 0].std() / np.sqrt(len(arrays["truth"]))
            good &= abs(result["mean_truth"] - mean) < 4 * spread
        failed += not good
        print(f"{'ok  ' if good else 'FAIL'} {name:28s} bias {result['bias']:+.5f} (expected {bias:+.2f}, s.e. {result['bias_se']:.5f})  "
              f"net rms {result['relRMSE_net']:.5f}  mean {result['mean_truth']:.5f}  points {result['points']}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
