#!/usr/bin/env python3
"""A picture of a baked model as three.js shows it, with AgX tone mapping: for looking at, and for docs/viewers.md.

usage: three_picture.py BAKED.glb OUT.png --from X,Y,Z --at X,Y,Z [--fov 60] [--exposure 1] [--size 960x640]
"""
import argparse
import os

import scenes
import three_test


def place(text):
    x, y, z = map(float, text.split(","))
    return [x, y, z]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model")
    parser.add_argument("picture")
    parser.add_argument("--from", dest="start", type=place, required=True, help="place of the camera, metres")
    parser.add_argument("--at", type=place, required=True, help="where it looks")
    parser.add_argument("--fov", type=float, default=60, help="vertical, degrees")
    parser.add_argument("--exposure", type=float, default=1)
    parser.add_argument("--size", default="960x640")
    options = parser.parse_args()
    if not scenes.has_modules():
        scenes.skip("node or its packages are missing: tools/setup.sh consumers")
    width, height = map(int, options.size.split("x"))
    folder, name = os.path.split(os.path.abspath(options.model))
    three_test.check(folder, "picture", {"lambert": True}, file=os.path.abspath(options.picture), model=f"/baked/{name}",
                     camera={"from": options.start, "at": options.at, "fov": options.fov}, exposure=options.exposure, width=width, height=height)


if __name__ == "__main__":
    main()
