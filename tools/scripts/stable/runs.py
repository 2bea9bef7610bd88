"""Bakes a room, and solves it in two precisions."""
import json
import os
import subprocess
import tempfile

import numpy as np

from lecture.common import Bake, light_along
from stable.rooms import TEXELS, Room

GATHERED, SPREAD, EXACT = ["--gather-rays", "16"], ["--gather", "off"], ["--gather-rays", "4096", "--share", "off"]
OPTIONS = ["--atlas-size", "256", "--patch-texels", "2", "--rays", "256", "--tolerance", "1e-6"]


class Failed(Exception):
    """luxel refused: exit code and the first line of what it says, without the name of the file."""

    def __init__(self, code, text):
        super().__init__(f"exit code {code}: {text}")
        self.code, self.text = code, text


def density(side):
    return repr(TEXELS / side)


def bake(build, folder, scene, side, options):
    path = os.path.join(folder, "out", "scene.glb")
    command = [os.path.join(build, "tools", "luxel", "luxel"), "bake", scene, "-o", path, "-q", "--aov", "valid", "--report", path + ".report.json",
               "--texels-per-metre", density(side), *OPTIONS, *options]
    done = subprocess.run(command, check=False, stderr=subprocess.PIPE, text=True)
    if done.returncode:
        raise Failed(done.returncode, done.stderr.strip().split("\n")[0].split(".gltf: ", 1)[-1])
    return Bake(path)


def worst_texel(made, expected):
    """Mean of H, and the largest relative error of a texel; not a number counts as infinite."""
    light = made.light() / (0.2126 + 0.7152 + 0.0722)
    if not np.isfinite(light).all():
        return float("nan"), float("inf")
    return float(light.mean()), float(np.abs(light / expected - 1).max()) if expected else float(np.abs(light).max())


def all_light(made, room):
    """Relative error of what is absorbed: with nowhere to go, all that is emitted."""
    return abs(made.report["energy"]["absorbed"][0] / room.emitted() - 1)


def on_floor(made, room):
    """Relative error of the light in the middle of a black floor below a ceiling that glows."""
    middle = np.array(room.centre, float) - (0, room.side / 2, 0)
    found = light_along(made.path, middle, middle, 1, 1e-3 * room.side)[0] / (0.2126 + 0.7152 + 0.0722)
    return abs(found / room.below_ceiling() - 1)


def seconds(made):
    return sum(stage["seconds"] for stage in made.report["stages"])


def sums(build, scene, side):
    """Relative error of the mean of H for "double" and "single"; infinite where it is not a number."""
    command = [os.path.join(build, "tests", "figures", "accumulation"), scene, "--density", density(side), "--patch-texels", "2", "--rays", "256"]
    done = subprocess.run(command, check=False, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode:
        return {"double": float("nan"), "single": float("nan")}
    found = json.loads(done.stdout)
    expected = found["expected"]   # emitted over what absorbs, with all areas as they are
    return {name: abs(found[name]["mean"] / expected - 1) if found[name]["mean"] is not None else float("inf") for name in ("double", "single")}


def measure(build, folder, make):
    """Of a room that `make(lit)` writes: mean, expected, worst texel, all light, light of the floor, sums, seconds."""
    with tempfile.TemporaryDirectory(dir=folder) as place:
        room = make("all")
        made = bake(build, place, room.save(os.path.join(place, "all")), room.side, GATHERED)
        mean, worst = worst_texel(made, room.expected())
        found = {"expected": room.expected(), "result": mean, "worst": worst, "seconds": seconds(made)}
        room = make("one")
        scene = room.save(os.path.join(place, "one"))
        made = bake(build, place, scene, room.side, SPREAD)
        found |= {"all": all_light(made, room)} | sums(build, scene, room.side)
        room = make("black")
        return found | {"floor": on_floor(bake(build, place, room.save(os.path.join(place, "black")), room.side, EXACT), room)}


def plain(**change):
    """Makes rooms with some of their numbers changed."""
    return lambda lit: Room(lit, **change).plain()
