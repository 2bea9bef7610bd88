"""One closed hall without inner walls, furnished in rows: nearly everything sees everything, so no chunk is apart from
the others. The furniture, the lamps and their promises are those of rooms.py."""
import rooms
from gltf_writer import rectangle

WIDTH, HEIGHT, DEPTH = 24.0, rooms.HEIGHT, 15.0   # x y z, metres
COLUMNS = 10                                      # pieces in a row, each in the middle of a cell of 2.4 x 2.5 m
ROWS = [("shelf", "shelf"), ("table", "chair"), ("crate", "column"), ("chair", "table"), ("vase", "crate"), ("shelf", "table")]
LAMPS = (4, 2)                                    # along x and z, between cells, where no column stands


def add_shell(gltf):
    """Floor, ceiling and walls, in different colours."""
    low, high = (0.0, 0.0), (WIDTH, DEPTH)
    gltf.piece("hall_floor", [rectangle(1, 0.0, low, high, 1)], gltf.material("hall_floor", rooms.FLOOR_COLOURS[2]))
    gltf.piece("hall_ceiling", [rectangle(1, HEIGHT, low, high, -1)], gltf.material("hall_ceiling", (0.82, 0.82, 0.80)))
    for number, (name, axis, at, sign) in enumerate((("west", 0, 0.0, 1), ("east", 0, WIDTH, -1), ("north", 2, 0.0, 1),
                                                     ("south", 2, DEPTH, -1))):
        far = (HEIGHT, DEPTH) if axis == 0 else (WIDTH, HEIGHT)
        colour = gltf.material(f"hall_{name}", rooms.WALL_COLOURS[number])
        gltf.piece(f"hall_wall_{name}", [rectangle(axis, at, (0.0, 0.0), far, sign)], colour)


def build(gltf):
    """The whole hall. A piece is shifted by at most 0.2 m, turned by at most 16 degrees and scaled by at most a tenth, so
    the circles around two pieces (0.81 m for a table) never meet. Columns reach the ceiling and are not scaled."""
    add_shell(gltf)
    cell_x, cell_z = WIDTH / COLUMNS, DEPTH / len(ROWS)
    pieces = rooms.furniture_meshes(gltf)
    for j, kinds in enumerate(ROWS):
        for i in range(COLUMNS):
            kind = kinds[i % 2]
            x = (i + 0.5) * cell_x + (rooms.mix(i, j, 21) % 5 - 2) * 0.1
            z = (j + 0.5) * cell_z + (rooms.mix(i, j, 22) % 5 - 2) * 0.1
            size = 1.0 if kind == "column" else 0.9 + 0.05 * (rooms.mix(i, j, 23) % 5)
            turn = (rooms.mix(i, j, 24) % 9 - 4) * 4.0
            gltf.node(f"{kind}_{i}_{j}", pieces[kind], None, (x, 0.0, z), turn, (size, size, size))
    for j in range(LAMPS[1]):
        for i in range(LAMPS[0]):
            rooms.add_lamp(gltf, i, j, None, (2 * cell_x * (i + 1), 2 * cell_z * (j + 1)))
