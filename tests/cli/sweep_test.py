"""luxel sweep: what it measures and writes, that nothing is baked twice, how it goes on, and the page in a browser.

usage: sweep_test.py LUXEL [unittest arguments]
"""
import csv
import html.parser
import json
import os
import shlex
import shutil
import signal
import struct
import subprocess
import sys
import time
import unittest
import zlib

import cli_test
from cli_test import BAD_INPUT, CANNOT_WRITE, SAMPLES, STOPPED_EARLY, USAGE, Case, read, run

CORNELL = os.path.join(SAMPLES, "cornell_box", "cornell_box.gltf")
LAYOUT = ["--texels-per-metre", "24", "--atlas-size", "64"]
GRID = {"points": [{"name": "draft", "quality": "draft", "rays": 32}, {"name": "few rays", "rays": 32, "gather-rays": 8},
                   {"name": "more rays", "rays": 32, "gather-rays": 64}, {"name": "no memory", "rays": 32, "memory": "1M"}]}
MEASURED = ["draft", "few rays", "more rays"]


class Elements(html.parser.HTMLParser):
    """What a page consists of: per SVG the number of circles, rows of the table, pictures, and addresses."""

    def __init__(self, text):
        super().__init__()
        self.circles, self.rows, self.pictures, self.addresses, self.chart = {}, [], [], [], None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "svg":
            self.chart = attributes.get("id")
        if tag == "circle" and self.chart:
            self.circles[self.chart] = self.circles.get(self.chart, 0) + 1
        if tag == "tr" and "id" in attributes:
            self.rows.append(attributes["id"])
        if tag == "img":
            self.pictures.append(attributes["src"])
        self.addresses += [attributes[name] for name in ("src", "href") if name in attributes]


