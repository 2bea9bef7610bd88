"""The scenes that the presets are measured on."""
import dataclasses
import os

ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", ".."))


@dataclasses.dataclass(frozen=True)
class Scene:
    name: str
    file: str       # {shared}: the folder of foreign scenes
    density: float  # texels per metre: few enough that --quality reference is done in minutes
    options: tuple = ()

    def path(self, shared):
        return os.path.normpath(os.path.join(ROOT, self.file.format(shared=os.path.abspath(shared))))


def sample(name, density, *options):
    return Scene(name, f"samples/{name}/{name}.gltf", density, options)


# corridor_64 is left out: four of corridor_16.
SCENES = [
    sample("cornell_box", 40), sample("two_rooms", 4), sample("painted_room", 6), sample("tinted_room", 6), sample("glass_room", 6),
    sample("sun_room", 6), sample("open_court", 5, "--sky-color", "3000,4000,6000"), sample("fence", 8), sample("lamps_over_floor", 8),
    sample("furnace", 8), sample("sphere", 8), sample("two_squares_parallel", 32), sample("two_squares_perpendicular", 32),
    sample("corridor_4", 4),
    Scene("corridor_16", "samples/corridor_16/corridor_16.gltf", 2.5),
    Scene("hotel-room", "{shared}/hotel-room/hotel-room.glb", 4), Scene("zdm2", "{shared}/zdm2/zdm2.glb", 0.7),
    Scene("staircase", "{shared}/staircase/staircase.glb", 1.5), Scene("lq-e1m1", "{shared}/lq-e1m1/lq_e1m1.glb", 0.1),
    Scene("house", "{shared}/house/house.glb", 90, ("--sky-color", "3000,4000,6000")),
]
