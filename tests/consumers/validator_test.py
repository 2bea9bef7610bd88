#!/usr/bin/env python3
"""The Khronos validator finds nothing in baked models that it does not find in their inputs: no errors, no warnings.

usage: validator_test.py LUXEL [--only TEXT]

All samples and, where their folder is there, all scenes of others, in every way of scenes.py. An issue counts as the input's
where the input has one of the same code at the same kind of place, such as ACCESSOR_VECTOR3_NON_UNIT at /accessors/*: arrays
are renumbered and copied. Compressed inputs are decoded first, as the validator does not look into them.
Needs `tools/setup.sh consumers`; skipped without.
"""
import argparse
import json
import os
import re
import tempfile

import everything
import gltf_file
import kept_test
import scene_loop
import scenes


def issues(paths):
    """{path: {severity: [issue]}}"""
    done = scenes.node(os.path.join(scenes.HERE, "validator.mjs"), *paths)
    if done.returncode:
        raise RuntimeError(f"validator.mjs: {done.stderr[-2000:]}")
    return {found["file"]: found for found in map(json.loads, done.stdout.splitlines())}


def kind(issue):
    return issue["code"], re.sub(r"\d+", "*", issue["pointer"] or "")


def new_issues(before, after, unavoidable):
    known = {kind(issue) for severity in ("errors", "warnings") for issue in before[severity]}
    return {severity: [issue for issue in after[severity] if kind(issue) not in known and
                       not (severity == "warnings" and issue["code"] in unavoidable)] for severity in ("errors", "warnings")}


def check(luxel, source):
    """Bakes one scene in every way; returns lines of what is wrong."""
    wrong = []
    with tempfile.TemporaryDirectory(prefix="luxel-validator-") as folder:
        reference = source
        if kept_test.is_compressed(gltf_file.GltfFile(source).json):
            reference = kept_test.decoded(source, folder).path
        outputs = {}
        for way in scenes.ways(luxel):
            target = os.path.join(folder, way.name)
            try:
                scenes.bake(luxel, source, os.path.join(target, "baked" + way.suffix), "--work", os.path.join(folder, "work"), *way.arguments)
                outputs.update({path: way for path in scenes.below(target)})
            except RuntimeError as error:
                wrong.append(f"{way.name}: {error}")
        found = issues([reference, *outputs])
        for path, way in outputs.items():
            for severity, added in new_issues(found[reference], found[path], way.warnings).items():
                if added:
                    first = added[0]
                    wrong.append(f"{way.name}: {len(added)} {severity}, first {first['code']} at {first['pointer']}: {first['message']}")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("luxel")
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    if not scenes.has_modules():
        scenes.skip("node or its packages are missing: tools/setup.sh consumers")
    with tempfile.TemporaryDirectory(prefix="luxel-everything-") as folder:
        paths = [everything.write(folder), *scenes.samples(), *scenes.foreign_scenes()]
        scene_loop.end_with([(path,) for path in paths if options.only in path], lambda path: check(options.luxel, path), "clean", "ISSUES")


if __name__ == "__main__":
    main()
