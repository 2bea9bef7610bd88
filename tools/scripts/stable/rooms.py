"""Closed cubes whose light is known exactly, and what they become at the extremes."""
import math
import os
import struct

import numpy as np

from gltf_writer import Gltf, box, rectangle

TEXELS = 8   # along a wall


def corner_factor(a, b):
    """Form factor from a point to a rectangle a x b that faces it, at a distance of 1 from its corner: Howell's catalogue, B-4."""
    p, q = np.sqrt(1 + a * a), np.sqrt(1 + b * b)
    return (a / p * np.arctan(b / p) + b / q * np.arctan(a / q)) / (2 * math.pi)


class Room:
    """A cube of `side` metres around `centre`, inner faces only. lit: "all" walls glow; or "one", the ceiling;
    or "black": the ceiling, and all walls have an albedo of 0. rho is what it is as a 32-bit number, as
    which luxel keeps it. nits: more than a 16-bit float holds, so that pages keep 32 bits and show more than their rounding."""

    def __init__(self, lit, side=1.0, rho=0.5, nits=1e5, centre=(0, 0, 0)):
        self.lit, self.side, self.nits, self.centre, self.count = lit, side, nits, centre, 1
        self.rho = 0.0 if lit == "black" else struct.unpack("<f", struct.pack("<f", rho))[0]
        self.gltf = Gltf()
        colour = (self.rho, self.rho, self.rho)
        self.glow = self.gltf.material("glow", colour, [nits] * 3) if nits > 0 else self.gltf.material("dark", colour)
        self.wall = self.glow if lit == "all" else self.gltf.material("wall", colour)

    def emitted(self):
        """Of rooms with one wall that glows, lm."""
        return math.pi * self.nits * self.side ** 2 * self.count

    def faces(self):
        """The first is the one that glows in any case."""
        h = self.side / 2
        return [rectangle(axis, sign * h, (-h, -h), (h, h), -sign) for axis in (1, 0, 2) for sign in (1, -1)]

    def add(self, faces, name="walls"):
        """A node for what glows, one for the others."""
        self.gltf.node(name + " 0", self.gltf.mesh(name + " 0", faces[:1], self.glow), translation=self.centre)
        if faces[1:]:
            self.gltf.node(name + " 1", self.gltf.mesh(name + " 1", faces[1:], self.wall), translation=self.centre)

    def plain(self):
        self.add(self.faces())
        return self

    def expected(self):
        """H of every texel where all walls glow, lux."""
        return math.pi * self.nits / (1 - self.rho)

    def below_ceiling(self):
        """H in the middle of a black floor, mean over two texels each way: what a point sees of a rectangle, lux."""
        steps = (np.arange(16) + 0.5) / 16 - 0.5
        x, z = np.meshgrid(*2 * [0.5 + steps * 2 / TEXELS])
        return math.pi * self.nits * float(sum(corner_factor(a, b) for a in (x, 1 - x) for b in (z, 1 - z)).mean())

    def save(self, folder):
        self.gltf.save(folder, "room")
        return os.path.join(folder, "room.gltf")


def with_second_room(lit, distance):
    """The same room again, so many metres away; no ray goes from one to the other."""
    room = Room(lit).plain()
    room.centre = (distance + 0.37, 0, 0.21)
    room.add(room.faces(), "far walls")
    room.centre, room.count = (0, 0, 0), 2
    return room


def with_mote(lit, ratio):
    """A closed box of the room's own material floats in the middle: its faces are `ratio` times smaller than a patch of two texels."""
    room = Room(lit).plain()
    half = room.side * 2 / TEXELS / math.sqrt(ratio) / 2
    room.gltf.node("mote", room.gltf.mesh("mote", box((-1, -1, -1), (1, 1, 1)), room.wall), scale=(half, half, half))
    return room


def with_slivers(lit):
    """One wall is cut into a strip of triangles that are a million times longer than wide, and the rest."""
    room = Room(lit)
    faces, h, w = room.faces(), room.side / 2, room.side * 1e-6
    kept = [f for f in faces if not all(p[0] == h for p in f)]
    strips = [rectangle(0, h, (-h, -h + k * w), (h, -h + (k + 1) * w), -1) for k in range(8)]
    room.add(kept + strips + [rectangle(0, h, (-h, -h + 8 * w), (h, h), -1)])
    return room


def with_flat_triangles(lit):
    """Triangles without area: a corner three times, and three corners in a line."""
    room = Room(lit).plain()
    room.gltf.node("flat", room.gltf.mesh("flat", [[(0.1, 0.0, 0.0)] * 3, [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.2, 0.0, 0.0)]], room.wall))
    return room


def with_coincident_faces(lit):
    """A wall lies in another one."""
    room = Room(lit).plain()
    room.gltf.node("again", room.gltf.mesh("again", room.faces()[2:3], room.wall))
    return room


def with_mirrored_half(lit):
    """Half of the room is the other half, mirrored."""
    room = Room(lit)
    h = room.side / 2
    glow = [rectangle(1, h, (-h, -h), (0, h), -1)]
    others = [rectangle(1, -h, (-h, -h), (0, h), 1), rectangle(0, -h, (-h, -h), (h, h), 1), rectangle(2, h, (-h, -h), (0, h), -1), rectangle(2, -h, (-h, -h), (0, h), 1)]
    for name, faces, material in (("glow", glow, room.glow), ("others", others, room.wall)):
        mesh = room.gltf.mesh(name, faces, material)
        room.gltf.node(name, mesh)
        room.gltf.node(name + " mirrored", mesh, scale=(-1, 1, 1))
    return room


def with_loose_vertices(lit):
    """Vertices that no triangle uses, very far away."""
    room = Room(lit)
    room.add(room.faces() + [[(1e30, 0.0, 0.0), (0.0, -1e30, 0.0)]])
    return room


def with_bad_position(lit):
    """A triangle in the middle of the room with a corner that is not a number."""
    room = Room(lit).plain()
    index = room.gltf.mesh("bad", [[(0.0, 0.0, 0.0), (0.0, 0.0, 0.1), (0.1, 0.0, 0.0)]], room.wall)
    room.gltf.node("bad", index)
    accessor = room.gltf.accessors[room.gltf.meshes[index]["primitives"][0]["attributes"]["POSITION"]]
    struct.pack_into("<f", room.gltf.blob, room.gltf.views[accessor["bufferView"]]["byteOffset"], math.nan)
    return room


def lone_square(nits):
    """One square in the open: one patch, which sees nothing."""
    room = Room("all", nits=nits)
    room.add(room.faces()[:1])
    return room


def nothing():
    """A scene with a node and no mesh."""
    room = Room("all")
    room.gltf.node("empty")
    return room
