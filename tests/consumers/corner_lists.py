"""Triangles as lists of their corners, apart from how a file stores vertices and indices. Standard library only."""
import collections


def all_triangles(file, primitive):
    """How many."""
    return len(file.triangles(primitive) or []) // 3


def corner_triangles(file, primitive, columns):
    """Per triangle of a primitive of a GltfFile its three corners, each with the elements of all columns, which have one per vertex."""
    vertices = list(zip(*columns))
    of = [vertices[index] for index in file.triangles(primitive)]
    return [of[at:at + 3] for at in range(0, len(of), 3)]


def middles(file, primitive):
    """Of its triangles; none of points and lines."""
    if not file.triangles(primitive):
        return []
    triangles = corner_triangles(file, primitive, [file.numbers(primitive["attributes"]["POSITION"])])
    return [tuple(sum(corner[0][axis] for corner in triangle) / 3 for axis in range(3)) for triangle in triangles]


def has_three_places(triangle):
    return len(set(triangle)) == 3


def turned(triangle):
    """The same triangle, begun with its least corner."""
    return min(triangle[first:] + triangle[:first] for first in range(3))


def in_order(before, parts):
    """Which (part, triangle) each triangle of the input became: parts keep the order."""
    waiting = collections.defaultdict(list)
    for number, part in enumerate(parts):
        for at, triangle in enumerate(part):
            waiting[triangle].append((at, number))
    for places in waiting.values():
        places.sort(reverse=True)
    return [waiting[triangle].pop()[::-1] for triangle in before]
