"""Goes on in the Python that has Mitsuba."""
import os
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SKIPPED = 77   # exit status of a test that cannot run here


def use_reference_python():
    """Starts the script anew in the environment of `tools/setup.sh reference`, or in LUXEL_REFERENCE_PYTHON; a skipped test where
    there is neither."""
    python = os.environ.get("LUXEL_REFERENCE_PYTHON", os.path.join(ROOT, "build/deps/reference/bin/python"))
    if os.environ.get("LUXEL_IN_REFERENCE_PYTHON"):
        return
    if not os.path.exists(python):
        print(f"skipped: {python} is not there; tools/setup.sh reference makes it")
        sys.exit(SKIPPED)
    os.environ["LUXEL_IN_REFERENCE_PYTHON"] = "1"
    os.execv(python, [python, "-B", *sys.argv])
