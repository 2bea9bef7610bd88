"""`luxel inspect` as its user meets it: what it prints of a bake folder, and that it finds every kind of damage.

usage: inspect_test.py LUXEL [unittest arguments]
"""
import glob
import json
import os
import re
import shutil
import sys
import unittest

import cli_test
from cli_test import BAD_INPUT, DAMAGED_STORE, SAMPLES, USAGE, Case, files_below, run

TWO_ROOMS = os.path.join(SAMPLES, "two_rooms", "two_rooms.gltf")
SETTINGS = ["--quality", "draft", "--texels-per-metre", "3", "--atlas-size", "128", "--patch-texels", "2",
            "--chunk-patches", "64", "--rays", "256", "-q"]


class Folder(Case):
    """One bake for all tests of a class; each works on a copy."""

    @classmethod
    def setUpClass(cls):
        cls.made = cli_test.tempfile.mkdtemp(prefix="luxel-inspect-")
        cls.addClassCleanup(shutil.rmtree, cls.made, ignore_errors=True)
        result = run("bake", TWO_ROOMS, "-o", os.path.join(cls.made, "scene.glb"), "--work", os.path.join(cls.made, "work"), *SETTINGS)
        assert result.returncode == 0, result.stderr

    def setUp(self):
        super().setUp()
        self.work = self.path("work")
        shutil.copytree(os.path.join(self.made, "work"), self.work)

    def find(self, pattern):
        return sorted(glob.glob(os.path.join(self.work, pattern)))

    def verify(self, *arguments):
        return run("inspect", self.work, "--verify", *arguments)

    def json(self, *arguments, code=0):
        result = run("inspect", self.work, "--json", "-", *arguments)
        self.assertEqual(result.returncode, code, result.stderr)
        return json.loads(result.stdout)


