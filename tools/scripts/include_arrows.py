#!/usr/bin/env python3
"""Reads the #include lines of formats/, baker/ and tools/ and fails when an arrow between rooms points the wrong way, or
when an outside library is named outside its place.

usage: include_arrows.py [ROOT]        prints one line per finding: file:line, what is wrong; exit status 1 if any

A room may include itself and every room above it in ORDER; rooms on one line do not know each other.
"""
import os
import re
import sys

ORDER = [["formats/base"], ["formats/gltf", "formats/image", "formats/bake"], ["baker/core"], ["baker/scene"], ["baker/unwrap"],
         ["baker/patches"], ["baker/trace"], ["baker/chunks"], ["baker/formfactors"], ["baker/store", "baker/solver"],
         ["baker/accuracy"], ["baker/light"], ["baker/output"], ["baker/bake", "baker/sweep"], ["baker/plan"], ["tools"]]
# From baker rooms to formats: the decoded picture and glTF machinery is for the ends of the pipeline only.
ONLY_FROM = {"formats/gltf": ["formats/gltf", "baker/output", "baker/bake", "tools"],
             "formats/image": ["formats/image", "baker/output", "baker/bake", "baker/sweep", "tools"],
             "formats/bake": ["formats/bake", "baker/formfactors", "baker/store", "baker/solver", "baker/accuracy", "baker/bake",
                                 "tools"]}
# Contracts that are read further up than the room they are kept in: header, first room that may include it.
CONTRACTS = {"formats/gltf/scene_record.h": "baker/scene",            # plain records
             "baker/formfactors/block_source.h": "baker/chunks"}      # how patches are numbered by chunk
LIBRARIES = [  # pattern of the header, where it may be named
    (r"xatlas", ["baker/unwrap"]), (r"embree[34]/", ["baker/trace"]), (r"OpenImageIO/|OpenEXR/|png\.h|turbojpeg\.h", ["formats/image"]),
    (r"zstd\.h|zdict\.h|xxhash\.h", ["formats/base"]), (r"draco/|meshoptimizer\.h", ["formats/gltf"]), (r"CLI/", ["tools/luxel"]),
    (r"oneapi/|tbb/", ["baker/core"]), (r"stb_", ["baker/unwrap"])]


def room_of(path):
    """The room a file belongs to, or None; tools is one room with all its folders."""
    for line in ORDER:
        for room in line:
            if path.startswith(room + "/"):
                return room
    return None


def rank(room):
    return next(k for k, line in enumerate(ORDER) if room in line)


def wrong_arrow(source, header):
    """Why `source` may not include `header` (both paths from the root), or None."""
    here, there = room_of(source), room_of(header)
    if here is None or there is None or here == there:
        return None
    if header in CONTRACTS and rank(here) >= rank(CONTRACTS[header]):
        return None
    if rank(here) <= rank(there):
        return f"{here} must not know {there}"
    if there in ONLY_FROM and here not in ONLY_FROM[there]:
        return f"{here} must not know {there}, only {', '.join(ONLY_FROM[there])} may"
    return None


def wrong_library(source, header):
    for pattern, places in LIBRARIES:
        if re.match(pattern, header) and not any(source.startswith(p + "/") for p in places):
            return f"<{header}> belongs in {', '.join(places)} only"
    return None


def check_file(root, source):
    findings = []
    with open(os.path.join(root, source), encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            match = re.match(r'\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)', line)
            if not match:
                continue
            own, outside = match.groups()
            reason = wrong_arrow(source, own) if own and room_of(own) else wrong_library(source, own or outside)
            if own and not reason and not room_of(own) and not os.path.exists(os.path.join(root, own)) and "/" in own:
                reason = f'"{own}" is not a path from the root'
            if reason:
                findings.append(f"{source}:{number}: {reason}")
    return findings


def check_tree(root):
    findings = []
    for top in ("formats", "baker", "tools"):
        for folder, folders, files in os.walk(os.path.join(root, top)):
            folders.sort()
            for name in sorted(files):
                if name.endswith((".h", ".cpp")):
                    findings += check_file(root, os.path.relpath(os.path.join(folder, name), root).replace(os.sep, "/"))
    return findings


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
    findings = check_tree(root)
    for line in findings:
        print(line)
    print(f"include_arrows: {len(findings)} findings")
    sys.exit(1 if findings else 0)


if __name__ == "__main__":
    main()
