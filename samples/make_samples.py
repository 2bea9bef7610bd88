#!/usr/bin/env python3
"""Writes the sample scenes: samples/<name>/<name>.gltf and .bin. Python 3.9 or newer, standard library only.

usage: samples/make_samples.py [NAME ...] [--solver-scenes] [--out DIR] [--reflectance R]

Without names all samples are written. --out: another folder than this one. --reflectance: for furnace and sphere.
--solver-scenes: the scenes for measuring solvers (rooms_4 and so on), which are written only then or by name, and are not
kept in the repository.
The output is the same bytes each time.
"""
import argparse
import math
import os

import open_plan
import rooms
from gltf_writer import Gltf, box, facing, png, rectangle

ONE_LM_PER_M2 = [1 / math.pi] * 3   # nits of a surface with exitance M = pi L = 1 lm/m2


def cornell_box(_):
    """The Cornell box: measured corners in millimetres (Cornell University Program of Graphics, "Cornell Box Data",
    www.graphics.cornell.edu/online/box/data.html). The published lamp is a hole in the ceiling with the lamp in it; so the
    ceiling is cut around it. Reflectances and the lamp's 17, 12, 4 are the published spectra as linear RGB in the values
    of the Computer Graphics Archive (M. McGuire, casual-effects.com/data, CornellBox-Original); the lamp reflects 0.78.
    The front is open, as published."""
    gltf = Gltf()
    white = gltf.material("white", (0.725, 0.71, 0.68))
    green = gltf.material("green", (0.14, 0.45, 0.091))
    red = gltf.material("red", (0.63, 0.065, 0.05))
    lamp = gltf.material("lamp", (0.78, 0.78, 0.78), (17, 12, 4))

    def metres(corners):
        return [tuple(c / 1000 for c in p) for p in corners]

    def wall(name, corners, direction, material):
        gltf.piece(name, [facing(metres(c), direction) for c in corners], material)

    wall("floor", [[(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)]], (0, 1, 0), white)
    top = 548.8
    outer = [(556, top, 0), (556, top, 559.2), (0, top, 559.2), (0, top, 0)]
    hole = [(343, top, 227), (343, top, 332), (213, top, 332), (213, top, 227)]
    ring = [[outer[k], outer[(k + 1) % 4], hole[(k + 1) % 4], hole[k]] for k in range(4)]
    wall("ceiling", ring, (0, -1, 0), white)
    wall("lamp", [hole], (0, -1, 0), lamp)
    wall("back_wall", [[(549.6, 0, 559.2), (0, 0, 559.2), (0, top, 559.2), (556, top, 559.2)]], (0, 0, -1), white)
    wall("right_wall", [[(0, 0, 559.2), (0, 0, 0), (0, top, 0), (0, top, 559.2)]], (1, 0, 0), green)
    wall("left_wall", [[(552.8, 0, 0), (549.6, 0, 559.2), (556, top, 559.2), (556, top, 0)]], (-1, 0, 0), red)

    def block(name, roof, height):
        centre = [sum(p[k] for p in roof) / 4 for k in range(2)]
        faces = [facing(metres([(x, height, z) for x, z in roof]), (0, 1, 0))]
        for (x0, z0), (x1, z1) in zip(roof, roof[1:] + roof[:1]):
            away = ((x0 + x1) / 2 - centre[0], 0, (z0 + z1) / 2 - centre[1])
            faces.append(facing(metres([(x0, 0, z0), (x1, 0, z1), (x1, height, z1), (x0, height, z0)]), away))
        gltf.piece(name, faces, white)

    block("short_block", [(130, 65), (82, 225), (240, 272), (290, 114)], 165)
    block("tall_block", [(423, 247), (265, 296), (314, 456), (472, 406)], 330)
    return gltf


def furnace(options):
    """A closed cube of 2 m seen from inside: every wall has M = 1 lm/m2 and the same reflectance."""
    gltf = Gltf()
    glow = gltf.material("glow", [options.reflectance] * 3, ONE_LM_PER_M2)
    for axis, letter in enumerate("xyz"):
        for sign in (-1, 1):
            gltf.piece(f"wall_{'minus' if sign < 0 else 'plus'}_{letter}", [rectangle(axis, float(sign), (-1, -1), (1, 1), -sign)], glow)
    return gltf