class Prints(Folder):
    def test_text_has_every_figure(self):
        result = run("inspect", self.work)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        for words in (r"patches +\d+, [\d.]+ m2, in \d+ chunks of \d+ to \d+", r"pairs +\d+ in \d+ blocks, [\d.]+ % of all possible",
                      r"strips +[\d.]+ .?B, [\d.]+ bytes per pair", r"evidence +\d+ rays \(ray\)",
                      r"row sums +[\d.]+ to [\d.]+, mean [\d.]+", r"closure +\d+ iterations", r"largest rows\n    patch \d+ "):
            self.assertRegex(result.stdout, words)

    def test_json_is_the_folder(self):
        found = self.json("--rows", "3")
        matrix = found["matrix"]
        strips = self.find("strips-*/*")
        self.assertEqual(matrix["chunks"]["count"], len(strips))
        self.assertEqual(matrix["bytes"], sum(os.path.getsize(path) for path in strips))
        self.assertEqual(sum(stage["bytes"] for stage in found["stages"]),
                         sum(os.path.getsize(os.path.join(self.work, name)) for name in files_below(self.work)))
        self.assertEqual(found["bakes"], [matrix["key"]])
        self.assertAlmostEqual(matrix["density"], 2 * matrix["pairs"] / matrix["patches"] / (matrix["patches"] - 1), places=12)
        self.assertAlmostEqual(matrix["bytes_per_pair"], matrix["bytes"] / matrix["pairs"], places=12)
        self.assertEqual(len(matrix["largest_rows"]), 3)
        pairs = [row["pairs"] for row in matrix["largest_rows"]]
        self.assertEqual(pairs, sorted(pairs, reverse=True))
        self.assertEqual(len(matrix["evidence"]["rounds"]), len(self.find("evidence-*")))
        self.assertLess(matrix["row_sums"]["error"], 1e-9)
        self.assertLessEqual(matrix["row_sums"]["most"], 1 + 1e-9)
        self.assertNotIn("verify", found)

    def test_verify_of_a_whole_folder(self):
        result = self.verify()
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("no problems", result.stdout)
        verify = self.json("--verify")["verify"]
        self.assertTrue(verify["passed"] and verify["recounted"] and verify["flux"]["passed"])
        self.assertEqual((verify["findings"], verify["not_checked"]), ([], ""))
        self.assertEqual(verify["files"], len(files_below(self.work)))
        self.assertEqual(verify["bytes"], sum(os.path.getsize(os.path.join(self.work, name)) for name in files_below(self.work)))

    def test_json_to_a_file_and_quiet(self):
        result = run("inspect", self.work, "-q", "--json", self.path("report.json"))
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))
        with open(self.path("report.json"), encoding="utf-8") as file:
            self.assertEqual(json.load(file), self.json())

    def test_does_not_depend_on_threads_and_memory(self):
        self.assertEqual(self.json("--verify"), self.json("--verify", "--threads", "1", "--memory", "1"))

    def test_refusals(self):
        self.assert_refused(run("inspect", self.path("missing")), BAD_INPUT, "missing")
        self.assert_refused(run("inspect", TWO_ROOMS), BAD_INPUT, "two_rooms.gltf")
        os.makedirs(self.path("empty"))
        self.assert_refused(run("inspect", self.path("empty")), BAD_INPUT, "empty")
        self.assert_refused(run("inspect", self.work, "--key", "zz"), BAD_INPUT, "zz")
        self.assertEqual(run("inspect").returncode, USAGE)
        self.assertEqual(run("inspect", self.work, "--memory", "lots").returncode, USAGE)

    def test_a_folder_without_a_matrix_is_checked_too(self):
        for path in self.find("patches-*"):
            os.remove(path)
        self.assertEqual(run("inspect", self.work).returncode, 0)
        found = self.json("--verify")
        self.assertNotIn("matrix", found)
        self.assertTrue(found["verify"]["passed"])
        self.flip(self.find("evidence-*/*")[0], 100)
        self.assertEqual(self.verify().returncode, DAMAGED_STORE)

    def flip(self, path, at):
        with open(path, "r+b") as file:
            file.seek(at)
            byte = file.read(1)[0]
            file.seek(at)
            file.write(bytes([byte ^ 0x10]))

    def test_a_temporary_of_a_killed_run_is_no_damage(self):
        left = [os.path.join(place, "chunk-0.lxe.tmp-123456789-4") for place in (self.work, os.path.dirname(self.find("evidence-*/*")[0]))]
        for path in left:
            open(path, "wb").close()
        result = self.verify()
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("2 temporary files of stopped runs", result.stdout)
        # The next bake removes them: no process has this number.
        result = run("bake", TWO_ROOMS, "-o", self.path("scene.glb"), "--work", self.work, *SETTINGS)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertFalse(any(os.path.exists(path) for path in left))


class Hemicube(Case):
    def test_has_no_standard_error(self):
        hemicube = ["--estimator", "hemicube", "--hemicube-resolution", "8", "--work", self.path("work")]
        result = self.bake(*hemicube, "--report", self.path("report.json"))
        self.assert_done(result)
        self.assertNotIn("standard error", result.stdout)
        with open(self.path("report.json"), encoding="utf-8") as file:
            report = json.load(file)
        self.assertIsNone(report["evidence"]["standard_error"])
        self.assertEqual([part["part"] for part in report["skipped"] if "standard error" in part["why"]], ["accuracy"])
        verified = run("inspect", self.path("work"), "--verify")
        self.assertEqual(verified.returncode, 0, verified.stderr)
        self.assertIn("not checked  the flux self-check: counts of the hemicube estimator do not scatter", verified.stdout)
        shutil.rmtree(self.out)
        self.assert_refused(self.bake(*hemicube, "--error", "0.1"), USAGE, "--error", "hemicube")


