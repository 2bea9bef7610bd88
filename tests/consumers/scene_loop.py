"""Going over scenes, which several tests of this folder do: one line per scene with a verdict, and below it what is wrong. Standard library only."""
import os
import sys

import scenes


def end_with(jobs, check, good="kept", bad="CHANGED"):
    """Calls check(*job) for every job, whose first item is the path of a scene and whose last may be a way of writing; it returns lines of what is wrong. Ends the
    program: with 1 if anything was."""
    failed = 0
    for job in jobs:
        wrong = check(*job)
        failed += bool(wrong)
        names = [os.path.relpath(job[0], scenes.ROOT), *(item.name for item in job[1:] if isinstance(item, scenes.Way))]
        print(f"{bad if wrong else good:8}{' '.join(names)}", *wrong, sep="\n    ", flush=True)
    sys.exit(1 if failed else 0)
