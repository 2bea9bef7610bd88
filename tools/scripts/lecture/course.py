"""Gathering against shooting: what a partial solution is worth; and what the ambient term does to it."""
import csv
import os

from lecture.common import Chart, run, sample, save_charts, table

# Scene, options of partial_light, camera (place, target; None: one that is looked for), pixels of a picture.
SCENES = {"cornell_box": (["--density", "48"], ((0.278, 0.273, -0.5), (0.278, 0.273, 0.28)), (190, 180)),
          "two_rooms": (["--density", "12", "--patch-texels", "6"], None, (230, 160))}
# How often a read of the half matrix serves a row: one that gathers takes every pair both ways, a shot only from its own row.
SOLVERS = {"gather": (1.0, "#239b56", "gathering, Gauss-Seidel"), "jacobi": (1.0, "#7d6608", "gathering, Jacobi"), "shoot-patch": (0.5, "#c0392b", "shooting")}
# The same in the blocks of a bake, on a finer mesh, beside luxel's own solver.
BLOCKS = ("two_rooms", ["--density", "24", "--chunk-patches", "512", "--rays", "256"],
          {"jacobi": "gathering, Jacobi", "gather": "gathering, Gauss-Seidel by blocks", "shoot-patch": "shooting by patches", "shoot": "luxel: shooting by rooms, coarse model"})
REPEATS = 3   # the least of so many times is told
SWEEPS = [0.02, 0.1, 0.5, 1, 2, 4]   # of the table
GATHERED_AT, SHOT_AT, AMBIENT_AT = [1, 2], [0.1, 1, 2], [0.02, 0.1, 1]   # of the pictures


def follow(setting, scene):
    """Solver -> [{sweeps, error, error_ambient, light, light_ambient, seconds}], and the folder of the lightmaps."""
    folder = os.path.join(setting.work, "course", scene)
    table_path = os.path.join(folder, "course.csv")
    if not os.path.exists(table_path):
        pictures_at = {"gather": GATHERED_AT, "shoot-patch": SHOT_AT + AMBIENT_AT}
        at = [] if setting.quick else sorted({reads_text(solver, w) for solver, all_sweeps in pictures_at.items() for w in all_sweeps}, key=float)
        rays = "256" if setting.quick else "1024"
        run([setting.partial_light, sample(scene), "--out", folder, "--row-by-row", "--solver", *SOLVERS, "--error", "1e-3", "--rays", rays,
             "--work", os.path.join(setting.work, "course", scene + ".work"), *SCENES[scene][0], *(["--at", *at] if at else [])])
    lines = {name: [] for name in SOLVERS}
    with open(table_path, encoding="utf-8", newline="") as file:
        for line in csv.DictReader(file):
            name = line.pop("solver")
            numbers = {key: float(value) for key, value in line.items()}
            lines[name].append({"sweeps": numbers["reads"] * SOLVERS[name][0], **numbers})
    return lines, folder


def in_blocks(setting):
    """Prints reads and processor time until the light is right, where the matrix comes in blocks."""
    scene, options, solvers = BLOCKS
    folder = os.path.join(setting.work, "course", scene + ".blocks")
    runs = []
    for _ in range(REPEATS):
        run([setting.partial_light, sample(scene), "--out", folder, "--solver", *solvers, "--error", "1e-2", *options])
        with open(os.path.join(folder, "course.csv"), encoding="utf-8", newline="") as file:
            runs.append(list(csv.DictReader(file)))

    def until(name, error):
        steps = [next(s for s in lines if s["solver"] == name and float(s["error"]) <= error) for lines in runs]
        reads = float(steps[0]["reads"])
        return (f"{reads:,.0f}" if reads >= 100 else f"{reads:.2g}") + f"; {min(float(s['seconds']) for s in steps):.2g} s"
    print(f"{scene} in chunks of 512 patches: reads of the half matrix, and seconds of processor time, until the error is\n")
    table(["solver", "10 %", "1 %"], [[text, until(name, 0.1), until(name, 0.01)] for name, text in solvers.items()])


def reads_text(solver, sweeps):
    """In reads of the half matrix, as partial_light counts and names its lightmaps."""
    return f"{sweeps / SOLVERS[solver][0]:g}"


def at(steps, sweeps):
    """The last step that took no more than so many sweeps."""
    return max((s for s in steps if s["sweeps"] <= sweeps * 1.0001), key=lambda s: s["sweeps"])


