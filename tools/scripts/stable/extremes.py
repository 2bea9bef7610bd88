"""The table: every extreme that luxel promises something of."""
import math
import os
import tempfile

from lecture.common import table
from stable import rooms
from stable.runs import GATHERED, Failed, bake, measure as measure_room, plain, seconds, worst_texel

# Text, and what makes the room.
ROOMS = [("nothing special", plain()),
         ("albedo 0", plain(rho=0.0)),
         ("albedo 0.999", plain(rho=0.999)),
         ("albedo 1 - 1e-6", plain(rho=1 - 1e-6)),
         ("emission 1e-30 nits", plain(nits=1e-30)),
         ("emission 1e30 nits", plain(nits=1e30)),
         ("scene of 1e-4 m", plain(side=1e-4)),
         ("scene of 1e6 m", plain(side=1e6)),
         ("room of 1 m, 1000 km from the origin", plain(centre=(1e6 + 0.37, 0, 1e6 + 0.21))),
         ("two rooms of 1 m, 1 km apart", lambda lit: rooms.with_second_room(lit, 1e3)),
         ("two rooms of 1 m, 10 km apart", lambda lit: rooms.with_second_room(lit, 1e4)),
         ("two rooms of 1 m, 100 km apart", lambda lit: rooms.with_second_room(lit, 1e5)),
         ("a patch 1e12 times smaller", lambda lit: rooms.with_mote(lit, 1e12)),
         ("slivers, 1 : 1e6", rooms.with_slivers),
         ("triangles without area", rooms.with_flat_triangles),
         ("coincident faces", rooms.with_coincident_faces),
         ("a position that is not a number", rooms.with_bad_position),
         ("vertices of no triangle, at 1e30 m", rooms.with_loose_vertices),
         ("a mirrored instance", rooms.with_mirrored_half)]
QUICK = ["nothing special", "albedo 1 - 1e-6", "emission 1e30 nits", "a patch 1e12 times smaller"]


def ends():
    """What has no light, or none that ends."""
    yield "albedo 1, closed", "an error", lambda: rooms.Room("all", rho=1.0).plain()
    yield "one patch, in the open", 0.0, lambda: rooms.lone_square(100.0)
    yield "no light", 0.0, lambda: rooms.Room("all", nits=0.0).plain()
    yield "no patch", "an error", rooms.nothing


def measure(build, folder, quick):
    """[{what, ...}] of all lines."""
    lines = []
    for what, make in ROOMS:
        if quick and what not in QUICK:
            continue
        try:
            lines.append({"what": what, **measure_room(build, folder, make)})
        except Failed as failed:
            lines.append({"what": what, "expected": make("all").expected(), "text": str(failed)})
    for what, expected, make in ends():
        with tempfile.TemporaryDirectory(dir=folder) as place:
            line = {"what": what, "expected": expected}
            try:
                room = make()
                made = bake(build, place, room.save(os.path.join(place, "room")), room.side, GATHERED)
                line["result"], line["worst"] = worst_texel(made, 0.0)
                line["seconds"] = seconds(made)
            except Failed as failed:
                line["text"] = str(failed)
            lines.append(line)
    return lines


def text_of(value, form):
    return "" if value is None or (isinstance(value, float) and math.isnan(value)) else form.format(value)


def show(lines):
    rows = []
    for line in lines:
        expected = line["expected"] if isinstance(line["expected"], str) else f"{line['expected']:.6g}"
        rows.append([line["what"], expected, line.get("text") or f"{line['result']:.6g}", *(text_of(line.get(key), "{:.1e}") for key in ("worst", "all", "floor", "double", "single")),
                     text_of(line.get("seconds"), "{:.2f}")])
    table(["extreme", "H expected, lux", "result", "worst texel", "all light", "floor", "double", "single", "seconds"], rows)


def check(lines):
    found = {line["what"]: line for line in lines}
    for what in QUICK:
        assert found[what]["worst"] < 1e-2 and found[what]["all"] < 1e-2, f"{what}: {found[what]}"
        assert found[what]["floor"] < 0.02, f"{what}: {found[what]}"
        assert found[what]["double"] < 1e-6, f"{what}: sums in double are off: {found[what]}"
    near = found["albedo 1 - 1e-6"]
    assert near["single"] > 1e3 * near["double"], f"single precision is as good as double: {near}"
    assert "never ends" in found["albedo 1, closed"].get("text", ""), found["albedo 1, closed"]
    assert found["no light"].get("result") == 0.0, found["no light"]
