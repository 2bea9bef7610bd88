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
        self.assertIn("skip sky", done.stdout)

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
