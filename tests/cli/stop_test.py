"""Stopping a bake as its user does: after a time, by one interrupt and by two; and looking at it on the way.

usage: stop_test.py LUXEL [unittest arguments]
"""
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import unittest

import cli_test
from cli_test import FURNACE, SMALL, STOPPED_EARLY, Case, files_below, read

INTERRUPTED = 130


class Stop(Case):
    def report(self):
        with open(self.path("report.json"), encoding="utf-8") as file:
            return json.load(file)

    def start(self, *arguments, rays=64):
        process = subprocess.Popen([cli_test.LUXEL, "bake", FURNACE, "-o", self.output, *SMALL[:-1], str(rays), "--work", self.path("work"), "--report",
                                 self.path("report.json"), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def wait_for(self, process, seconds=30):
        """Until the rays are being traced: a moment after the folder of the evidence is there."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and process.poll() is None:
            if os.path.isdir(self.path("work")) and any(name.startswith("evidence-") for name in os.listdir(self.path("work"))):
                time.sleep(0.5)
                return
            time.sleep(0.005)
        self.fail("no rays were traced")

    def test_before_there_is_light(self):
        self.assert_refused(self.bake("--stop-after", "0", "--work", self.path("work")), STOPPED_EARLY,
                            "nothing was written", "the same command with the same --work goes on")
        self.assert_refused(self.bake("--stop-after", "0"), STOPPED_EARLY, "with --work DIR")
        self.assert_done(self.bake("--work", self.path("work")))

    def test_after_a_time_and_the_next_run(self):
        slow = ["--gather-rays", "65536", "--work", self.path("work"), "--report", self.path("report.json")]
        self.assert_done(self.bake("--gather-rays", "0", *slow[2:]))  # all but the light is there
        result = self.bake(*slow, "--stop-after", "0.5")
        self.assertEqual(result.returncode, STOPPED_EARLY, result.stderr)
        self.assertRegex(result.stderr, r"(?m)^luxel: warning: light: the time is up: \d+ of \d+ pages are interpolated from the patches; "
                                        r"error bound of the solve \S+, standard error \S+ %; .* \[stopped\]$")
        self.assertIn("stopped, solved to", result.stdout)
        self.assertEqual(self.report()["stopped"], "light")
        self.assertTrue(os.path.isfile(self.output))

    def test_an_interrupt_writes_what_is_there(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(number):
                shutil.rmtree(self.path("work"), ignore_errors=True)
                shutil.rmtree(self.out, ignore_errors=True)
                self.assert_done(self.bake("--work", self.path("work")))
                shutil.rmtree(self.out)
                process = self.start("--gather-rays", "65536")
                time.sleep(1)  # everything but the light is reused: it is gathering
                process.send_signal(number)
                output, messages = process.communicate(timeout=60)
                self.assertEqual(process.returncode, INTERRUPTED, messages)
                self.assertIn("luxel: interrupted: finishes the step and writes what there is to write; interrupt again", messages)
                self.assertRegex(messages, r"luxel: warning: light: interrupted: .*\[stopped\]")
                self.assertEqual(self.report()["stopped"], "light")
                self.assertTrue(os.path.isfile(self.output))

    def test_a_second_interrupt_ends_it_at_once(self):
        process = self.start("--importance", "off", rays=1 << 24)  # one chunk, and it takes minutes
        self.wait_for(process)
        process.send_signal(signal.SIGINT)
        with self.assertRaises(subprocess.TimeoutExpired):
            process.wait(timeout=0.5)
        process.send_signal(signal.SIGINT)
        output, messages = process.communicate(timeout=10)
        self.assertEqual(process.returncode, -signal.SIGINT, messages)
        self.assertEqual(messages.count("luxel: interrupted"), 1)
        self.assertFalse(os.path.exists(self.output))
        self.assert_done(self.bake("--work", self.path("work")))

    def test_previews_leave_the_result_as_it_is(self):
        self.assert_done(self.bake("--tolerance", "1e-10"))
        before = {name: read(os.path.join(self.out, name)) for name in files_below(self.out)}
        result = self.bake("--tolerance", "1e-10", "--preview-every", "1e-6", "--report", self.path("report.json"))
        self.assert_done(result)
        self.assertGreater(self.report()["previews"]["written"], 0)
        self.assertEqual({name: read(os.path.join(self.out, name)) for name in files_below(self.out)}, before)


if __name__ == "__main__":
    cli_test.LUXEL = os.path.abspath(sys.argv.pop(1))
    unittest.main()