class Damage(Folder):
    flip = Prints.flip

    def assert_found(self, path, *patterns):
        result = self.verify()
        self.assertEqual(result.returncode, DAMAGED_STORE, path)
        self.assertIn(os.path.relpath(path, self.work), result.stderr)
        for pattern in patterns:
            self.assertRegex(result.stderr, pattern)
        findings = self.json("--verify", code=DAMAGED_STORE)["verify"]["findings"]
        self.assertTrue(any(os.path.relpath(path, self.work) in finding["where"] for finding in findings), findings)
        self.assertRegex(result.stdout, r"result +\d+ problem")

    def one_of_each(self):
        """A file of every stage."""
        found = {}
        for name in files_below(self.work):
            found.setdefault(name.split("-")[0], os.path.join(self.work, name))
        self.assertGreaterEqual(set(found), {"atlas", "evidence", "strips", "patches", "closure", "solution", "lightmaps", "accuracy", "plan"})
        return list(found.values())

    def with_each(self, damage, *patterns):
        for path in self.one_of_each():
            with self.subTest(os.path.relpath(path, self.work)):
                with open(path, "rb") as file:
                    before = file.read()
                try:
                    damage(path, len(before))
                    self.assert_found(path, *patterns)
                finally:
                    with open(path, "wb") as file:
                        file.write(before)
        self.assertEqual(self.verify().returncode, 0)

    def test_flipped_byte_in_a_block(self):
        # The first block follows a header of 48 bytes (formats/base/block_file.md).
        self.with_each(lambda path, size: self.flip(path, 48), r"block 0 at byte \d+: checksum mismatch")

    def test_flipped_byte_in_header_and_footer(self):
        self.with_each(lambda path, size: self.flip(path, 0))
        self.with_each(lambda path, size: self.flip(path, size - 1))

    def test_cut(self):
        self.with_each(lambda path, size: os.truncate(path, size // 2))

    def test_empty(self):
        self.with_each(lambda path, size: os.truncate(path, 0))

    def test_replaced_by_another_of_the_folder(self):
        rounds = self.find("evidence-*")
        shutil.copy(os.path.join(rounds[0], "chunk-0.lxe"), os.path.join(rounds[1], "chunk-0.lxe"))
        self.assert_found(os.path.join(rounds[1], "chunk-0.lxe"), "made from other inputs")

    def test_the_same_evidence_twice(self):
        path = self.find("evidence-*/chunk-1.lxe")[0]
        shutil.copy(os.path.join(os.path.dirname(path), "chunk-0.lxe"), path)
        result = self.verify()
        self.assertEqual(result.returncode, DAMAGED_STORE)
        self.assertRegex(result.stderr, "the strip (says|counts)|in no strip")

    def test_missing_and_surplus(self):
        for pattern in ("strips-*/strip-0.lxs", "evidence-*/chunk-1.lxe", "closure-*"):
            path = self.find(pattern)[0]
            os.rename(path, self.path("aside"))
            self.assert_found(path, "missing")
            os.rename(self.path("aside"), path)
        strip = self.find("strips-*/strip-0.lxs")[0]
        surplus = os.path.join(os.path.dirname(strip), "strip-9999.lxs")
        shutil.copy(strip, surplus)
        self.assert_found(surplus, "the bake has only")
        os.rename(surplus, os.path.join(os.path.dirname(strip), "notes.txt"))
        self.assert_found(os.path.join(os.path.dirname(strip), "notes.txt"), "is not a file of strips")

    def test_all_damage_is_listed(self):
        paths = self.one_of_each()
        for path in paths:
            self.flip(path, 48)
        findings = self.json("--verify", code=DAMAGED_STORE)["verify"]["findings"]
        for path in paths:
            self.assertTrue(any(os.path.relpath(path, self.work) in finding["where"] for finding in findings), path)

    def test_without_verify_a_damaged_matrix_is_an_error(self):
        path = self.find("strips-*/strip-0.lxs")[0]
        os.truncate(path, 100)
        self.assert_refused(run("inspect", self.work), DAMAGED_STORE, "strip-0.lxs")

    def test_a_bake_after_the_hint(self):
        """Every message says: remove the file and run the same bake again."""
        path = self.find("strips-*/strip-0.lxs")[0]
        self.flip(path, os.path.getsize(path) // 2)
        self.assertIn("remove the file and run the same bake again", self.verify().stderr)
        os.remove(path)
        result = run("bake", TWO_ROOMS, "-o", self.path("scene.glb"), "--work", self.work, *SETTINGS)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.verify().returncode, 0)


class NotAllStored(Folder):
    """Folders of --store hot and none are whole without strips; what is in them is checked."""

    def setUp(self):
        super().setUp()
        self.whole = self.json()["matrix"]

    def bake(self, store):
        result = run("bake", TWO_ROOMS, "-o", self.path("scene.glb"), "--work", self.work, "--store", store, *SETTINGS)
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_is_told_and_no_damage(self):
        for store in ("hot", "none"):
            self.bake(store)
            result = self.verify()
            self.assertEqual((result.returncode, result.stderr.count("error")), (0, 0), result.stderr)
            self.assertRegex(result.stdout, rf"strips +--store {store}: \d+ of {self.whole['blocks']} blocks kept, .* traced again when needed")
            self.assertRegex(result.stdout, rf"not checked +recount, .*--store {store}\)")
            found = self.json("--verify")
            matrix, verify = found["matrix"], found["verify"]
            for member in ("key", "patches", "blocks", "pairs", "chunks", "closure", "area_m2"):
                self.assertEqual(matrix[member], self.whole[member], member)
            self.assertEqual(matrix["store"]["kind"], store)
            self.assertEqual(matrix["store"]["kept_blocks"] > 0, store == "hot")
            self.assertLess(matrix["store"]["kept_blocks"], matrix["blocks"])
            self.assertEqual(matrix["evidence"]["rays"], self.whole["evidence"]["rays"])
            self.assertNotIn("row_sums", matrix)
            self.assertTrue(verify["passed"])
            self.assertFalse(verify["recounted"])
            kept = self.find("hot-*/*") + self.find("directory-*")
            self.assertEqual(matrix["bytes"], sum(os.path.getsize(path) for path in kept))
            self.assertEqual(verify["files"], len(files_below(self.work)))

    def flip_middle(self, path):
        with open(path, "r+b") as file:
            file.seek(os.path.getsize(path) // 2)
            byte = file.read(1)[0]
            file.seek(os.path.getsize(path) // 2)
            file.write(bytes([byte ^ 0x10]))

    def test_damage_is_found(self):
        self.bake("hot")
        # The strip with most in it: its middle is a block.
        strip = max(self.find("hot-*/*"), key=os.path.getsize)
        for path in (strip, self.find("directory-*")[0]):
            aside = self.path("aside")
            shutil.copy(path, aside)
            self.flip_middle(path)
            result = self.verify()
            self.assertEqual(result.returncode, DAMAGED_STORE, path)
            self.assertIn(os.path.basename(path), result.stderr)
            os.remove(path)
            result = self.verify()
            self.assertEqual(result.returncode, DAMAGED_STORE, path)
            self.assertIn("missing", result.stderr)
            # As every message says: the same bake makes it again, byte for byte.
            self.bake("hot")
            with open(path, "rb") as made, open(aside, "rb") as before:
                self.assertEqual(made.read(), before.read())
            self.assertEqual(self.verify().returncode, 0)

    def test_kept_blocks_of_another_bake(self):
        """A whole file in the wrong place: the directory does not know its blocks."""
        self.bake("hot")
        files = self.find("hot-*/*")
        shutil.copy(files[0], files[1])
        self.assertEqual(self.verify().returncode, DAMAGED_STORE)


if __name__ == "__main__":
    cli_test.LUXEL = os.path.abspath(sys.argv.pop(1))
    unittest.main()
