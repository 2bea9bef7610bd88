#!/usr/bin/env python3
"""Pictures of a baked scene: reflectance / pi * lightmap + emission, seen from a camera that is given or found.

usage: render.py BAKED.glb OUT.png [--size 960x640] [--camera x,y,z,tx,ty,tz] [--fov 60] [--exposure E]
                 [--light-only] [--error SPP]

--camera      place and target, metres; otherwise the file's own camera, or one that is looked for
--light-only  white surfaces: the lightmap alone
--error SPP   not the picture but the lightmap's error in it, against SPP paths for every third pixel;
              blue too dark, white right, red too bright, full colour at 20 %
Backs of surfaces without doubleSided, and what has no lightmap, show a dark checker.
"""
import argparse
import os
import sys

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import camera as cameras   # noqa: E402
import gltf_scene   # noqa: E402
import lightmap     # noqa: E402
import pathtrace    # noqa: E402
from pathtrace import dr, mi, floats, rows, vectors   # noqa: E402

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
LAYERS = 32   # panes and holes that a camera ray may pass


class View:
    """Casts camera rays at a baked scene and reads what they meet."""

    def __init__(self, path):
        self.scene = gltf_scene.Scene(path)
        self.maps = lightmap.Lightmaps(self.scene, path)
        self.tracer = pathtrace.Tracer(self.scene)
        self.two_sided = np.array([m["double_sided"] for m in self.scene.materials])

    def hits(self, position, directions):
        """Triangle (-1: none), weights, distance and whether a side with light was met; self.tint: of the panes before it."""
        start = (np.broadcast_to(position, directions.shape) - self.tracer.centre) / self.tracer.half
        depth, self.tint, noise = np.zeros(len(directions)), np.ones((len(directions), 3)), np.random.default_rng(1)
        # what lets light through is met by the chance of its opacity: the samples of a pixel show the mean
        for _ in range(LAYERS):
            hit = self.tracer.scene.ray_intersect_preliminary(mi.Ray3f(vectors(start), vectors(directions)), coherent=True)
            valid = np.array(hit.is_valid())
            triangle = np.where(valid, np.array(hit.prim_index).astype(np.int64), -1)
            u, v = (np.where(valid, np.array(c), 0).astype(float) for c in (hit.prim_uv.x, hit.prim_uv.y))
            step = np.where(valid, np.array(hit.t, float), 0)
            if not self.tracer.see_through:
                break
            opacity, tint = self.tracer.passage_at(hit.prim_index, [1 - hit.prim_uv.x - hit.prim_uv.y, hit.prim_uv.x, hit.prim_uv.y],
                                                   hit.is_valid())
            passes = valid & (noise.random(len(valid)) >= np.array(opacity))
            if not passes.any():
                break
            self.tint[passes] *= rows(tint)[passes]
            step = np.where(passes, step + pathtrace.OFFSET, 0)
            start, depth = start + directions * step[:, None], depth + step
        facing = (self.scene.flat[triangle] * directions).sum(1) < 0
        front = valid & (facing | self.two_sided[self.scene.material[triangle]])
        return triangle, np.stack([1 - u - v, u, v], 1), (depth + step) * self.tracer.half, front

    def look(self, position, directions):
        """For the search: front, depth, things, light."""
        triangle, weights, depth, front = self.hits(position, directions)
        light = np.zeros(len(directions))
        light[front] = self.maps.sample(triangle[front], weights[front]) @ LUMINANCE
        return front, depth, self.scene.object[triangle] * 64 + (self.scene.flat[triangle] * 1.4).round().astype(int) @ (9, 3, 1), light

    def shade(self, position, directions, light_only=False):
        """Luminance (N, 3) in nits."""
        triangle, weights, _, front = self.hits(position, directions)
        front &= self.maps.page[triangle] >= 0
        light = np.zeros((len(directions), 3))
        light[front] = self.maps.sample(triangle[front], weights[front]) / np.pi
        if light_only:
            return light, front
        index = pathtrace.U(np.maximum(triangle, 0).astype(np.uint32))
        lanes = [floats(weights[:, k]) for k in range(3)]
        albedo, nits = rows(self.tracer.albedo_at(index, lanes)), rows(self.tracer.nits_at(index, lanes))
        return np.where(front[:, None], (light * albedo + nits) * self.tint, 0), front

    def error(self, position, directions, spp, seed=0):
        """Relative error of the lightmap's luminance at what each ray meets; NaN where nothing is."""
        triangle, weights, _, front = self.hits(position, directions)
        front &= self.maps.page[triangle] >= 0
        out = np.full(len(directions), np.nan)
        points = (weights[front][..., None] * self.scene.corners[triangle[front]]).sum(1)
        flat = self.scene.flat[triangle[front]]
        truth = self.tracer.irradiance(points[:, None], flat[:, None], flat[:, None], spp, seed)[0] @ LUMINANCE
        baked = self.maps.sample(triangle[front], weights[front]) @ LUMINANCE
        out[front] = (baked - truth) / np.maximum(truth, 0.01 * max(truth.mean(), 1e-300))
        return out


