"""The rules of presets.py on made-up figures, and its tables."""
import contextlib
import io
import os
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tools", "scripts"))
import presets  # noqa: E402
from ladder import rules, scenes, sweeps, tables  # noqa: E402

AIMS = {"draft": 0.2, "medium": 0.05, "high": 0.02, "reference": 0.01}


def setting(text):
    """"high rays=256" """
    quality, *rest = text.split()
    return tuple(sorted([("quality", quality)] + [tuple(part.split("=")) for part in rest]))


def sweep(name, noise, points):
    """`points`: text -> (seconds, error)"""
    measured = {setting(text): sweeps.Measure(seconds, seconds + 1, error, 2 * error, error) for text, (seconds, error) in points.items()}
    return sweeps.Sweep(name, 1000, noise, measured)


def figures(points, noise=0.0, more=()):
    return rules.Figures([sweep("room", noise, points), *more])


LADDER = {"draft": (1, 0.1), "medium": (4, 0.04), "high": (16, 0.015), "reference": (100, 0.005)}


class Rules(unittest.TestCase):
    def test_step_is_the_least_over_scenes(self):
        other = dict(LADDER, medium=(4, 0.07))
        found = figures(LADDER, more=[sweep("hall", 0.0, other)]).step(rules.preset("draft"), rules.preset("medium"))
        self.assertAlmostEqual(0.1 / 0.07, found.least)
        self.assertEqual(("hall", 1), (found.scene, found.missed))

    def test_floor_is_no_step(self):
        found = figures(LADDER, noise=0.02).step(rules.preset("medium"), rules.preset("high"))
        self.assertEqual((float("inf"), "", 0), (found.least, found.scene, found.missed))

    def test_errors_are_not_below_the_floor(self):
        self.assertEqual(0.02, figures(LADDER, noise=0.02).error(rules.preset("high"), "room"))
        self.assertEqual(rules.LEAST_FLOOR, figures(dict(LADDER, high=(1, 0.0))).error(rules.preset("high"), "room"))

    def test_exact_scenes_do_not_count(self):
        exact = sweep("furnace", 0.0, {name: (1, 1e-9) for name in LADDER})
        found = figures(LADDER, more=[exact])
        self.assertEqual((["furnace"], ["room"]), (found.exact, found.scenes))
        self.assertEqual(4, found.seconds(rules.preset("medium")))

    def test_excess(self):
        found = figures(dict(LADDER, **{"high rays=256": (10, 0.015), "high rays=64": (8, 0.03)})).excess(rules.preset("high"))
        self.assertEqual(setting("high rays=256"), found.by)
        self.assertAlmostEqual(0.6, found.share)

    def test_reference_gains_nothing_by_three_bakes(self):
        found = sweep("room", 0.0, dict(LADDER, **{"reference rays=64": (50, 0.005)}))
        found.points[rules.preset("reference")] = sweeps.Measure(100, 101, 0.004, 0.01, 0.005)
        self.assertAlmostEqual(1.0, rules.Figures([found]).excess(rules.preset("reference")).share)

    def test_better_is_not_much_worse_anywhere(self):
        points = dict(LADDER, **{"high rays=256": (10, 0.01)})
        worse = dict(LADDER, **{"high rays=256": (10, 0.018)})
        self.assertEqual((), figures(points, more=[sweep("hall", 0.0, worse)]).excess(rules.preset("high")).by)
        little = dict(LADDER, **{"high rays=256": (10, 0.016)})
        self.assertEqual(setting("high rays=256"), figures(points, more=[sweep("hall", 0.0, little)]).excess(rules.preset("high")).by)

    def test_only_settings_of_all_scenes(self):
        found = figures(dict(LADDER, **{"high rays=256": (1, 0.001)}), more=[sweep("hall", 0.0, LADDER)])
        self.assertEqual(4, len(found.settings))

    def test_derive(self):
        points = dict(LADDER, **{"medium rays=64": (3, 0.06), "high rays=256": (12, 0.02), "reference rays=64": (50, 0.011)})
        found = rules.derive(figures(points), AIMS)
        self.assertEqual([rules.preset("draft"), rules.preset("medium"), setting("high rays=256"), rules.preset("reference")],
                         [rung.setting for rung in found])
        self.assertTrue(all(rung.keeps for rung in found))

    def test_derive_says_where_nothing_keeps_the_rules(self):
        found = rules.derive(figures(dict(LADDER, reference=(100, 0.009))), AIMS)
        self.assertEqual((rules.preset("reference"), False), (found[-1].setting, found[-1].keeps))


class Reference(unittest.TestCase):
    def test_three_bakes(self):
        for a, b, c in ((1.0, 2.0, 4.0), (0.0, 1.0, -3.0), (1.0, 1.0, 1.5)):
            mean = (a + b) / 2
            v = (a - b) ** 2 / 4
            about_mean = sum((x - (a + b + c) / 3) ** 2 for x in (a, b, c))
            self.assertAlmostEqual(about_mean / 2, sweeps.of_three(v ** 0.5, ((c - mean) ** 2 - v) ** 0.5) ** 2)


class Tables(unittest.TestCase):
    def test_report(self):
        text, kept = presets.report([sweep("room", 0.001, LADDER)], AIMS)
        self.assertTrue(kept)
        self.assertIn("| room | 1,000 | 0.1 % | 1 of 2 | 10 %, 20 % | 4 of 5 | 4 %, 8 % | 2.5 |", text)
        text, kept = presets.report([sweep("room", 0.001, dict(LADDER, high=(16, 0.03)))], AIMS)
        self.assertFalse(kept)
        self.assertIn("1.33 (room; 1 below 2)", text)
        self.assertIn("The presets are others: high", text)
        text, _ = presets.report([sweep("room", 0.001, dict(LADDER, **{"high rays=256": (16, 0.015)}))], AIMS)
        self.assertIn("The presets are these", text)

    def test_nothing_to_compare(self):
        for points in ({name: (1, 0.0) for name in LADDER}, {"draft": (1, 0.1)}):
            with self.assertRaises(SystemExit):
                presets.report([sweep("room", 0.001, points)], AIMS)

    def test_names(self):
        self.assertEqual("high, rays 256, gather-rays 512, share off", tables.name_of(setting("high share=off gather-rays=512 rays=256")))

    def test_missing_scenes_are_named(self):
        messages = io.StringIO()
        with contextlib.redirect_stderr(messages), self.assertRaises(SystemExit):
            sys.argv = ["presets.py", "--work", "/nowhere", "--shared", "/nowhere", "--scenes", "zdm2"]
            presets.main()
        self.assertIn("zdm2 is left out", messages.getvalue())
        self.assertTrue(all(os.path.exists(s.path("")) for s in scenes.SCENES if "{shared}" not in s.file))


if __name__ == "__main__":
    unittest.main()