def sphere(options):
    """A closed sphere of radius 1 m seen from inside (an icosahedron divided three times, 1,280 triangles)."""
    gltf = Gltf()
    glow = gltf.material("glow", [options.reflectance] * 3, ONE_LM_PER_M2)
    g = (1 + math.sqrt(5)) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
              (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]

    def unit(p):
        length = math.sqrt(sum(c * c for c in p))
        return tuple(c / length for c in p)

    points = [unit(p) for p in points]
    edge = min(math.dist(points[0], p) for p in points[1:]) * 1.01
    faces = [[points[a], points[b], points[c]] for a in range(12) for b in range(a + 1, 12) for c in range(b + 1, 12)
             if max(math.dist(points[a], points[b]), math.dist(points[b], points[c]), math.dist(points[a], points[c])) < edge]

    def middle(a, b):
        return unit([(x + y) / 2 for x, y in zip(*sorted((a, b)))])

    for _ in range(3):
        faces = [f for a, b, c in faces for ab, bc, ca in [(middle(a, b), middle(b, c), middle(c, a))]
                 for f in ([a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca])]
    gltf.piece("sphere", [facing(f, [-sum(p[k] for p in f) for k in range(3)]) for f in faces], glow)
    return gltf


def two_squares(second):
    """A unit square that emits M = 1 lm/m2 and reflects nothing, and a black one that receives."""
    gltf = Gltf()
    gltf.piece("sender", [rectangle(1, 0.0, (0, 0), (1, 1), 1)], gltf.material("sender", (0, 0, 0), ONE_LM_PER_M2))
    gltf.piece("receiver", [second], gltf.material("receiver", (0, 0, 0)))
    return gltf


def two_rooms(_):
    gltf = Gltf()
    rooms.build(gltf, 2, 1, furnished=False, lit=lambda i, j: i == 0)
    return gltf


def corridor(columns, rows):
    """Furnished rooms; about two of three have a lamp, and each lit room is next to others."""
    gltf = Gltf()
    rooms.build(gltf, columns, rows, furnished=True, lit=lambda i, j: (i + j) % 3 != 1)
    return gltf


def open_court(_):
    """A court of 8 x 6 m between walls of 3 m, open above: it has no lamp and is meant for a sky."""
    gltf = Gltf()
    stone = gltf.material("stone", (0.5, 0.48, 0.44))
    plaster = gltf.material("plaster", (0.7, 0.68, 0.62))
    brick = gltf.material("brick", (0.55, 0.22, 0.15))
    gltf.piece("floor", [rectangle(1, 0.0, (0, 0), (8, 6), 1)], stone)
    for name, axis, at, high, sign, material in (("wall_minus_x", 0, 0.0, (3, 6), 1, plaster), ("wall_plus_x", 0, 8.0, (3, 6), -1, brick),
                                                 ("wall_minus_z", 2, 0.0, (8, 3), 1, plaster), ("wall_plus_z", 2, 6.0, (8, 3), -1, plaster)):
        gltf.piece(name, [rectangle(axis, at, (0, 0), high, sign)], material)
    for k, (low, high) in enumerate((((1, 0, 1), (2, 1, 2)), ((2.5, 0, 3.5), (3.1, 2.2, 4.1)), ((5.2, 0, 1.2), (6.8, 0.5, 2.8)),
                                     ((5.5, 0, 4), (6.3, 1.5, 5)))):
        gltf.piece(f"block_{k}", box(low, high, ("-y",)), brick if k == 2 else plaster)
    return gltf


