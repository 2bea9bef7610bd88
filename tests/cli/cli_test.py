"""The program as its user meets it: options, messages, exit codes, and what it leaves on the disk.

usage: cli_test.py LUXEL [unittest arguments]
"""
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import unittest

SAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "samples")
FURNACE = os.path.join(SAMPLES, "furnace", "furnace.gltf")
SMALL = ["--quality", "draft", "--texels-per-metre", "4", "--atlas-size", "64", "--rays", "64"]
USAGE, BAD_INPUT, CANNOT_WRITE, DAMAGED_STORE, STOPPED_EARLY, BUDGET_TOO_SMALL = 1, 2, 4, 5, 6, 7
LUXEL = None


def run(*arguments, limit_file_bytes=None, environment=None):
    def limit():
        if limit_file_bytes is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit_file_bytes, limit_file_bytes))

    # Python ignores SIGXFSZ; not restoring it makes the child see EFBIG instead of dying, as on a full disk.
    return subprocess.run([LUXEL, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          errors="replace", timeout=120, env={**os.environ, **(environment or {})}, restore_signals=limit_file_bytes is None, preexec_fn=limit)


def read(path):
    with open(path, "rb") as file:
        return file.read()


def files_below(folder):
    return sorted(os.path.relpath(os.path.join(where, name), folder)
                  for where, _, names in os.walk(folder) for name in names)


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="luxel-cli-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.out = os.path.join(self.folder, "out")
        self.output = os.path.join(self.out, "scene.glb")

    def path(self, name):
        return os.path.join(self.folder, name)

    def bake(self, *arguments, source=FURNACE, output=None, **options):
        return run("bake", source, "-o", output or self.output, *SMALL, *arguments, **options)

    def assert_done(self, result):
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertNotIn("luxel: error:", result.stderr)

    def assert_refused(self, result, code, *words):
        """One clear message: where, what, and one indented line of what to do."""
        text = result.stderr
        self.assertEqual(result.returncode, code, text)
        lines = text.splitlines()
        errors = [k for k, line in enumerate(lines) if line.startswith("luxel: error: ")]
        self.assertEqual(len(errors), 1, text)
        self.assertRegex(lines[errors[0]], r"^luxel: error: \S.*: \S", "where: what")
        hints = [line for line in lines if line.startswith(" ")]
        self.assertEqual(lines[errors[0] + 1:], hints, "after the error only its hint:\n" + text)
        self.assertEqual(len(hints), 1, text)
        for line in lines[:errors[0]]:
            self.assertRegex(line, r"^luxel: (warning: |[a-z]+ )", text)
        for word in words:
            self.assertIn(word, text)
        for trace in ("terminate called", "what():", "Segmentation", "Sanitizer", "core dumped"):
            self.assertNotIn(trace, text)
        self.assertEqual(result.stdout, "")
        if os.path.isdir(self.out):
            self.assertEqual(files_below(self.out), [])
            self.assertEqual(os.listdir(self.out), [])

    def scene(self, edit, name="scene.gltf", buffer=True):
        """A copy of the furnace with its JSON changed."""
        with open(FURNACE, encoding="utf-8") as file:
            document = json.load(file)
        edit(document)
        with open(self.path(name), "w", encoding="utf-8") as file:
            json.dump(document, file)
        if buffer:
            shutil.copy(os.path.join(SAMPLES, "furnace", "furnace.bin"), self.folder)
        return self.path(name)


class Help(Case):
    # A value that differs from the default, for every option of `luxel bake`.
    VALUES = {"--output": None, "--help": None, "--quality": "draft", "--rays": "100", "--error": "0.5", "--importance": "off",
              "--estimator": "ray", "--hemicube-resolution": "32", "--gather": "on", "--scene": "furnace", "--skip-skinned": "", "--allow-outside": "", "--gather-rays": "8", "--lamp-points": "2", "--max-rays": "16",
              "--tolerance": "0.01", "--solver": "cg", "--patch-texels": "3", "--instances": "split", "--two-sided": "lit", "--interpolation": "catmull-rom", "--texels-per-metre": "3",
              "--atlas-size": "100", "--padding": "1", "--uv": "keep", "--encoding": "linear8", "--lightmap-format": "png8", "--dither": "off", "--profile": "hubs", "--unlit": "", "--unlit-exposure": "0.5", "--seams": "keep", "--aov": "albedo,valid", "--memory": "1G",
              "--share": "3", "--blend-colour": "on", "--bad-values": "refuse", "--threads": "1", "--chunks": "tiles", "--chunk-patches": "64", "--seed": "5", "--work": "{folder}/work",
              "--report": "{folder}/report.json", "--store": "hot", "--store-bytes": "10K", "--force": "lamps,sky", "--force-all": None, "--verify": "", "--quiet": "",
              "--vertex-colours": "off", "--settings": None, "--sky": None, "--sky-color": "1,2,3", "--sky-rotate": "30", "--sky-scale": "2", "--lamp-radius": "0.5", "--sun-angle": "0.5",
              "--draco": "", "--draco-bits": "POSITION=12,LIGHTMAP=16", "--meshopt": "", "--split": "chunks", "--split-triangles": "10",
              "--target-seconds": None, "--stop-after": "1000", "--preview-every": "0.5", "--checkpoint-every": "7"}

    def test_off(self):
        self.assert_refused(run("bake", FURNACE, "-o", self.output, "--gather", "off", "--gather-rays", "8"), 1, "--gather: ")
        self.assert_done(run("bake", FURNACE, "-o", self.output, "--texels-per-metre", "3", "--share", "off", "--gather", "off", "--report", self.path("report.json")))
        with open(self.path("report.json"), encoding="utf-8") as file:
            settings = json.load(file)["settings"]
        self.assertEqual([settings[name] for name in ("share", "gather", "gather-rays")], ["0", "off", "0"])

    def test_help(self):
        for arguments in (["--help"], ["-h"], ["bake", "--help"], ["bake", "-h"]):
            result = run(*arguments)
            self.assertEqual((result.returncode, result.stderr), (0, ""), arguments)
            self.assertIn("bake", result.stdout)

    def test_version(self):
        result = run("--version")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertRegex(result.stdout, r"^luxel \d+\.\d+\.\d+\n$")

    def test_examples_and_defaults_are_shown(self):
        text = run("bake", "--help").stdout
        self.assertEqual(len(re.findall(r"^  luxel bake ", text, re.M)), 5, "five examples")
        for option, default in (("--atlas-size", "1024"), ("--padding", "2"), ("--quality", "medium"), ("--memory", "2G")):
            self.assertRegex(text, option + r"[^\n]*=" + default + r"\b", "its default")

    def test_every_option_of_the_help_is_accepted(self):
        text = run("bake", "--help").stdout.split("Examples:")[0]
        listed = set(re.findall(r"^\s+(?:-\w,)?(--[a-z-]+)", text, re.M))
        self.assertEqual(listed, set(self.VALUES), "the table of this test and the help")
        arguments = []
        for option, value in self.VALUES.items():
            if value is not None:
                arguments += [option] + ([value.format(folder=self.folder)] if value else [])
        result = run("bake", FURNACE, "-o", self.output, *arguments)
        self.assert_done(result)
        self.assertEqual((result.stdout, result.stderr), ("", ""), "--quiet is quiet")
        with open(self.path("report.json"), encoding="utf-8") as file:
            settings = json.load(file)["settings"]
        for option, value in self.VALUES.items():
            if value and option not in ("--report", "--work", "--memory", "--rays", "--report"):
                self.assertEqual(str(settings[option[2:]]), value.format(folder=self.folder), option)

    def test_report_has_its_schema(self):
        self.assert_done(self.bake("--report", self.path("report.json")))
        with open(self.path("report.json"), encoding="utf-8") as file:
            report = json.load(file)
        self.assertEqual(report["schema"], 1)
        for part, members in {
                "dark_fronts": "charts area_m2 area_share turned", "seams": "joined stretches length_m points left_out texels jump_before jump_after",
                "counts": "triangles charts pages texels patches chunks blocks pairs", "store": "kind bytes bytes_per_pair",
                "evidence": "rays rays_traced rays_per_second rounds", "solve": "solver reads error_bound history path path_why checkpoint_resumed",
                "previews": "written seconds", "energy": "emitted absorbed lost", "memory": "budget_bytes peak_bytes"}.items():
            for member in members.split():
                self.assertIn(member, report[part])
        for stage in report["stages"]:
            self.assertLessEqual({"name", "seconds", "processor_seconds", "peak_bytes", "reused"}, set(stage))
        for output in report["outputs"]:
            self.assertLessEqual({"path", "kind", "quantity", "unit", "encoding", "intensity"}, set(output))
            self.assertTrue(os.path.isfile(output["path"].split("#")[0]), output)
        self.assertNotIn("gathering", report, "a draft gathers nothing")
        self.assertIn("stopped", report)
        self.assertIsNone(report["stopped"])
        self.assertIn(report["solve"]["path"], ("in memory", "out of core"))
        self.assertIsInstance(report["warnings"], list)
        self.assertIsInstance(report["skipped"], list)
        self.assertGreater(report["counts"]["pairs"], 0)


class Store(Case):
    def test_choices_change_the_disk_and_not_the_result(self):
        results, kept = {}, {}
        for store in ("all", "hot", "none"):
            self.output = os.path.join(self.folder, store, "scene.glb")
            work = self.path(store + ".luxel")
            self.assert_done(self.bake("--store", store, "--work", work, "--report", self.path("report.json")))
            with open(self.path("report.json"), encoding="utf-8") as file:
                report = json.load(file)
            self.assertEqual(report["store"]["kind"], store)
            folder = os.path.join(self.folder, store)
            results[store] = {name: read(os.path.join(folder, name)) for name in files_below(folder)}
            kept[store] = {name.split("-")[0] for name in files_below(work)}
        self.assertEqual(results["hot"], results["all"])
        self.assertEqual(results["none"], results["all"])
        self.assertEqual(kept["all"] - kept["none"], {"evidence", "strips"})
        self.assertEqual(kept["none"] - kept["all"], {"directory"})
        self.assertEqual(kept["hot"] - kept["none"], {"hot"})


class Usage(Case):
    def test_refused(self):
        for arguments, word in (
                (["--no-such-option"], "--no-such-option"), (["--rays", "3"], "--rays"), (["--rays"], "--rays"),
                (["--rays", "many"], "--rays"), (["--gather-rays", "100"], "128"), (["--gather-rays", "-1"], "--gather-rays"), (["--stop-after", "-1"], "--stop-after"),
                (["--stop-after", "nan"], "--stop-after"), (["--preview-every", "soon"], "--preview-every"), (["--checkpoint-every", "-2"], "--checkpoint-every"),
                (["--tolerance", "0"], "--tolerance"), (["--tolerance", "nan"], "--tolerance"),
                (["--texels-per-metre", "-1"], "--texels-per-metre"), (["--texels-per-metre", "nan"], "--texels-per-metre"),
                (["--atlas-size", "8"], "--atlas-size"), (["--atlas-size", "100000"], "--atlas-size"),
                (["--padding", "65"], "--padding"), (["--patch-texels", "0"], "--patch-texels"),
                (["--chunk-patches", "15"], "--chunk-patches"), (["--threads", "5000"], "--threads"),
                (["--quality", "best"], "draft"), (["--uv", "none"], "unwrap"), (["--encoding", "rgbm"], "srgb8"), (["--lightmap-format", "webp"], "ktx2"),
                (["--lightmap-format", "exr", "--encoding", "srgb8"], "png8 only"), (["--lightmap-format", "rgbe", "--dither", "off"], "png8 only"), (["--dither", "some"], "on"),
                (["--profile", "unity"], "plain"), (["--unlit-exposure", "2"], "--unlit"), (["--unlit", "--unlit-exposure", "0"], "--unlit-exposure"), (["--profile", "hubs", "--lightmap-format", "ktx2"], "rgbe or png8"), (["--profile", "mx", "--lightmap-format", "rgbm"], "rgbm-mx with --profile mx"), (["--profile", "mx", "--encoding", "srgb8"], "png8 only, but the format of --profile mx is rgbm-mx"), (["--profile", "hubs", "--lightmap-format", "png8", "--encoding", "srgb8"], "linear8"),
                (["--interpolation", "cubic"], "cubic-bspline"), (["--aov", "albedo,beauty"], "direct, indirect, error, sharing, samples, albedo, normal, patch, chart, valid, area; found \"beauty\""),
                (["--max-rays", "64"], "--error"), (["--error", "0.5", "--gather-rays", "64", "--max-rays", "32"], "at least --gather-rays"), (["--aov", ""], "--aov"), (["--aov", "albedo, valid"], "commas"), (["--gather-rays", "0", "--aov", "direct"], "albedo,normal,patch,chart,valid,area"), (["--quality", "draft", "--aov", "valid,samples"], '"samples" needs'), (["--lamp-points", "6"], "use 8"), (["--force", "clouds"], "dark-patches"), (["--force", "sky", "--force-all"], "--force-all"), (["--memory", "lots"], "512M"), (["--memory", "1T"], "--memory"),
                (["--memory", "99999999999G"], "--memory"), (["--store", "some"], "none"),
                (["--store", "hot", "--store-bytes", "lots"], "512M"), (["--store", "hot", "--store-bytes", "0"], "--store none"),
                (["--store", "none", "--store-bytes", "1G"], "--store hot"), (["--store-bytes", "1G"], "--store hot"), (["--seed", "-1"], "--seed"),
                (["--sky-color", "1,2"], "R,G,B"), (["--sky-color", "1,2,3,4"], "R,G,B"), (["--sky-color", "1,-2,3"], "R,G,B"),
                (["--sky-color", "nan"], "R,G,B"), (["--sky-color", "1,2,blue"], "R,G,B"), (["--sky-color", "1", "--sky", "none"], "only one sky"),
                (["--sky-scale", "-1"], "--sky-scale"), (["--lamp-radius", "-1"], "--lamp-radius"), (["--sun-angle", "180"], "--sun-angle"), (["another.glb"], "another.glb")):
            with self.subTest(arguments):
                # Should it be accepted, it shall not take long.
                small = [part for name, value in zip(SMALL[::2], SMALL[1::2]) if name not in arguments for part in (name, value)]
                # A fresh place each time, so that one failure is one failure.
                self.out = tempfile.mkdtemp(dir=self.folder)
                self.output = os.path.join(self.out, "scene.glb")
                self.assert_refused(run("bake", FURNACE, "-o", self.output, *small, *arguments), USAGE, word)

    def test_padding_that_leaves_no_room(self):
        self.assert_refused(run("bake", FURNACE, "-o", self.output, "--atlas-size", "16", "--padding", "60"), USAGE, "padding")

    def test_commands(self):
        for arguments in ([], ["render"], ["bake"], ["bake", FURNACE], ["bake", "-o", self.output], ["--no-such-option"]):
            with self.subTest(arguments):
                self.assert_refused(run(*arguments), USAGE, "--help")

    def test_output_is_the_input(self):
        source = self.scene(lambda document: None)
        before = read(source)
        self.assert_refused(self.bake(source=source, output=source), USAGE, "input")
        link = self.path("link.gltf")
        os.symlink(source, link)
        self.assert_refused(self.bake(source=source, output=link), USAGE, "input")
        self.assertEqual(read(source), before)

    def test_output_of_another_kind(self):
        self.assert_refused(self.bake(output=self.path("scene.obj")), USAGE, ".glb")


class Output(Case):
    def test_layers_are_listed_and_written(self):
        report = self.path("report.json")
        self.assert_done(self.bake("--aov", "valid,albedo", "--report", report))
        self.assertEqual(files_below(self.out), ["scene.aov0.exr", "scene.glb", "scene.glb.lightmaps.json", "scene.lightmap0.exr"])
        with open(os.path.join(self.out, "scene.glb.lightmaps.json"), encoding="utf-8") as file:
            (page,) = json.load(file)["pages"]
        self.assertEqual(page["layers"]["uri"], "scene.aov0.exr")
        self.assertEqual([part["name"] for part in page["layers"]["parts"]], ["albedo", "valid"])
        with open(report, encoding="utf-8") as file:
            outputs = [output for output in json.load(file)["outputs"] if output["kind"] == "layer"]
        self.assertEqual([os.path.basename(output["path"]) for output in outputs], ["scene.aov0.exr#albedo", "scene.aov0.exr#valid"])

    def test_layers_do_not_change_the_rest(self):
        self.assert_done(self.bake())
        plain = {name: read(os.path.join(self.out, name)) for name in files_below(self.out)}
        self.assert_done(self.bake("--aov", "albedo,normal,patch,chart,valid"))
        for name, content in plain.items():
            if not name.endswith(".json"):
                self.assertEqual(read(os.path.join(self.out, name)), content, name)

    def test_layers_that_cannot_be_written(self):
        self.assert_done(self.bake("--aov", "normal", "--work", self.path("work")))
        sizes = {name: os.path.getsize(os.path.join(self.out, name)) for name in files_below(self.out)}
        shutil.rmtree(self.out)
        self.assertGreater(sizes["scene.aov0.exr"], sizes["scene.lightmap0.exr"], "so that the layers fail, not the lightmap")
        for limit in (sizes["scene.aov0.exr"] - 1, sizes["scene.lightmap0.exr"] + 1):
            self.assert_refused(self.bake("--aov", "normal", "--work", self.path("work"), limit_file_bytes=limit), CANNOT_WRITE)

    def test_folder_in_its_place(self):
        os.makedirs(self.path("a_folder.glb"))
        self.assert_refused(self.bake(output=self.path("a_folder.glb")), CANNOT_WRITE, "a_folder.glb")
        self.assertEqual(os.listdir(self.path("a_folder.glb")), [])

    def test_file_where_a_folder_is_wanted(self):
        with open(self.path("file"), "wb"):
            pass
        self.assert_refused(self.bake(output=self.path("file/scene.glb")), CANNOT_WRITE, "file")
        self.assert_refused(self.bake("--work", self.path("file")), CANNOT_WRITE, "file")

    def test_folder_that_takes_no_files(self):
        self.assert_refused(self.bake(output="/proc/scene.glb"), CANNOT_WRITE, "/proc")
        if os.geteuid() != 0:
            os.makedirs(self.path("closed"), mode=0o500)
            self.assert_refused(self.bake(output=self.path("closed/scene.glb")), CANNOT_WRITE, "closed")

    def test_report_that_cannot_be_written(self):
        result = self.bake("--report", "/proc/report.json")
        self.assertEqual(result.returncode, CANNOT_WRITE)
        self.assertIn("/proc/report.json", result.stderr)

    def test_full_disk_at_any_size(self):
        self.assert_done(self.bake("--work", self.path("work")))
        largest = max(os.path.getsize(os.path.join(self.out, name)) for name in files_below(self.out))
        sizes = sorted({os.path.getsize(os.path.join(where, name)) for folder in (self.out, self.path("work"))
                        for where, _, names in os.walk(folder) for name in names})
        shutil.rmtree(self.out)
        for limit in [0, 100] + [size - 1 for size in sizes]:
            with self.subTest(limit):
                self.assert_refused(self.bake(limit_file_bytes=limit), CANNOT_WRITE)
        self.assertEqual(sizes[-1] >= largest, True)
        # With a finished bake folder only the outputs are written.
        for limit in (0, largest // 2, largest - 1):
            with self.subTest(limit):
                self.assert_refused(self.bake("--work", self.path("work"), limit_file_bytes=limit), CANNOT_WRITE, "scene")
                self.assertEqual([name for name in files_below(self.path("work")) if ".tmp-" in name], [])

    def test_a_full_disk_at_any_stage_is_told_and_continued(self):
        """The message has file and byte, what is there is whole, and with space the same command goes on to the same bytes."""
        settings = ["--patch-texels", "1", "--chunk-patches", "64"]
        whole = self.path("whole")
        self.assert_done(self.bake(*settings, "--work", whole))
        stored = {name: read(os.path.join(whole, name)) for name in files_below(whole)}
        outputs = {name: read(os.path.join(self.out, name)) for name in files_below(self.out)}
        for stage in ("atlas", "evidence", "strips", "closure", "solution", "accuracy"):
            with self.subTest(stage):
                shutil.rmtree(self.out)
                work = self.path("work-" + stage)
                shutil.copytree(whole, work)
                mine = [name for name in stored if name.startswith(stage + "-")]
                for name in mine:
                    os.remove(os.path.join(work, name))
                limit = max(len(stored[name]) for name in mine) - 1
                result = self.bake(*settings, "--work", work, limit_file_bytes=limit)
                self.assert_refused(result, CANNOT_WRITE)
                where = re.search(r"^luxel: error: (\S+): cannot write at byte (\d+): ", result.stderr, re.M)
                self.assertIsNotNone(where, result.stderr)
                self.assertEqual(int(where.group(2)), limit)
                self.assertIn(os.path.relpath(where.group(1), work), mine)
                self.assertEqual([name for name in files_below(work) if ".tmp-" in name], [])
                for name in files_below(work):
                    self.assertEqual(read(os.path.join(work, name)), stored[name], name + " is neither whole nor absent")
                self.assert_done(self.bake(*settings, "--work", work))
                self.assertEqual({name: read(os.path.join(work, name)) for name in files_below(work)}, stored)
                self.assertEqual({name: read(os.path.join(self.out, name)) for name in files_below(self.out)}, outputs)

    def test_full_file_system(self):
        disk = self.path("disk")
        os.makedirs(disk)
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4k", "tmpfs", disk],
                                               capture_output=True).returncode:
            self.skipTest("a small file system cannot be mounted here")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        self.assert_refused(self.bake("--work", self.path("work"), output=os.path.join(disk, "scene.glb")), CANNOT_WRITE, "scene")
        self.assertEqual(files_below(disk), [])

    def test_old_outputs_survive_a_failure(self):
        self.assert_done(self.bake())
        before = {name: read(os.path.join(self.out, name)) for name in files_below(self.out)}
        result = self.bake("--seed", "9", limit_file_bytes=100)
        self.assertEqual(result.returncode, CANNOT_WRITE)
        after = {name: read(os.path.join(self.out, name)) for name in files_below(self.out)}
        self.assertEqual(before, after)

    def test_failed_write_leaves_no_mixture(self):
        """A later file of the set fails: whatever is left is the whole old set or nothing of the new one."""
        self.assert_done(self.bake())
        old = {name: read(os.path.join(self.out, name)) for name in files_below(self.out)}
        os.remove(os.path.join(self.out, "scene.glb.lightmaps.json"))
        os.makedirs(os.path.join(self.out, "scene.glb.lightmaps.json"))
        result = self.bake("--seed", "3")
        self.assertEqual(result.returncode, CANNOT_WRITE, result.stderr)
        for name in files_below(self.out):
            self.assertEqual(read(os.path.join(self.out, name)), old[name], name + " is neither old nor gone")


class Damage(Case):
    def test_damaged_file_is_named(self):
        self.assert_done(self.bake("--work", self.path("work")))
        shutil.rmtree(self.out)
        (atlas,) = [name for name in os.listdir(self.path("work")) if name.startswith("atlas-")]
        with open(os.path.join(self.path("work"), atlas), "r+b") as file:
            file.seek(100)
            byte = file.read(1)
            file.seek(100)
            file.write(bytes([byte[0] ^ 1]))
        self.assert_refused(self.bake("--work", self.path("work")), DAMAGED_STORE, atlas)
        os.remove(os.path.join(self.path("work"), atlas))
        self.assert_done(self.bake("--work", self.path("work")))


class Memory(Case):
    def test_too_small_budget_states_the_smallest(self):
        result = self.bake("--memory", "1M")
        self.assert_refused(result, BUDGET_TOO_SMALL, "--memory")
        smallest = int(re.search(r"--memory (\d+)M", result.stderr).group(1))
        self.assertGreater(smallest, 1)
        self.assert_refused(self.bake("--memory", "0"), BUDGET_TOO_SMALL)
        self.assert_refused(self.bake("--memory", f"{smallest - 8}M"), BUDGET_TOO_SMALL)
        self.assert_done(self.bake("--memory", f"{smallest + 2}M"))


if __name__ == "__main__":
    LUXEL = os.path.abspath(sys.argv.pop(1))
    unittest.main()
