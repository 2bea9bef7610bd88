"""Rooms in a grid, with doors in the shared walls, ceiling lamps and furniture: the corridor samples, two_rooms and
scenes for measuring solvers.

Only what can be seen from inside is modelled: inner faces of walls, and the reveals of the doors, which give the walls
their thickness. All fronts look into the air; the whole is closed. Solids meet the floor, the ceiling or each other
without a face of their own there (or end inside one another), so that no two faces lie in one another.
"""
from gltf_writer import box, lathe, rectangle

WIDTH, HEIGHT, DEPTH = 4.0, 2.7, 5.0   # a room, x y z, metres
WALL = 0.2                             # thickness of the walls between rooms, metres
DOOR_WIDTH, DOOR_HEIGHT = 0.9, 2.1     # metres

WALL_COLOURS = [(0.75, 0.73, 0.70), (0.62, 0.22, 0.16), (0.30, 0.48, 0.62), (0.66, 0.62, 0.35),
                (0.36, 0.55, 0.30), (0.80, 0.80, 0.82), (0.55, 0.40, 0.52), (0.48, 0.47, 0.45)]
FLOOR_COLOURS = [(0.42, 0.28, 0.18), (0.35, 0.35, 0.36), (0.55, 0.50, 0.42), (0.22, 0.26, 0.30), (0.50, 0.22, 0.18)]
LAMP_NITS = [(3000, 2550, 1950), (2600, 2600, 2500), (1900, 2150, 2600)]  # warm, neutral, cool


def mix(*values):
    """A fixed 32-bit number from small integers: the only source of variety here."""
    state = 2166136261
    for value in values:
        state = ((state ^ value) * 16777619) & 0xFFFFFFFF
    for _ in range(2):
        state ^= state >> 15
        state = (state * 0x2C1B3C6D) & 0xFFFFFFFF
    return state ^ (state >> 16)


class Grid:
    """columns x rows rooms; room (i, j) begins at x = i (WIDTH + WALL), z = j (DEPTH + WALL)."""

    def __init__(self, columns, rows):
        self.columns, self.rows = columns, rows

    def origin(self, i, j):
        return i * (WIDTH + WALL), j * (DEPTH + WALL)

    def door(self, i, j, axis):
        """Start of the door from room (i, j) towards +x (axis 0) or +z (axis 2) along the wall, metres; None: no door.
        Each row is connected through all its rooms, and rows by their first column and some more."""
        if (axis == 0 and i + 1 >= self.columns) or (axis == 2 and j + 1 >= self.rows):
            return None
        if axis == 2 and i > 0 and mix(i, j, 7) % 3 == 0:
            return None
        length = DEPTH if axis == 0 else WIDTH
        return 0.4 + (length - DOOR_WIDTH - 0.8) * (mix(i, j, axis, 11) % 9) / 8

    def wall(self, i, j, axis, sign):
        """Faces of one wall of room (i, j), seen from inside; a door leaves a hole."""
        x, z = self.origin(i, j)
        start = (z if axis == 0 else x)
        length = DEPTH if axis == 0 else WIDTH
        at = (x + (WIDTH if sign > 0 else 0)) if axis == 0 else (z + (DEPTH if sign > 0 else 0))
        if sign > 0:
            door = self.door(i, j, axis)
        else:
            back = (i - 1, j) if axis == 0 else (i, j - 1)
            door = self.door(*back, axis) if min(back) >= 0 else None
        pieces = [(0.0, length, 0.0, HEIGHT)]
        if door is not None:
            pieces = [(0.0, door, 0.0, HEIGHT), (door + DOOR_WIDTH, length, 0.0, HEIGHT),
                      (door, door + DOOR_WIDTH, DOOR_HEIGHT, HEIGHT)]
        faces = []
        for a, b, y0, y1 in pieces:
            low, high = ((y0, start + a), (y1, start + b)) if axis == 0 else ((start + a, y0), (start + b, y1))
            faces.append(rectangle(axis, at, low, high, -sign))
        return faces

    def reveal(self, i, j, axis):
        """Threshold, lintel and jambs of the door from room (i, j) towards +axis, or None."""
        door = self.door(i, j, axis)
        if door is None:
            return None
        x, z = self.origin(i, j)
        if axis == 0:
            x0, x1, z0, z1 = x + WIDTH, x + WIDTH + WALL, z + door, z + door + DOOR_WIDTH
            jambs = [rectangle(2, z0, (x0, 0.0), (x1, DOOR_HEIGHT), 1), rectangle(2, z1, (x0, 0.0), (x1, DOOR_HEIGHT), -1)]
        else:
            x0, x1, z0, z1 = x + door, x + door + DOOR_WIDTH, z + DEPTH, z + DEPTH + WALL
            jambs = [rectangle(0, x0, (0.0, z0), (DOOR_HEIGHT, z1), 1), rectangle(0, x1, (0.0, z0), (DOOR_HEIGHT, z1), -1)]
        return jambs + [rectangle(1, 0.0, (x0, z0), (x1, z1), 1), rectangle(1, DOOR_HEIGHT, (x0, z0), (x1, z1), -1)]