def sun_room(_):
    """A room of 4 x 2.7 x 5 m that the sun shines into through a window of 1.6 x 1.4 m in a wall of 0.3 m."""
    gltf = Gltf()
    wall, floor = gltf.material("wall", (0.7, 0.7, 0.68)), gltf.material("floor", (0.45, 0.3, 0.2))
    wood = gltf.material("wood", (0.5, 0.35, 0.2))
    gltf.piece("floor", [rectangle(1, 0.0, (0, 0), (4, 5), 1)], floor)
    gltf.piece("ceiling", [rectangle(1, 2.7, (0, 0), (4, 5), -1)], wall)
    gltf.piece("wall_minus_x", [rectangle(0, 0.0, (0, 0), (2.7, 5), 1)], wall)
    gltf.piece("wall_minus_z", [rectangle(2, 0.0, (0, 0), (4, 2.7), 1)], wall)
    gltf.piece("wall_plus_z", [rectangle(2, 5.0, (0, 0), (4, 2.7), -1)], wall)
    low, high = (0.9, 1.7), (2.3, 3.3)   # of the window: y, z
    frame = [((0, 0), (2.7, low[1])), ((0, high[1]), (2.7, 5)), ((0, low[1]), (low[0], high[1])), ((high[0], low[1]), (2.7, high[1]))]
    faces = [rectangle(0, 4.0, a, b, -1) for a, b in frame]
    faces += [rectangle(1, low[0], (4, low[1]), (4.3, high[1]), 1), rectangle(1, high[0], (4, low[1]), (4.3, high[1]), -1)]
    faces += [rectangle(2, low[1], (4, low[0]), (4.3, high[0]), 1), rectangle(2, high[1], (4, low[0]), (4.3, high[0]), -1)]
    gltf.piece("wall_plus_x", faces, wall)
    gltf.piece("table", box((1, 0.7, 1.8), (1.8, 0.75, 3.2)), wood)
    gltf.piece("chest", box((0.3, 0, 4), (1.3, 0.8, 4.7), ("-y",)), wood)
    gltf.lamp("sun", {"type": "directional", "intensity": 50000.0, "color": [1.0, 0.93, 0.82]}, (8, 8, 2.5), (-1, -0.8, 0.1),
              {"angle": 0.53})
    return gltf


def lamps_over_floor(_):
    """A black floor of 6 x 6 m under a point lamp of 100 cd, one that ends at its range, and a spot of 200 cd: each place has
    a closed form."""
    gltf = Gltf()
    gltf.piece("floor", [rectangle(1, 0.0, (-3, -3), (3, 3), 1)], gltf.material("floor", (0, 0, 0)))
    gltf.lamp("point", {"type": "point", "intensity": 100.0, "color": [1.0, 0.8, 0.6]}, (-1.5, 2, -1))
    gltf.lamp("near", {"type": "point", "intensity": 40.0, "range": 2.5, "color": [0.5, 0.7, 1.0]}, (1.5, 1, -1.5))
    gltf.lamp("spot", {"type": "spot", "intensity": 200.0, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.5}}, (1, 2.5, 1.5),
              (-0.3, -1, 0.1))
    return gltf


def fence(_):
    """A lattice cut out of an alpha mask, 4 x 2 m, in the sun, on a floor and before a wall."""
    gltf = Gltf()
    size, bar = 64, 6   # pixels of a square of 0.5 m, half the width of a bar along the square's side

    def is_bar(x, y):
        return min((x + y) % size, -(x + y) % size, (x - y) % size, (y - x) % size) <= bar

    pixels = b"".join(b"\xff\xff\xff\xff" if is_bar(x, y) else b"\xff\xff\xff\0" for y in range(size) for x in range(size))
    lattice = gltf.mask(gltf.material("lattice", (0.35, 0.2, 0.1), double_sided=True), png(size, size, pixels))
    plaster = gltf.material("plaster", (0.7, 0.7, 0.65))
    gltf.piece("floor", [rectangle(1, 0.0, (-3, -2), (3, 2.5), 1)], gltf.material("stone", (0.5, 0.48, 0.45)))
    gltf.piece("wall", [rectangle(2, -2.0, (-3, 0), (3, 3), 1)], plaster)
    gltf.piece("lattice", [rectangle(2, 0.0, (-2, 0), (2, 2), 1)], lattice, uv=lambda p: (2 * p[0], -2 * p[1]))
    posts = gltf.material("posts", (0.3, 0.2, 0.15))
    for name, x in (("left", -2.06), ("right", 2.06)):
        gltf.piece("post_" + name, box((x - 0.05, 0, -0.05), (x + 0.05, 2.1, 0.05), omit=("-y",)), posts)
    gltf.lamp("sun", {"type": "directional", "color": [1.0, 0.95, 0.85], "intensity": 10000.0}, (0, 5, 0), (0.35, -1, -0.8))
    return gltf


