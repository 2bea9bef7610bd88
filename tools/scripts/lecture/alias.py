"""Alias errors of the hemicube: in form factors, in the light of patches, and in the light of texels."""
import os
import re

from lecture.common import bake, difference, percent, run, sample, table

# Scene, options that set its patches, rays per patch of the truth.
SCENES = {"cornell_box": (["--texels-per-metre", "48"], 18), "two_rooms": (["--texels-per-metre", "12", "--patch-texels", "6"], 16)}
QUICK_OPTIONS = ["--texels-per-metre", "24"]
RESOLUTIONS = [16, 32, 64, 128, 256]
LIMIT = 512   # stands for a hemicube without alias: its pixels are a thousandth of a form factor
# How the light of patches reaches texels; each hides the errors of form factors better.
WAYS = {"patches": ["--gather", "off", "--interpolation", "constant"], "interpolated": ["--gather", "off"],
        "gathered": ["--gather-rays", "1024", "--share", "off"]}


def rays_below(pixels):
    """The number of rays, 4 * 2^k, next below so many pixels."""
    return 4 << ((pixels // 4).bit_length() - 1)


def form_factors(setting, most):
    """Configuration -> {resolution: (alias, hemicube, rays)} in per cent, as estimator_bench prints them."""
    found, name = {}, ""
    for line in run([setting.estimator_bench, "--most-resolution", str(most)]).splitlines():
        if not line.startswith(" "):
            name = line.split(":")[0]
            found[name] = {}
        values = re.findall(r"[\d.]+", line)
        if line.startswith(" ") and len(values) == 6:
            found[name][int(values[0])] = tuple(float(values[k]) / 100 for k in (2, 3, 5))
    return found


def measure(setting, scene, resolutions, limit):
    """{(kind, size): {way: light}} and the same for the truth."""
    options, truth_level = (QUICK_OPTIONS, 14) if setting.quick else SCENES[scene]
    plain = ["--quality", "medium", "--tolerance", "1e-5", "--importance", "off", *options]
    kinds = {("hemicube", n): ["--estimator", "hemicube", "--hemicube-resolution", str(n)] for n in [*resolutions, limit]}
    kinds |= {("rays", n): ["--rays", str(rays_below(3 * n * n))] for n in resolutions}
    kinds["truth"] = ["--rays", str(1 << truth_level)]
    light = {}
    for kind, choice in kinds.items():
        name = kind if isinstance(kind, str) else "-".join(map(str, kind))
        light[kind] = {way: bake(setting, sample(scene), os.path.join("alias", scene), f"{name}-{way}", [*plain, *choice, *more]).light()
                       for way, more in WAYS.items()}
    return light


def rows_of(light, resolutions, limit):
    """Resolution -> error of each way: alias alone, hemicube, rays."""
    return {n: {way: (difference(light["hemicube", n][way], light["hemicube", limit][way]), difference(light["hemicube", n][way], light["truth"][way]),
                      difference(light["rays", n][way], light["truth"][way])) for way in WAYS} for n in resolutions}


def main(setting):
    scenes, resolutions, limit = (["cornell_box"], [16, 64], 128) if setting.quick else (list(SCENES), RESOLUTIONS, LIMIT)
    if not setting.quick:
        print("Form factors between two surfaces, root of squares over root of squares: alias / hemicube / rays\n")
        found = form_factors(setting, LIMIT)
        names = ["facing squares, distance 1", "right angle, common edge"]
        table(["resolution", *names], [[str(n), *(" / ".join(percent(v) for v in found[name][n]) for name in names)] for n in [*RESOLUTIONS, LIMIT]])
    results = {}
    for scene in scenes:
        light = measure(setting, scene, resolutions, limit)
        results[scene] = rows_of(light, resolutions, limit)
        print(f"Light in {scene}, sum of differences over sum of light: alias / hemicube / rays\n")
        table(["resolution", "pixels", "rays", *WAYS], [[str(n), f"{3 * n * n:,}", f"{rays_below(3 * n * n):,}",
              *(" / ".join(percent(v) for v in results[scene][n][way]) for way in WAYS)] for n in resolutions])
        smooth, own = light["truth"]["interpolated"], light["truth"]["gathered"]
        print(f"For comparison: with the right form factors, interpolated light is {percent(difference(smooth, own))} off what is gathered.\n")
    return results


def check(results):
    """What the quick run holds this to."""
    rows = results["cornell_box"]
    for way in WAYS:
        assert rows[64][way][0] < rows[16][way][0] / 2, f"alias of {way} does not fall with resolution: {rows}"
    assert rows[16]["gathered"][0] < rows[16]["patches"][0] / 2, f"gathering does not hide alias: {rows}"
    assert 0 < rows[64]["patches"][1] < 0.2, f"hemicube and rays disagree: {rows}"