def add_shell(gltf, grid, i, j, parent):
    """Floor, ceiling, four walls and the doors towards +x and +z."""
    label = f"room_{i}_{j}"
    colour, ground = mix(i, j, 1) % len(WALL_COLOURS), mix(i, j, 2) % len(FLOOR_COLOURS)
    wall = gltf.material(f"wall_{colour}", WALL_COLOURS[colour])
    floor = gltf.material(f"floor_{ground}", FLOOR_COLOURS[ground])
    white, wood = gltf.material("ceiling", (0.82, 0.82, 0.80)), gltf.material("door_frame", (0.58, 0.46, 0.32))
    x, z = grid.origin(i, j)
    low, high = (x, z), (x + WIDTH, z + DEPTH)
    gltf.piece(f"{label}_floor", [rectangle(1, 0.0, low, high, 1)], floor, parent)
    gltf.piece(f"{label}_ceiling", [rectangle(1, HEIGHT, low, high, -1)], white, parent)
    for name, axis, sign in (("west", 0, -1), ("east", 0, 1), ("north", 2, -1), ("south", 2, 1)):
        gltf.piece(f"{label}_wall_{name}", grid.wall(i, j, axis, sign), wall, parent)
    for name, axis in (("east", 0), ("south", 2)):
        faces = grid.reveal(i, j, axis)
        if faces:
            gltf.piece(f"{label}_door_{name}", faces, wood, parent)


def add_lamp(gltf, i, j, parent, centre):
    """A panel in a thin housing under the ceiling: the housing's underside is a ring around the panel."""
    kind = mix(i, j, 3) % len(LAMP_NITS)
    glow = gltf.material(f"lamp_{kind}", (0.5, 0.5, 0.5), LAMP_NITS[kind])
    metal = gltf.material("housing", (0.6, 0.6, 0.6))
    under, rim = HEIGHT - 0.06, 0.05
    hx, hz = 0.35, 0.65
    housing = box((-hx, under, -hz), (hx, HEIGHT, hz), omit=("-y", "+y"))
    px, pz = hx - rim, hz - rim
    for low, high in (((-hx, -hz), (hx, -pz)), ((-hx, pz), (hx, hz)), ((-hx, -pz), (-px, pz)), ((px, -pz), (hx, pz))):
        housing.append(rectangle(1, under, low, high, -1))
    panel = [rectangle(1, under, (-px, -pz), (px, pz), -1)]
    place = (centre[0], 0.0, centre[1])
    gltf.node(f"room_{i}_{j}_lamp_housing", gltf.mesh("lamp_housing", housing, metal), parent, place)
    gltf.node(f"room_{i}_{j}_lamp_panel", gltf.mesh(f"lamp_panel_{kind}", panel, glow), parent, place)


