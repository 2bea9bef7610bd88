"""What the tests of this folder bake, and how: the scenes, and the ways of writing them, in one place each. Standard library only."""
import os
import shutil
import subprocess
import sys
import typing

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
MODULES = os.path.join(ROOT, "build", "deps", "consumers")  # made by `tools/setup.sh consumers`
SKIPPED = 77                                                # exit code: ctest shows the test as skipped

# Light as cheap as it gets: what is tested is how it is written down.
QUICK = ["--quality", "draft", "--atlas-size", "200", "--rays", "16", "--tolerance", "1e-2", "--patch-texels", "8", "--sky", "none"]

REFUSED = {"Compatibility_04.gltf", "Compatibility_05.gltf"}  # ask for a version or an extension that nobody has
NO_SURFACE = {f"Mesh_PrimitiveMode_{number:02}.gltf" for number in (0, 1, 2, 3, 7, 8, 9, 10)}  # points and lines
BIG = {"city.glb", "city-xl.glb"}  # 7 and 21 million triangles: only with LUXEL_BIG, as in foreign_scenes_test


class Way(typing.NamedTuple):
    """How a model is written. A new option of `bake` that changes the written files gets a line below."""
    name: str
    suffix: str
    arguments: tuple = ()
    warnings: tuple = ()  # codes of the validator that this way cannot avoid, with the reason at its line

    @property
    def is_packed(self):
        return bool({"--draco", "--meshopt"} & set(self.arguments))


ALL_WAYS = [
    Way("glb", ".glb"),
    Way("gltf", ".gltf"),
    Way("uv-keep", ".glb", ("--uv", "keep")),
    Way("linear8", ".glb", ("--encoding", "linear8")),
    *(Way(form, suffix, ("--lightmap-format", form)) for form, suffix in
      (("png16", ".glb"), ("rgbm", ".gltf"), ("rgbe", ".glb"), ("exr", ".gltf"), ("ktx2", ".glb"))),
    Way("plain", ".glb", ("--profile", "plain")),
    Way("mx", ".glb", ("--profile", "mx")),
    # Hubs loads one file, and a picture inside a GLB must have a type: image/vnd.radiance is not one of glTF's
    Way("hubs", ".glb", ("--profile", "hubs"), ("VALUE_NOT_IN_LIST",)),
    Way("draco", ".glb", ("--draco",)),
    Way("meshopt", ".gltf", ("--meshopt",)),
    Way("mx-packed", ".glb", ("--profile", "mx", "--draco", "--meshopt")),
    Way("unlit", ".glb", ("--unlit",)),
]


def ways(luxel):
    """Those that this build of the program has options for."""
    known = subprocess.run([luxel, "bake", "--help"], stdout=subprocess.PIPE, text=True, check=True).stdout
    return [way for way in ALL_WAYS if all(argument in known for argument in way.arguments if argument.startswith("--"))]


def scenes_folder():
    return os.environ.get("LUXEL_SCENES") or os.path.join(ROOT, "..", "shared", "scenes")


def below(folder):
    return sorted(os.path.join(where, name) for where, _, names in os.walk(folder) for name in names
                  if name.endswith((".glb", ".gltf")))


def foreign_scenes():
    """Scenes of others that bake; empty where their folder is missing."""
    return [path for path in below(scenes_folder()) if os.path.basename(path) not in REFUSED | NO_SURFACE
            and (os.environ.get("LUXEL_BIG") or os.path.basename(path) not in BIG)]


def samples():
    """The project's own, but those that only differ in how much there is of them."""
    return [path for path in below(os.path.join(ROOT, "samples")) if "corridor_16" not in path and "corridor_64" not in path]


def bake(luxel, source, output, *arguments, options=tuple(QUICK)):
    """Returns what went to standard error; a failure raises RuntimeError with it."""
    done = subprocess.run([luxel, "bake", source, "-o", output, *options, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                          text=True, errors="replace", check=False)
    if done.returncode:
        raise RuntimeError(f"luxel ended with {done.returncode}: {done.stderr[-2000:]}")
    return done.stderr


def node(*arguments, **options):
    """Runs a script with Node and the packages of build/deps/consumers."""
    return subprocess.run(["node", "--import", os.path.join(HERE, "modules.mjs"), *arguments],
                          env={**os.environ, "LUXEL_MODULES": MODULES}, text=True, errors="replace", check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)


def has_modules():
    return shutil.which("node") is not None and os.path.isfile(os.path.join(MODULES, "node_modules", "gltf-validator", "package.json"))


def skip(why):
    print(f"skipped: {why}", file=sys.stderr)
    sys.exit(SKIPPED)
