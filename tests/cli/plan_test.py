"""luxel plan: what it prints and writes, and when it fails a build.

usage: plan_test.py LUXEL [unittest arguments]
"""
import json
import os
import sys
import unittest

import cli_test
from cli_test import BAD_INPUT, FURNACE, SAMPLES, STOPPED_EARLY, Case, run

FOUND = 8


class Plan(Case):
    def plan(self, source, *arguments):
        done = run("plan", source, "--texels-per-metre", "8", "--report", self.path("plan.json"), *arguments)
        with open(self.path("plan.json"), encoding="utf-8") as file:
            return done, json.load(file)

    def test_says_what_the_bake_does(self):
        two_rooms = os.path.join(SAMPLES, "two_rooms", "two_rooms.gltf")
        done, plan = self.plan(two_rooms)
        self.assert_done(done)
        self.assertEqual(sorted(os.listdir(self.folder)), ["plan.json"])
        # The bake works with just what the plan says, and not with less.
        least = -(-plan["memory"]["floor_bytes"] >> 20)
        small = ("bake", two_rooms, "-o", self.output, "--texels-per-metre", "8")
        self.assert_refused(run(*small, "--memory", f"{least // 2}M"), cli_test.BUDGET_TOO_SMALL, "--memory")
        self.assert_done(run(*small, "--memory", f"{least}M"))
        baked = run("bake", two_rooms, "-o", self.output, "--texels-per-metre", "8", "--quality", "draft", "--report", self.path("bake.json"))
        self.assert_done(baked)
        with open(self.path("bake.json"), encoding="utf-8") as file:
            bake = json.load(file)
        for count in plan["counts"]:
            self.assertEqual(plan["counts"][count], bake["counts"][count], count)
        skipped = {part["part"] for part in plan["decisions"] if not part["runs"]}
        self.assertIn("sky", skipped)
        for part in bake["skipped"]:
            self.assertIn(part["part"], skipped | {"gather"})
        for part in skipped - {"gather"}:
            self.assertIn(part, {part["part"] for part in bake["skipped"]})
        self.assertIn("skip sky", done.stdout)

    def test_says_what_is_forced(self):
        runs = {part["part"]: (part["runs"], part["why"]) for part in self.plan(FURNACE, "--force-all")[1]["decisions"]}
        for part in ("see-through", "back-patches", "lamps", "disk"):
            self.assertTrue(runs[part][0], part)
            self.assertTrue(runs[part][1].startswith("forced, though "), runs[part][1])
        self.assert_refused(run("plan", FURNACE, "--force", "sky,clouds"), cli_test.USAGE, "--force", "clouds", "dark-patches")
        self.assert_refused(run("plan", FURNACE, "--force", "sky", "--force-all"), cli_test.USAGE, "--force-all")

    def test_foresees_what_presets_take(self):
        done, plan = self.plan(FURNACE)
        self.assert_done(done)
        draft, medium, high, reference = plan["forecasts"]
        self.assertEqual([f["quality"] for f in plan["forecasts"]], ["draft", "medium", "high", "reference"])
        for less, more in ((draft, medium), (medium, high), (high, reference)):
            for key in ("evidence_rays", "gather_rays"):
                self.assertLess(less[key], more[key], key)
        # With many rays all pairs that there are have been found.
        for key in ("pairs", "matrix_bytes", "peak_bytes"):
            self.assertLess(draft[key], high[key], key)
        for foreseen in plan["forecasts"]:
            self.assertEqual(sorted(foreseen["seconds_of"]), ["geometry", "light", "matrix", "write"])
            self.assertAlmostEqual(foreseen["seconds"], sum(foreseen["seconds_of"].values()))
            self.assertIn(foreseen["quality"], done.stdout)
        self.assertEqual(draft["gather_rays"], 0)
        self.assertEqual(draft["seconds_of"]["light"], 0)
        self.assertEqual(medium["gather_rays"], 128 * plan["counts"]["texels"])
        # Whatever the time, numbers are the same.
        again = self.plan(FURNACE, "--threads", "1")[1]["forecasts"]
        counts = [[f[key] for key in ("evidence_rays", "gather_rays", "pairs", "matrix_bytes")] for f in (*plan["forecasts"], *again)]
        self.assertEqual(counts[:4], counts[4:])

    def test_foresees_hemicubes(self):
        plan = self.plan(FURNACE, "--estimator", "hemicube")[1]
        self.assert_done(run("bake", FURNACE, "-o", self.output, "--texels-per-metre", "8", "--quality", "draft", "--estimator", "hemicube", "--report", self.path("bake.json")))
        with open(self.path("bake.json"), encoding="utf-8") as file:
            bake = json.load(file)
        draft = plan["forecasts"][0]
        self.assertEqual(draft["evidence_rays"], bake["evidence"]["rays"])
        for foreseen, found in ((draft["pairs"], bake["counts"]["pairs"]), (draft["matrix_bytes"], bake["store"]["bytes"])):
            self.assertLess(abs(foreseen / found - 1), 0.5, (foreseen, found))

    def test_a_bake_takes_what_there_is_time_for(self):
        def bake(name, *arguments):
            done = run("bake", FURNACE, "-o", self.path(name + ".glb"), "--texels-per-metre", "4", "--report", self.path("bake.json"), *arguments)
            self.assert_done(done)
            with open(self.path("bake.json"), encoding="utf-8") as file:
                report = json.load(file)
            with open(self.path(name + ".lightmap0.exr"), "rb") as file:
                return done, report, file.read()

        done, slow, page = bake("slow", "--target-seconds", "1e6")
        self.assertIn("--quality high --gather-rays 2048, foreseen to take", done.stdout)
        self.assertEqual((slow["settings"]["quality"], slow["settings"]["gather-rays"]), ("high", "2048"))
        self.assertEqual(page, bake("same", "--quality", "high", "--gather-rays", "2048")[2])
        done, fast, page = bake("fast", "--target-seconds", "1e-3")
        self.assertIn("target-not-reached", done.stderr)
        self.assertEqual((fast["settings"]["quality"], fast["settings"]["gather-rays"]), ("draft", "0"))
        self.assertEqual(page, bake("same", "--quality", "draft")[2])
        self.assert_refused(run("bake", FURNACE, "-o", self.output, "--target-seconds", "5", "--quality", "high"), 1, "--target-seconds", "--quality")

    def test_fails_on_what_is_named(self):
        def spoil(document):
            document["nodes"].append(dict(document["nodes"][0]))   # the same wall again
            document["scenes"][0]["nodes"].append(len(document["nodes"]) - 1)

        source = self.scene(spoil)
        done, plan = self.plan(source)
        self.assert_done(done)
        self.assertIn("coincident-faces", [finding["code"] for finding in plan["findings"]])
        self.assertIn("[coincident-faces]", done.stdout)
        self.assertEqual(self.plan(source, "--fail-on", "dark-lamps,coincident-faces")[0].returncode, FOUND)
        self.assertEqual(self.plan(source, "--fail-on", "any", "-q")[0].returncode, FOUND)
        self.assert_done(self.plan(source, "--fail-on", "dark-lamps")[0])
        self.assert_done(self.plan(FURNACE, "--fail-on", "coincident-faces,dark-fronts")[0])

    def test_refuses(self):
        self.assert_refused(run("plan", FURNACE, "--fail-on", "mould"), 1, "--fail-on", "mould", "coincident-faces")
        self.assert_refused(run("plan", self.path("gone.gltf")), BAD_INPUT, "gone.gltf", "no such file")

    def test_leaves_nothing_behind_when_it_is_stopped(self):
        os.mkdir(self.path("temporary"))
        stopped = run("plan", FURNACE, "--stop-after", "0", environment={"TMPDIR": self.path("temporary")})
        self.assert_refused(stopped, STOPPED_EARLY, "furnace.gltf", "stopped before the plan was complete")
        self.assertEqual(os.listdir(self.path("temporary")), [])


if __name__ == "__main__":
    cli_test.LUXEL = os.path.abspath(sys.argv.pop(1))
    unittest.main()
