#!/usr/bin/env python3
"""Writes a clear sky with a sun, in nits by longitude and latitude as `luxel bake --sky` reads it. 512 x 256 pixels.

usage: make_sky.py OUT.exr

Brighter towards the horizon, a ground of 400 nits, and a disk of 3 degrees of 2e7 nits, 52 degrees up, between +X and +Z.
"""
import sys

import numpy as np

WIDTH, HEIGHT = 512, 256


def main():
    import OpenImageIO as oiio
    row, column = np.mgrid[0:HEIGHT, 0:WIDTH]
    down, along = np.pi * (row + 0.5) / HEIGHT, 2 * np.pi * ((column + 0.5) / WIDTH - 0.5)
    direction = np.stack([np.sin(down) * np.cos(along), np.cos(down), np.sin(down) * np.sin(along)], -1)
    up = direction[..., 1:2]
    nits = np.where(up > 0, np.array([2000.0, 3000.0, 5000.0]) * (0.6 + 0.8 * (1 - np.abs(up))), 400.0)
    sun = np.array([np.cos(0.9) * np.cos(0.5), np.sin(0.9), np.cos(0.9) * np.sin(0.5)])
    nits[direction @ sun > np.cos(np.radians(1.5))] = [2.2e7, 2.0e7, 1.7e7]
    picture = oiio.ImageOutput.create(sys.argv[1])
    picture.open(sys.argv[1], oiio.ImageSpec(WIDTH, HEIGHT, 3, "float"))
    picture.write_image(nits.astype(np.float32))
    picture.close()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main()
