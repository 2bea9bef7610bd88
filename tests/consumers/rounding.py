"""How far Draco may move the numbers of a mesh, and a comparison that needs neither its order of triangles nor of vertices.

Where every one of many numbers moves by at most t, so does each place of their sorted list, and this holds for every linear function of them too. So
corners with all their attributes become points, each number over what it may move by, and triangles the means of their three; both are seen from many
directions, each attribute by itself and mixed ones, and the sorted lists compared. Which way triangles are wound is counted: those that clearly show their
front to a direction must still be as many. Standard library only.
"""
import random

# Default bits of --draco-bits; of the others, 12.
BITS = {"POSITION": 14, "NORMAL": 10, "TEXCOORD": 12, "COLOR": 8}
# Grids that are not the range of the values: signs and sums of these have to stay what they are.
LEAST_RANGE = {"TANGENT": 2, "WEIGHTS": 1, "COLOR": 1}
# Of directions stored as two numbers on an octahedron, 2 / 1023 apart.
NORMAL_STEP = 0.005
MIXED = 12
FLOAT_STEP = 1e-6  # of single precision, on the way


def extent(rows):
    """The largest range of a component."""
    return max((max(column) - min(column) for column in zip(*rows)), default=0)


def allowed(semantic, rows, is_float, mesh_extent):
    """How far a number of this attribute may move; whole numbers stay. mesh_extent: of all positions of the mesh."""
    size = max((abs(value) for row in rows for value in row), default=0)
    if not is_float:
        return 0.25
    kind = semantic.split("_")[0] if not semantic.startswith("_") else semantic
    if kind == "NORMAL":
        return NORMAL_STEP
    steps = 2 ** BITS.get(kind, 12) - 1
    span = mesh_extent if kind == "POSITION" else max(extent(rows), LEAST_RANGE.get(kind, 0))
    if kind == "TEXCOORD":
        span = min(span, 1)  # more repeats get more bits
    return 0.5 * span / steps + FLOAT_STEP * size + 1e-12


def over(rows, step):
    """Numbers as multiples of what they may move by."""
    return [tuple(value / step for value in row) for row in rows]


def worst_move(before, after):
    """How far the corners of one list of triangles (corner_lists.py; elements as `over` makes them) are from those of another, as a multiple of what
    is allowed. Lists of other lengths are infinitely far."""
    before, after = ([[sum(corner, ()) for corner in triangle] for triangle in triangles] for triangles in (before, after))
    if len(before) != len(after):
        return float("inf")
    if not before:
        return 0
    corners = [[corner for triangle in triangles for corner in triangle] for triangles in (before, after)]
    means = [[tuple(sum(column) / 3 for column in zip(*triangle)) for triangle in triangles] for triangles in (before, after)]
    return max(_seen_from(direction, *lists) for direction in _directions(len(before[0][0])) for lists in (corners, means))


def is_turned_over(before, after):
    """Do fewer triangles show their front, or their back, to a direction than must? Triangles of three places, as `over` makes them."""
    seen = [(_normal(triangle), _normal_error(triangle)) for triangle in before]
    normals = [_normal(triangle) for triangle in after]
    for direction in VIEWS:
        for sign in (1, -1):
            least = sum(sign * _dot(direction, normal) > error for normal, error in seen)
            if sum(sign * _dot(direction, normal) > 0 for normal in normals) < least:
                return True
    return False


VIEWS = ((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (1, -1, 1), (1, 1, -1), (-1, 1, 1))


def _dot(one, other):
    return sum(a * b for a, b in zip(one, other))


def _edges(triangle):
    return [[b - a for a, b in zip(triangle[0], triangle[k])] for k in (1, 2)]


def _normal(triangle):
    (ax, ay, az), (bx, by, bz) = _edges(triangle)
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


def _normal_error(triangle):
    """Of the sum of a normal's components, where every coordinate may move by one."""
    return 3 * (2 * sum(abs(value) for edge in _edges(triangle) for value in edge) + 8)


def _directions(size):
    chance = random.Random(size)
    yield from ([int(k == axis) for k in range(size)] for axis in range(size))
    yield from ([chance.choice((-1, 1)) for _ in range(size)] for _ in range(MIXED if size > 1 else 0))


def _seen_from(direction, one, other):
    lists = [sorted(sum(d * value for d, value in zip(direction, point)) for point in points) for points in (one, other)]
    return max(abs(a - b) for a, b in zip(*lists)) / sum(map(abs, direction))