def tone(nits, exposure):
    """Film-like shoulder, then sRGB bytes."""
    mapped = 1 - np.exp(-np.maximum(nits, 0) * exposure)
    srgb = np.where(mapped <= 0.0031308, mapped * 12.92, 1.055 * mapped ** (1 / 2.4) - 0.055)
    return (srgb * 255 + 0.5).astype(np.uint8)


def automatic_exposure(nits, front):
    """The log-mean of what is seen, its darkest and brightest tenth left out, becomes a middle grey."""
    value = np.sort((nits @ LUMINANCE)[front & (nits.max(1) > 0)])
    value = value[len(value) // 10: len(value) - len(value) // 10]
    return 0.35 / np.exp(np.log(value).mean()) if len(value) else 1.0


def checker(width, height, samples):
    y, x = np.mgrid[0:height, 0:width]
    return np.repeat((((x // 8 + y // 8) % 2) * 0.03 + 0.02).ravel(), samples * samples)[:, None]


def save(path, pixels, colours=0):
    from PIL import Image
    picture = Image.fromarray(pixels)
    if path.lower().endswith((".jpg", ".jpeg")):
        picture.save(path, quality=85, optimize=True)
    else:
        (picture.quantize(colours) if colours else picture).save(path, optimize=True)


def draw(view, camera, width, height, exposure=None, light_only=False, samples=3):
    """Picture (height, width, 3), bytes."""
    nits, front = view.shade(camera.position, camera.directions(width, height, samples), light_only)
    exposure = exposure or automatic_exposure(nits, front)
    nits = np.where(front[:, None], nits, checker(width, height, samples) / exposure)
    mapped = tone(nits, exposure).astype(float).reshape(height, width, samples * samples, 3)
    return (mapped.mean(2) + 0.5).astype(np.uint8)


def draw_error(view, camera, width, height, spp):
    # one comparison for 3 x 3 pixels: worth more as few sure ones than as many noisy ones
    share = np.clip(view.error(camera.position, camera.directions(width // 3, height // 3), spp) / 0.2, -1, 1)
    share = share.reshape(height // 3, width // 3, 1).repeat(3, 0).repeat(3, 1)
    red, blue = np.array([200, 20, 20]), np.array([20, 60, 200])
    colour = 255 + np.where(share > 0, share * (red - 255), -share * (blue - 255))
    return np.where(np.isnan(share), 60, colour).astype(np.uint8)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("baked"), parser.add_argument("picture")
    parser.add_argument("--size", default="960x640")
    parser.add_argument("--camera", help="x,y,z,tx,ty,tz")
    parser.add_argument("--fov", type=float, default=60.0, help="vertical, degrees")
    parser.add_argument("--exposure", type=float)
    parser.add_argument("--light-only", action="store_true")
    parser.add_argument("--error", type=int, metavar="SPP")
    parser.add_argument("--seed", type=int, default=0, help="of the search for a camera")
    options = parser.parse_args()
    width, height = map(int, options.size.split("x"))
    view = View(options.baked)
    if options.camera:
        numbers = [float(v) for v in options.camera.split(",")]
        camera = cameras.Camera(numbers[:3], numbers[3:], options.fov)
    else:
        camera = cameras.from_file(view.scene) or cameras.search(view.scene, view.look, options.seed)
        print("camera:", camera.text())
    if options.error:
        save(options.picture, draw_error(view, camera, width, height, options.error))
    else:
        save(options.picture, draw(view, camera, width, height, options.exposure, options.light_only))


if __name__ == "__main__":
    main()