def sweeps_until(steps, error, key="error"):
    return next((s["sweeps"] for s in steps if s[key] <= error), float("nan"))


def charts(results):
    out = []
    for scene, lines in results.items():
        chart = Chart(scene, "rows used / N; dashed: with the ambient term", "error of the light", (0.003, 20), (1e-3, 1), (True, True), (10, 60))
        chart.ticks(0, [0.01, 0.1, 1, 10], lambda v: f"{v:g}")
        chart.ticks(1, [1e-3, 1e-2, 1e-1, 1], lambda v: f"{v:g}")
        for row, (name, (_, colour, text)) in enumerate(SOLVERS.items()):
            for key, dash in (("error", ""), ("error_ambient", "5 3")):
                steps = [(s["sweeps"], s[key]) for s in lines[name] if s["sweeps"] > 0 and s[key] >= 1e-3]
                chart.line(thinned(steps), colour, None if dash else text, row, dash, dots=name != "shoot-patch" and not dash)
        out.append(chart)
    return out


def thinned(points):
    """Every point that is three per cent further than the last one."""
    kept = points[:1]
    for point in points[1:]:
        if point[0] > kept[-1][0] * 1.03:
            kept.append(point)
    return kept


def pictures(setting, scene, folder):
    """Partial solutions beside each other, all with the exposure of the exact one."""
    import camera as cameras
    import panels
    import render
    exact = render.View(os.path.join(folder, "exact.glb"))
    _, place, panel = SCENES[scene]
    camera = cameras.Camera(*place, 58.0) if place else cameras.search(exact.scene, exact.look, 0)
    exposure = render.automatic_exposure(*exact.shade(camera.position, camera.directions(*panel, 1), True))

    def view(solver, sweeps, more=""):
        return render.View(os.path.join(folder, f"{solver}-{reads_text(solver, sweeps)}{more}.glb"))
    solving = {f"gathering, {w:g} N rows": view("gather", w) for w in GATHERED_AT} | {"solved": exact}
    solving |= {f"shooting, {w:g} N rows": view("shoot-patch", w) for w in SHOT_AT}
    panels.save(panels.sheet(solving, camera, exposure, panel, 3), setting.picture(f"course_{scene}.jpg"), 50000)
    ambient = {f"shooting, {w:g} N rows{text}": view("shoot-patch", w, more) for more, text in (("", ""), ("-ambient", ", ambient")) for w in AMBIENT_AT}
    panels.save(panels.sheet(ambient, camera, exposure, panel, 3), setting.picture(f"ambient_{scene}.jpg"), 50000)


def main(setting):
    results = {}
    for scene in ["two_rooms"] if setting.quick else SCENES:
        lines, folder = follow(setting, scene)
        results[scene] = lines
        print(f"{scene}: error after so many rows / N (of the light, without and with ambient term; light that is there, without and with)\n")
        table(["rows / N", *(text for _, _, text in SOLVERS.values())],
              [[f"{w:g}", *(four(at(lines[name], w)) for name in SOLVERS)] for w in SWEEPS])
        table(["rows / N until the error is", *(text for _, _, text in SOLVERS.values())],
              [[f"{e:g}", *(f"{sweeps_until(lines[name], e):.3g}" for name in SOLVERS)] for e in (0.3, 0.1, 0.03, 0.01, 0.003)])
        if not setting.quick:
            pictures(setting, scene, folder)
    if not setting.quick:
        in_blocks(setting)
        save_charts(setting.picture("course.svg"), charts(results))
    return results


def four(step):
    if step["sweeps"] == 0:
        return "(nothing yet)"
    return f"{100 * step['error']:.3g} / {100 * step['error_ambient']:.3g} %; {100 * step['light']:.3g} / {100 * step['light_ambient']:.3g} %"


def check(results):
    lines = results["two_rooms"]
    shots, sweeps = lines["shoot-patch"], lines["gather"]
    assert at(shots, 0.1)["error"] < 0.6, "a tenth of a sweep of shots has found no light"
    assert at(sweeps, 0.9)["light"] < 1e-6, "gathering has light before its first sweep has ended"
    assert sweeps_until(shots, 0.1) < sweeps_until(sweeps, 0.1), "shooting is not ahead at 10 %"
    assert at(shots, 0.1)["light_ambient"] > 1.5 * at(shots, 0.1)["light"], "the ambient term adds nothing to the first picture"
    for steps in lines.values():
        assert steps[-1]["error"] < 1e-3 and steps[-1]["error_ambient"] < 2e-3, "a solver does not end at the light"