def glass_room(_):
    """Two rooms of 3 x 2.5 x 3 m; the first has no lamp, only a window of 2 x 1.5 m with a green pane to the second."""
    gltf = Gltf()
    white = gltf.material("white", (0.7, 0.7, 0.7))
    low, high = (0.5, 0.5), (2.0, 2.5)   # y and z of the window
    for name, near, far in (("dark_room", 3.0, 0.0), ("lit_room", 3.1, 6.1)):
        x0, x1, inward = min(near, far), max(near, far), 1 if far > near else -1
        faces = [rectangle(1, 0.0, (x0, 0), (x1, 3), 1), rectangle(1, 2.5, (x0, 0), (x1, 3), -1),
                 rectangle(2, 0.0, (x0, 0), (x1, 2.5), 1), rectangle(2, 3.0, (x0, 0), (x1, 2.5), -1),
                 rectangle(0, far, (0, 0), (2.5, 3), -inward)]
        faces += [rectangle(0, near, a, b, inward) for a, b in (
            ((0, 0), (low[0], 3)), ((high[0], 0), (2.5, 3)), ((low[0], 0), (high[0], low[1])), ((low[0], high[1]), (high[0], 3)))]
        gltf.piece(name, faces, white)
    gltf.piece("reveal", [rectangle(1, low[0], (3.0, low[1]), (3.1, high[1]), 1), rectangle(1, high[0], (3.0, low[1]), (3.1, high[1]), -1),
                          rectangle(2, low[1], (3.0, low[0]), (3.1, high[0]), 1), rectangle(2, high[1], (3.0, low[0]), (3.1, high[0]), -1)],
               white)
    pane = gltf.glass(gltf.material("pane", (0.25, 0.8, 0.4), double_sided=True))
    gltf.piece("pane", [rectangle(0, 3.05, low, high, -1)], pane)
    gltf.piece("lamp", [rectangle(1, 2.45, (4.2, 1), (5.0, 2), -1)], gltf.material("lamp", (0, 0, 0), (800, 750, 700)))
    return gltf