def rgb_rows(png):
    """Width and rows of an 8-bit RGB or RGBA picture, three values a pixel. PNG specification, section 9."""
    width, height, _, colour = struct.unpack(">IIBB", png[16:26])
    size, at, packed = {2: 3, 6: 4}[colour], 8, b""
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        packed += png[at + 8:at + 8 + length] if kind == b"IDAT" else b""
        at += length + 12
    data, rows, above = zlib.decompress(packed), [], bytes(width * size)
    for y in range(height):
        filter_type, row = data[y * (width * size + 1)], bytearray(data[y * (width * size + 1) + 1:(y + 1) * (width * size + 1)])
        for k in range(len(row)):
            left, corner = (row[k - size], above[k - size]) if k >= size else (0, 0)
            if filter_type == 4:
                guess = left + above[k] - corner
                nearest = min((abs(guess - left), 0, left), (abs(guess - above[k]), 1, above[k]), (abs(guess - corner), 2, corner))[2]
            else:
                nearest = (0, left, above[k], (left + above[k]) // 2)[filter_type]
            row[k] = (row[k] + nearest) & 255
        above = bytes(row)
        rows.append(above)
    return width, [[row[k:k + 3] for k in range(0, len(row), size)] for row in rows]


class Sweep(Case):
    def setUp(self):
        super().setUp()
        self.target = self.path("a sweep")
        # Sooner made than two bakes at --quality reference, and good enough for a small grid.
        if self.id().endswith("reference_of_its_own"):
            return
        made = run("bake", CORNELL, "-o", self.path("truth.glb"), *LAYOUT, "--rays", "512", "--gather-rays", "1024", "--seed", "9")
        self.assert_done(made)
        self.truth = ["--reference", self.path("truth.lightmap0.exr")]

    def grid(self, content=None):
        with open(self.path("grid.json"), "w", encoding="utf-8") as file:
            json.dump(GRID if content is None else content, file)
        return self.path("grid.json")

    def arguments(self, *more):
        return ["sweep", CORNELL, "-o", self.target, "--grid", self.grid(), *LAYOUT, *self.truth, *more]

    def results(self):
        with open(os.path.join(self.target, "sweep.json"), encoding="utf-8") as file:
            return json.load(file)

    def bakes(self):
        """Processes that write into the sweep's folder."""
        found = []
        for number in filter(str.isdigit, os.listdir("/proc")):
            try:
                if self.target.encode() in read(f"/proc/{number}/cmdline"):
                    found.append(number)
            except OSError:
                pass  # it has just ended
        return found

    def test_the_three_files_agree_and_nothing_is_baked_twice(self):
        done = run(*self.arguments("--repeats", "2"))
        self.assert_done(done)
        self.assertIn("4 of 4: no memory: failed: ", done.stderr)
        results = self.results()
        points = {point["name"]: point for point in results["points"]}
        self.assertEqual(list(points), [point["name"] for point in GRID["points"]])
        self.assertIn("--memory", points["no memory"]["failed"])
        with open(os.path.join(self.target, "sweep.csv"), encoding="utf-8", newline="") as file:
            rows = {row["name"]: row for row in csv.DictReader(file)}
        for name in MEASURED:
            point, row = points[name], rows[name]
            for key, value in (("seconds", point["seconds"]), ("disk_bytes", point["disk_bytes"]), ("relative_rmse", point["error"]["relative_rmse"]),
                               ("p95", point["error"]["p95"]), ("worst_x", point["error"]["worst"]["x"])):
                self.assertEqual(float(row[key]), value, key)
            self.assertEqual(row["bake"], point["bake"])
            self.assertEqual(int(row["on_front"]), point["on_front"]["seconds"])
            self.assertAlmostEqual(sum(stage["seconds"] for stage in point["stages"]), point["seconds"], delta=1e-9)
            self.assertEqual(len(point["repeat_seconds"]), 2)
        self.assertEqual(rows["no memory"]["failed"], points["no memory"]["failed"])
        self.assertEqual(rows["no memory"]["seconds"], "")
        # Light of the same matrix by more rays: less error; what was reused is charged as if it had been made.
        few, more, draft = points["few rays"], points["more rays"], points["draft"]
        self.assertLess(more["error"]["relative_rmse"], few["error"]["relative_rmse"])
        self.assertLess(more["error"]["predicted"], few["error"]["predicted"])
        self.assertIsNone(draft["error"]["predicted"])
        self.assertTrue(more["on_front"]["seconds"])
        stages = {name: {stage["name"]: stage["seconds"] for stage in points[name]["stages"]} for name in MEASURED}
        for stage in ("unwrap", "evidence"):
            self.assertEqual(stages["few rays"][stage], stages["draft"][stage], "of one making")
        self.assertEqual(stages["more rays"]["solve"], stages["few rays"]["solve"])
        self.assertNotEqual(stages["more rays"]["light"], stages["few rays"]["light"])

        page = Elements(read(os.path.join(self.target, "sweep.html")).decode())
        self.assertEqual(page.circles, {**{chart: 3 for chart in ("time", "memory", "disk")}, "predicted": 2})
        self.assertEqual(len(page.rows), 4)
        self.assertEqual(len(page.pictures), 3)
        for address in page.addresses:
            self.assertRegex(address, r"^(#|data:image/png;base64,)")

        # Failed points are tried again, the others are there.
        again = run(*self.arguments("--repeats", "2"))
        self.assert_done(again)
        self.assertEqual(again.stderr.count("measured before"), 3)
        self.assertIn("4 of 4: no memory: failed: ", again.stderr)
        self.assertEqual(self.results(), results)

    def test_goes_on_after_a_kill(self):
        process = subprocess.Popen([cli_test.LUXEL, *self.arguments()], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        points = os.path.join(self.target, "points")
        end = time.monotonic() + 60
        while time.monotonic() < end and not (os.path.isdir(points) and any(name.endswith(".json") for name in os.listdir(points))):
            time.sleep(0.002)
        process.send_signal(signal.SIGKILL)
        process.wait()
        end = time.monotonic() + 10
        while self.bakes() and time.monotonic() < end:
            time.sleep(0.01)
        self.assertEqual(self.bakes(), [], "the bake ended with the sweep")
        before = {name: read(os.path.join(points, name)) for name in os.listdir(points) if name.endswith(".json")}
        self.assertTrue(before)
        self.assertFalse(os.path.exists(os.path.join(self.target, "sweep.html")))
        done = run(*self.arguments())
        self.assert_done(done)
        self.assertEqual(done.stderr.count("measured before"), len(before))
        for name, content in before.items():
            self.assertEqual(read(os.path.join(points, name)), content)
        self.assertEqual(len(self.results()["points"]), 4)

    def test_an_interrupt_keeps_what_was_measured(self):
        process = subprocess.Popen([cli_test.LUXEL, *self.arguments()], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        line = process.stderr.readline()
        self.assertIn("1 of 4: draft: ", line)
        process.send_signal(signal.SIGINT)
        output, messages = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, messages)
        results = self.results()
        self.assertTrue(results["interrupted"])
        self.assertIn("draft", [point["name"] for point in results["points"]])

    def test_the_line_of_a_target_bakes(self):
        done = run(*self.arguments("--target-error", "10", "--target-disk", "1G"))
        self.assert_done(done)
        line = shlex.split(done.stdout.splitlines()[-1])
        fastest = min((point for point in self.results()["points"] if "failed" not in point), key=lambda point: point["seconds"])
        self.assertEqual(line, shlex.split(fastest["bake"]))
        self.assertEqual(line[:4], ["luxel", "bake", CORNELL, "-o"])
        baked = subprocess.run([cli_test.LUXEL, *line[1:]], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assert_done(baked)
        self.assertTrue(os.path.isfile(self.path("out/cornell_box.glb")))
        nothing = run(*self.arguments("--target-error", "1e-6"))
        self.assertEqual(nothing.returncode, STOPPED_EARLY)
        self.assertIn("no measured point meets the targets", nothing.stderr)
        self.assertIsNone(self.results()["chosen"])

    def test_reference_of_its_own(self):
        few = ["sweep", CORNELL, "-o", self.target, "--texels-per-metre", "3", "--atlas-size", "32", "--grid"]
        done = run(*few, self.grid({"axes": {"gather-rays": [8], "rays": [16]}}))
        self.assert_done(done)
        self.assertEqual(done.stderr.count("luxel: reference, seed"), 2)
        error = self.results()["points"][0]["error"]
        self.assertGreater(error["reference_noise"], 0)
        self.assertLess(error["reference_noise"], error["relative_rmse"] / 5)
        # Another grid finds it.
        other = run(*few, self.grid({"axes": {"gather-rays": [16], "rays": [16]}}))
        self.assert_done(other)
        self.assertNotIn("luxel: reference, seed", other.stderr)
        # Other light is another reference, and another point.
        changed = run(*few, self.path("grid.json"), "--sky-color", "100")
        self.assert_done(changed)
        self.assertEqual(changed.stderr.count("luxel: reference, seed"), 2)
        self.assertNotIn("measured before", changed.stderr)

    def test_refuses(self):
        def refused(code, *words, grid=None, more=()):
            self.assert_refused(run("sweep", CORNELL, "-o", self.target, "--grid", self.grid(grid), *LAYOUT, *self.truth, *more), code, *words)
            self.assertFalse(os.path.exists(os.path.join(self.target, "sweep.html")))

        refused(USAGE, 'point "photons 3"', "no option --photons", grid={"axes": {"photons": [3]}})
        refused(USAGE, 'point "rays 1"', "--rays", grid={"axes": {"rays": [1]}})
        refused(USAGE, 'point "gather-rays 3"', "a power of two", grid={"axes": {"gather-rays": [3]}})
        refused(USAGE, "--texels-per-metre changes what is baked", grid={"axes": {"texels-per-metre": [3]}})
        refused(USAGE, "--aov is set by the sweep itself", grid={"axes": {"aov": ["valid"]}})
        refused(BAD_INPUT, "more than 500 points", grid={"axes": {"seed": list(range(100)), "rays": list(range(100))}})
        refused(BAD_INPUT, "grid.json", "expected a JSON object", grid=[1])
        refused(USAGE, "--work", "set by the sweep itself", more=("--work", self.path("work")))
        self.assert_refused(run("sweep", CORNELL, "-o", self.target, "--grid", "everything"), BAD_INPUT, "everything", "default, rays, presets")
        self.assert_refused(run("sweep", CORNELL, "-o", self.grid()), CANNOT_WRITE, "name a folder")
        self.assert_refused(run("sweep", self.path("gone.glb"), "-o", self.target), BAD_INPUT, "gone.glb", "no such file")
        one = self.grid({"points": [{"rays": 16, "gather-rays": 8}]})
        self.assert_refused(run("sweep", CORNELL, "-o", self.target, "--grid", one, "--texels-per-metre", "3", "--atlas-size", "32", "-q", *self.truth), BAD_INPUT,
                            "expected 32 x 32 texels as in the bake, found 64 x 64")
        self.assert_refused(run("sweep", CORNELL, "-o", self.target, "--grid", one, *LAYOUT, "-q", *self.truth, *self.truth), BAD_INPUT, "expected 1 pages as in the bake, found 2")

    @unittest.skipUnless(shutil.which(os.environ.get("LUXEL_CHROMIUM", "chromium")), "chromium is missing: tools/setup.sh consumers")
    def test_the_page_in_a_browser(self):
        self.assert_done(run(*self.arguments("--target-error", "10")))
        page, picture = os.path.join(self.target, "sweep.html"), self.path("page.png")
        browser = [shutil.which(os.environ.get("LUXEL_CHROMIUM", "chromium")), "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={self.path('profile')}",
                   "--host-resolver-rules=MAP * ~NOTFOUND", "--window-size=1240,1700", "--force-device-scale-factor=1"]
        address = "file://" + page.replace(" ", "%20")
        dom = subprocess.run([*browser, "--dump-dom", address], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120)
        found = Elements(dom.stdout)
        self.assertEqual(found.circles["time"], 3, dom.stderr)
        self.assertEqual(found.circles["predicted"], 2)
        subprocess.run([*browser, f"--screenshot={picture}", address], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120, check=True)
        width, rows = rgb_rows(read(picture))
        self.assertEqual(width, 1240)
        colours = {name: bytes.fromhex(code) for name, code in (("point", "4a6fa5"), ("chosen", "15803d"))}
        counts = {name: sum(row.count(colour) for row in rows) for name, colour in colours.items()}
        # Discs of a radius of about 4 pixels, and rings of 3 pixels around larger ones.
        self.assertGreater(counts["point"], 8 * 30, counts)
        self.assertGreater(counts["chosen"], 3 * 30, counts)


if __name__ == "__main__":
    cli_test.LUXEL = os.path.abspath(sys.argv.pop(1))
    unittest.main()
