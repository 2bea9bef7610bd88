"""Runs `luxel sweep` on a scene, and reads what it has measured."""
import dataclasses
import json
import math
import os
import subprocess
import sys

GRID = os.path.join(os.path.dirname(os.path.abspath(__file__)), "grid.json")
# Stages that take the same time whatever the settings are. They are left out: with few texels they would hide what the settings cost.
COMMON_STAGES = {"read", "unwrap", "texels", "visible", "seams", "write"}

REFERENCE = (("quality", "reference"),)


@dataclasses.dataclass(frozen=True)
class Measure:
    seconds: float  # of processors, without COMMON_STAGES
    whole: float    # with them
    error: float    # relative RMSE
    p95: float
    seen: float     # relative RMSE of one bake, as all settings have it: `error`, but for the reference (of_three)


@dataclasses.dataclass
class Sweep:
    scene: str
    texels: int
    noise: float    # of the mean of two references
    points: dict    # setting -> Measure; a setting is a tuple of (option, value)


def of_three(noise, error):
    """Error of --quality reference by three bakes: two that make the yardstick, whose mean has `noise`, and a third that was found to be wrong by `error`.
    One bake of variance s2: noise^2 = s2 / 2, and error^2, freed of the yardstick's noise, s2. The sum of squares of three about their mean is 2 s2."""
    return math.sqrt(4 / 3 * noise ** 2 + error ** 2 / 3)


def settings_of(point):
    return tuple(sorted((option, str(value)) for option, value in point["settings"].items()))


def run(luxel, scene, shared, folder, grid):
    """Goes on where an earlier run has stopped."""
    subprocess.run([luxel, "sweep", scene.path(shared), "-o", folder, "--grid", grid, "--texels-per-metre", f"{scene.density:g}", *scene.options],
                   check=True, stdout=sys.stderr)


def load(scene, folder):
    """None: it is not finished."""
    path = os.path.join(folder, "sweep.json")
    if not os.path.exists(path):
        return None
    with open(path, encoding="utf-8") as file:
        found = json.load(file)
    if found["interrupted"]:
        return None
    points, texels, noise = {}, 0, 0.0
    for point in found["points"]:
        if "failed" in point:
            print(f"presets: {scene.name}: {point['name']}: {point['failed']}", file=sys.stderr)
            continue
        own = sum(s["processor_seconds"] for s in point["stages"] if s["name"] not in COMMON_STAGES)
        error = point["error"]
        points[settings_of(point)] = Measure(own, point["processor_seconds"], error["relative_rmse"], error["p95"], error["relative_rmse"])
        texels, noise = error["texels"], error["reference_noise"]
    own = points.get(REFERENCE)
    if own:
        points[REFERENCE] = dataclasses.replace(own, error=of_three(noise, own.seen))
    return Sweep(scene.name, texels, noise, points)