def checks(size, squares, first, second):
    """A square PNG of squares x squares fields in two sRGB colours by turns."""
    each = size // squares
    return png(size, size, b"".join(bytes((*(first if (x // each + y // each) % 2 else second), 255))
                                    for y in range(size) for x in range(size)))


def painted_room(_):
    """A closed room of 4 x 2.7 x 5 m with patterns on all sides, lit by a sign whose picture shines."""
    gltf = Gltf()
    stripes = png(16, 16, b"".join(bytes((*((225, 190, 90) if x < 8 else (120, 40, 30)), 255)) for _ in range(16) for x in range(16)))
    wall = gltf.paint(gltf.material("wallpaper", (0.9, 0.9, 0.9)), stripes)
    tiles = gltf.paint(gltf.material("tiles", (0.8, 0.8, 0.8)), checks(32, 2, (240, 240, 230), (40, 45, 60)))
    ceiling = gltf.material("ceiling", (0.75, 0.75, 0.75))
    gltf.piece("floor", [rectangle(1, 0.0, (0, 0), (4, 5), 1)], tiles, uv=lambda p: (p[0], p[2]))
    gltf.piece("ceiling", [rectangle(1, 2.7, (0, 0), (4, 5), -1)], ceiling)
    for name, axis, at, high, sign in (("minus_x", 0, 0.0, (2.7, 5), 1), ("plus_x", 0, 4.0, (2.7, 5), -1)):
        gltf.piece("wall_" + name, [rectangle(axis, at, (0, 0), high, sign)], wall, uv=lambda p: (2 * p[2], p[1]))
    for name, axis, at, high, sign in (("minus_z", 2, 0.0, (4, 2.7), 1), ("plus_z", 2, 5.0, (4, 2.7), -1)):
        gltf.piece("wall_" + name, [rectangle(axis, at, (0, 0), high, sign)], wall, uv=lambda p: (2 * p[0], p[1]))
    gltf.piece("chest", box((2.6, 0, 3.2), (3.6, 0.9, 3.9), ("-y",)), ceiling)
    # the sign: 8 x 4 fields, a third of them dark, the others in three colours
    colours = ((255, 240, 200), (255, 90, 60), (0, 0, 0), (80, 130, 255), (255, 240, 200), (0, 0, 0))
    fields = png(64, 32, b"".join(bytes((*colours[(x // 8 + 3 * (y // 8)) % 6], 255)) for y in range(32) for x in range(64)))
    sign = gltf.shine(gltf.material("sign", (0.1, 0.1, 0.1), (600, 600, 600)), fields)
    gltf.piece("sign", [rectangle(0, 0.02, (1.2, 1.5), (2.2, 3.5), 1)], sign, uv=lambda p: ((3.5 - p[2]) / 2, 2.2 - p[1]))
    return gltf


def tinted_room(_):
    """A closed room of 4 x 2.7 x 5 m whose walls have the colours of their vertices: two run from red and from blue to white, the
    others and the chest are white."""
    gltf = Gltf()
    white = gltf.material("white", (0.75, 0.75, 0.75))
    gltf.piece("floor", [rectangle(1, 0.0, (0, 0), (4, 5), 1)], white)
    gltf.piece("ceiling", [rectangle(1, 2.7, (0, 0), (4, 5), -1)], white)
    gltf.piece("wall_minus_x", [rectangle(0, 0.0, (0, 0), (2.7, 5), 1)], white, color=lambda p: (1.0, *[0.05 + 0.95 * p[2] / 5] * 2))
    gltf.piece("wall_plus_x", [rectangle(0, 4.0, (0, 0), (2.7, 5), -1)], white, color=lambda p: (*[1 - 0.9 * p[2] / 5] * 2, 1.0))
    gltf.piece("wall_minus_z", [rectangle(2, 0.0, (0, 0), (4, 2.7), 1)], white)
    gltf.piece("wall_plus_z", [rectangle(2, 5.0, (0, 0), (4, 2.7), -1)], white)
    gltf.piece("chest", box((1.5, 0, 2.2), (2.5, 0.8, 3.2), ("-y",)), white)
    gltf.piece("lamp", [rectangle(1, 2.65, (1.5, 2), (2.5, 3), -1)], gltf.material("lamp", (0, 0, 0), (800, 760, 700)))
    return gltf


def furnished_rooms(columns, rows, lit):
    """Furnished rooms as in the corridors; lit(i, j) says which have a lamp."""
    gltf = Gltf()
    rooms.build(gltf, columns, rows, furnished=True, lit=lit)
    return gltf


def hall(_):
    gltf = Gltf()
    open_plan.build(gltf)
    return gltf


SAMPLES = {
    "cornell_box": cornell_box,
    "furnace": furnace,
    "sphere": sphere,
    "two_squares_parallel": lambda _: two_squares(rectangle(1, 1.0, (0, 0), (1, 1), -1)),
    "two_squares_perpendicular": lambda _: two_squares(rectangle(0, 0.0, (0, 0), (1, 1), 1)),
    "two_rooms": two_rooms,
    "fence": fence,
    "glass_room": glass_room,
    "painted_room": painted_room,
    "tinted_room": tinted_room,
    "corridor_4": lambda _: corridor(2, 2),
    "corridor_16": lambda _: corridor(4, 4),
    "corridor_64": lambda _: corridor(8, 8),
    "open_court": open_court,
    "sun_room": sun_room,
    "lamps_over_floor": lamps_over_floor,
}

SOLVER_SCENES = {
    "rooms_4": lambda _: furnished_rooms(2, 2, lambda i, j: (i, j) == (0, 0)),
    "rooms_36": lambda _: furnished_rooms(6, 6, lambda i, j: True),
    "rooms_64": lambda _: furnished_rooms(8, 8, lambda i, j: (i, j) == (0, 0)),
    "rooms_100": lambda _: furnished_rooms(10, 10, lambda i, j: (i, j) == (5, 5)),
    "open_plan": hall,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join([*SAMPLES, *SOLVER_SCENES]))
    parser.add_argument("--solver-scenes", action="store_true", help="all of " + ", ".join(SOLVER_SCENES))
    parser.add_argument("--out", default=os.path.dirname(os.path.abspath(__file__)), metavar="DIR")
    parser.add_argument("--reflectance", type=float, default=0.5, metavar="R", help="furnace and sphere, 0 to 1 (default 0.5)")
    options = parser.parse_args()
    scenes = {**SAMPLES, **SOLVER_SCENES}
    unknown = [n for n in options.names if n not in scenes]
    if unknown:
        parser.error(f"unknown sample {unknown[0]}; there are: {', '.join(scenes)}")
    names = options.names + (list(SOLVER_SCENES) if options.solver_scenes else [])
    for name in names or SAMPLES:
        gltf = scenes[name](options)
        gltf.save(os.path.join(options.out, name), name)
        print(f"{name}: {gltf.triangle_count()} triangles, {len(gltf.nodes)} nodes")


if __name__ == "__main__":
    main()