def furniture_meshes(gltf):
    """The shared pieces, each with its foot at the origin. Legs end inside what they carry."""
    oak, ash = gltf.material("oak", (0.45, 0.30, 0.17)), gltf.material("ash", (0.70, 0.60, 0.45))
    card, clay = gltf.material("cardboard", (0.52, 0.40, 0.26)), gltf.material("clay", (0.60, 0.28, 0.18))
    plaster = gltf.material("plaster", (0.78, 0.77, 0.74))

    def legs(half_x, half_z, thick, top):
        return [f for sx in (-1, 1) for sz in (-1, 1)
                for f in box((sx * half_x - thick / 2, 0.0, sz * half_z - thick / 2),
                             (sx * half_x + thick / 2, top, sz * half_z + thick / 2), omit=("-y", "+y"))]

    table = box((-0.7, 0.71, -0.4), (0.7, 0.75, 0.4)) + legs(0.6, 0.3, 0.06, 0.73)
    chair = (box((-0.21, 0.43, -0.21), (0.21, 0.46, 0.21)) + legs(0.17, 0.17, 0.04, 0.445) +
             box((-0.20, 0.445, 0.16), (0.20, 0.90, 0.19), omit=("-y",)))
    shelf = (box((-0.50, 0.0, -0.15), (-0.47, 1.8, 0.15), omit=("-y",)) + box((0.47, 0.0, -0.15), (0.50, 1.8, 0.15), omit=("-y",)) +
             box((-0.485, 0.0, 0.12), (0.485, 1.79, 0.14), omit=("-y",)))
    for level in range(5):
        y = 0.06 + 0.42 * level
        shelf += box((-0.485, y, -0.14), (0.485, y + 0.025, 0.13))
    crate = box((-0.3, 0.0, -0.2), (0.3, 0.4, 0.2), omit=("-y",))
    vase = lathe([(0.10, 0.0), (0.16, 0.10), (0.18, 0.22), (0.14, 0.34), (0.07, 0.42), (0.09, 0.48), (0.0, 0.49)], 14)
    column = lathe([(0.18, 0.0), (0.18, 0.15), (0.13, 0.2), (0.13, HEIGHT)], 16)
    return {"table": gltf.mesh("table", table, oak), "chair": gltf.mesh("chair", chair, ash),
            "shelf": gltf.mesh("shelf", shelf, oak), "crate": gltf.mesh("crate", crate, card),
            "vase": gltf.mesh("vase", vase, clay), "column": gltf.mesh("column", column, plaster)}


# What stands in a room of each kind: piece, x, y, z (from the room's corner), turn in degrees, scale. One scale is
# mirrored, some are uneven. A piece on another (y > 0) stands on its upper face.
LAYOUTS = [
    [("table", 2.0, 0, 2.4, 8, (1, 1, 1)), ("chair", 1.75, 0, 3.15, 4, (1, 1, 1)), ("chair", 2.4, 0, 1.65, 172, (1, 1, 1)),
     ("vase", 1.8, 0.75, 2.35, 0, (0.7, 0.7, 0.7)), ("shelf", 0.9, 0, 4.6, 0, (1, 1, 1))],
    [("shelf", 0.9, 0, 4.6, 0, (1, 1.1, 1)), ("shelf", 2.05, 0, 4.62, 0, (1, 1.1, 1)), ("chair", 1.3, 0, 2.3, 35, (-1, 1, 1)),
     ("vase", 3.3, 0, 4.2, 0, (1.4, 1.6, 1.4))],
    [("crate", 0.8, 0, 0.9, 20, (1, 1, 1)), ("crate", 0.75, 0.4, 0.95, -15, (0.8, 0.8, 0.8)), ("crate", 1.6, 0, 0.7, 70, (1, 1.5, 1)),
     ("crate", 3.1, 0, 3.7, 45, (1.2, 1.2, 1.6)), ("shelf", 2.6, 0, 4.6, 0, (1.2, 1, 1)), ("vase", 0.7, 0, 3.9, 0, (1, 1, 1))],
    [("column", 1.2, 0, 2.5, 0, (1, 1, 1)), ("column", 2.8, 0, 2.5, 0, (1, 1, 1)), ("crate", 3.3, 0, 0.8, 80, (1, 1, 1)),
     ("table", 2.0, 0, 4.2, 0, (0.9, 1, 1)), ("vase", 2.2, 0.75, 4.2, 10, (0.6, 0.8, 0.6))],
]


def add_furniture(gltf, pieces, i, j, origin, parent):
    for number, (piece, x, y, z, turn, scale) in enumerate(LAYOUTS[mix(i, j, 5) % len(LAYOUTS)]):
        gltf.node(f"room_{i}_{j}_{piece}_{number}", pieces[piece], parent, (origin[0] + x, y, origin[1] + z), turn, scale)


def build(gltf, columns, rows, furnished, lit):
    """The whole grid. lit(i, j) says which rooms have a lamp."""
    grid = Grid(columns, rows)
    pieces = furniture_meshes(gltf) if furnished else {}
    for j in range(rows):
        for i in range(columns):
            room = gltf.node(f"room_{i}_{j}")
            add_shell(gltf, grid, i, j, room)
            origin = grid.origin(i, j)
            if lit(i, j):
                shift = (mix(i, j, 4) % 5 - 2) * 0.2 if furnished else 0.0
                add_lamp(gltf, i, j, room, (origin[0] + WIDTH / 2, origin[1] + DEPTH / 2 + shift))
            if furnished:
                add_furniture(gltf, pieces, i, j, origin, room)
