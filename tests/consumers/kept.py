"""What a baked model must still have of its input: everything. Standard library only.

`differences(before, values, after)` lists what was lost or changed, as lines of text; an empty list is a pass.
before  the input as it is
values  the input with its compressed arrays decoded under the same numbers (decode.mjs); `before` itself where none is
after   the baked model, decoded in the same way where it is compressed

Compared: the scenes, nodes, cameras, skins, animations, unknown members, extensions and extras as JSON; arrays by their
elements, in their component types (to one unit where a decoder may round: filters of meshopt); pictures byte for byte; all
materials, textures and samplers under their numbers; every triangle's corners with all attributes and morph targets.
Allowed, as formats/gltf/gltf_out.h says: lightmaps (a second UV set, clones of materials, their textures), vertices that are
split, primitives parted by page, meshes copied per node, strips and fans as triangles, arrays in other views, decoded compression;
copies of a node (EXT_mesh_gpu_instancing) have attributes for their places, and some of them may be shown by children of that node; where
nodes name lightmaps (MX_lightmap), materials are only cloned for moved UV sets, and children of a node show parts of its mesh on other pages. Compression
where it was asked for (is_packed): what Draco holds in the output has moved by its rounding at most, without triangles whose corners meet (rounding.py);
meshopt may begin a triangle with another corner.
"""
import collections
import copy
import struct

import rounding
from corner_lists import all_triangles, corner_triangles, has_three_places, in_order, middles, turned

DRACO = "KHR_draco_mesh_compression"
COMPRESSION = {"EXT_meshopt_compression", "KHR_meshopt_compression", DRACO}
PLACE = {"bufferView", "byteOffset", "sparse"}     # of an accessor: where its elements lie
BOUNDS = {"min", "max"}
COPIES, COPY_PLACES = "EXT_mesh_gpu_instancing", {"_LIGHTMAP_OFFSET", "_LIGHTMAP_SCALE"}
OF_MATERIAL, OF_NODE = "MOZ_lightmap", "MX_lightmap"
GROWING = ("samplers", "textures", "materials")
RESTORED = {"accessors", "bufferViews", "buffers", "images", "meshes", "nodes", "skins", "animations", "asset", "extensionsUsed",
            "extensionsRequired", *GROWING}
MOST_LINES = 20


def differences(before, values, after, is_packed=False):
    found = _Comparison(before, values, after, is_packed)
    try:
        found.run()
    except (IndexError, KeyError, TypeError, ValueError) as error:  # something is gone that has to be there
        found.lines.append(f"the models cannot be compared further: {type(error).__name__} {error}")
    return found.lines


def without(item, *keys):
    return {key: value for key, value in item.items() if key not in keys}


def without_extension(item, *names):
    """The item without these extensions, and without an `extensions` that is left empty."""
    item = dict(item)
    extensions = without(item.pop("extensions", {}), *names)
    return {**item, "extensions": extensions} if extensions else item


def with_moved_set(value, moved):
    """All textures that use TEXCOORD_1 use TEXCOORD_moved instead."""
    if isinstance(value, list):
        return [with_moved_set(item, moved) for item in value]
    if not isinstance(value, dict):
        return value
    return {key: moved if key == "texCoord" and item == 1 else
            item if key in ("extras", OF_MATERIAL) else with_moved_set(item, moved) for key, item in value.items()}


def with_float_bounds(accessor):
    """Bounds of floats as those floats: a file may say 0.1 for the float that is nearest to it."""
    if accessor["componentType"] != 5126:
        return accessor
    return {key: [struct.unpack("<f", struct.pack("<f", number))[0] for number in value] if key in BOUNDS else value
            for key, value in accessor.items()}


def uses_second_set(value):
    return with_moved_set(value, -1) != value


class _Comparison:
    def __init__(self, before, values, after, is_packed):
        self.before, self.values, self.after, self.is_packed, self.lines = before, values, after, is_packed, []
        self.rounded = set()     # arrays that have been compared, where Draco has rounded them
        self.extent = 0          # of the mesh that is compared
        self.is_on_node = False  # of the mesh that is compared: its node names the lightmap
        self.relaid = {node["mesh"] for node in before.items("nodes") if "mesh" in node and OF_NODE in node.get("extensions", {})}

    def say(self, where, what):
        if len(self.lines) < MOST_LINES:
            self.lines.append(f"{where}: {what}")

    def same(self, where, old, new):
        """JSON values, with the place of the first difference."""
        if isinstance(old, dict) and isinstance(new, dict):
            for key in {**old, **new}:
                if key not in new:
                    self.say(where, f"{key} is lost")
                elif key not in old:
                    self.say(where, f"{key} was added")
                else:
                    self.same(f"{where}/{key}", old[key], new[key])
        elif isinstance(old, list) and isinstance(new, list):
            if len(old) != len(new):
                self.say(where, f"had {len(old)} items, has {len(new)}")
            for index, (one, other) in enumerate(zip(old, new)):
                self.same(f"{where}/{index}", one, other)
        elif old != new or isinstance(old, bool) != isinstance(new, bool):
            self.say(where, f"was {old!r:.80}, is {new!r:.80}")

    def run(self):
        old, new = self.before.json, self.after.json
        for key in {**old, **new}:
            if key not in RESTORED:
                self.same(key, {key: old[key]} if key in old else {}, {key: new[key]} if key in new else {})
        self.asset(old["asset"], new["asset"])
        self.extension_lists()
        for name in GROWING:
            self.same(name, self.before.items(name), self.after.items(name)[:len(self.before.items(name))])
        self.pictures()
        self.nodes()
        self.skins_and_animations()
        self.lonely_meshes()

    def asset(self, old, new):
        new = copy.deepcopy(new)
        if new.get("extras", {}).pop("luxel", None) is None:
            self.say("asset/extras", "luxel's version is missing")
        if not new["extras"] and "extras" not in old:
            del new["extras"]
        self.same("asset", {**old, "extras": without(old["extras"], "luxel")} if "luxel" in old.get("extras", {}) else old, new)

    def extension_lists(self):
        textures = self.after.items("textures")[len(self.before.items("textures")):]
        pictures = {name for texture in textures for name in texture.get("extensions", {})}
        packed = COMPRESSION if self.is_packed else set()
        for name, added in (("extensionsUsed", {OF_MATERIAL, OF_NODE, "KHR_texture_transform"} | pictures | packed), ("extensionsRequired", packed)):
            old, new = self.before.items(name), self.after.items(name)
            lost = [item for item in old if item not in new and item not in COMPRESSION | {OF_NODE}]
            more = [item for item in new if item not in old and item not in added]
            if lost or more:
                self.say(name, f"lost {lost}, added {more}")

    def pictures(self):
        for index, old in enumerate(self.before.items("images")):
            where, new = f"images/{index}", self.after.items("images")[index]
            place = {"uri", "bufferView", "mimeType", *({"name"} - old.keys())}
            self.same(where, without(old, *place), without(new, *place))
            if "mimeType" in old and "bufferView" in new and new["mimeType"] != old["mimeType"]:
                self.say(where, f"mimeType was {old['mimeType']}, is {new['mimeType']}")
            try:
                bytes_before = self.before.picture(index)
            except OSError:
                self.same(where, old, new)  # a picture that is not there stays named
                continue
            if bytes_before != self.after.picture(index):
                self.say(where, "its bytes have changed")

    def array(self, where, old, new):
        """An accessor that is not rewritten: members and elements."""
        before, after = (with_float_bounds(without(item, *PLACE)) for item in
                         (self.before.items("accessors")[old], self.after.items("accessors")[new]))
        self.same(where, before, after)
        if self.is_rounded(old):
            self.nearly_same(where, self.values.numbers(old), self.after.numbers(new))
        elif self.values.elements(old) != self.after.elements(new):
            self.say(where, "its elements have changed")

    def is_rounded(self, accessor):
        """Do decoders of this array round, each in its own way? Unit vectors and rotations, as integers."""
        view = self.before.items("accessors")[accessor].get("bufferView")
        extensions = self.before.items("bufferViews")[view].get("extensions", {}) if view is not None else {}
        return any(extensions.get(name, {}).get("filter") in ("OCTAHEDRAL", "QUATERNION") for name in COMPRESSION)

    def nearly_same(self, where, old, new):
        """Tuples of integers that differ by one at most."""
        if len(old) != len(new) or any(abs(a - b) > 1 for one, other in zip(old, new) for a, b in zip(one, other)):
            self.say(where, "its elements have changed by more than rounding")

    def arrays(self, where, old, new):
        """A map from names to accessors."""
        self.same(where, sorted(old), sorted(new))
        for name in old.keys() & new.keys():
            self.array(f"{where}/{name}", old[name], new[name])

    def nodes(self):
        nodes, count = self.after.items("nodes"), len(self.before.items("nodes"))
        added = set(range(count, len(nodes)))
        for index, (old, new) in enumerate(zip(self.before.items("nodes"), nodes)):
            where = f"nodes/{index}"
            parts = [child for child in new.get("children", []) if child in added]
            added -= set(parts)
            if parts:
                kept = [child for child in new["children"] if child not in parts]
                new = {**without(new, "children"), **({"children": kept} if "children" in old else {})}
                if COPIES not in old.get("extensions", {}) and OF_NODE not in new.get("extensions", {}):
                    self.say(where, f"nodes {parts} were added below it")
            self.same(where, *(without_extension(without(item, "mesh"), COPIES, OF_NODE) for item in (old, new)))
            self.shown_meshes(where, old, [new, *(nodes[part] for part in parts)])
        if added or len(nodes) < count:
            self.say("nodes", f"there were {count}, there are {len(nodes)}; of them {sorted(added)} belong to none")

    def shown_meshes(self, where, old, shown):
        self.copies(where, old, shown)
        if any(("mesh" in old) != ("mesh" in item) for item in shown):
            self.say(where, "its mesh was lost or added")
        elif "mesh" in old:
            self.meshes_of_node(where, old, shown)

    def meshes_of_node(self, where, old, shown):
        """What the nodes `shown` show together is the mesh of the node `old`: copies of it whole, pages of it in parts."""
        lightmaps = [item.get("extensions", {}).get(OF_NODE) for item in shown]
        if any(lightmaps) and not all(lightmaps):
            self.say(where, "a part of it has no lightmap")
        self.is_on_node = all(lightmaps)
        for lightmap in filter(None, lightmaps):
            self.node_lightmap(where, lightmap)
        before = self.before.items("meshes")[old["mesh"]]
        after = [self.after.items("meshes")[item["mesh"]] for item in shown]
        if COPIES not in old.get("extensions", {}) and len(shown) > 1:
            for part, item in zip(after[1:], shown[1:]):
                self.same(f"{where}/mesh", without(before, "primitives"), without(part, "primitives"))
                for key in ("skin", "weights"):
                    self.same(where, {key: old.get(key)}, {key: item.get(key)})
            after = [{**after[0], "primitives": self.joined(before, after)}]
        for mesh in after:
            self.mesh(f"{where}/mesh", before, mesh, old["mesh"] in self.relaid)
        self.is_on_node = False

    def node_lightmap(self, where, lightmap):
        texture, pages = lightmap["lightMapTexture"], range(len(self.before.items("textures")), len(self.after.items("textures")))
        if texture["texCoord"] != 1 or texture["index"] not in pages or not lightmap["intensity"] > 0:
            self.say(where, f"its lightmap is {lightmap}")
        for low, size in zip(lightmap.get("offset", (0, 0)), lightmap.get("scale", (1, 1))):
            if not 0 <= low <= low + size <= 1:
                self.say(where, "the place of its lightmap leaves the page")

    def joined(self, old, meshes):
        """The primitives of meshes that are one mesh by lightmap page, in the order of that mesh."""
        rests, found, extent = [list(mesh["primitives"]) for mesh in meshes], [], self.mesh_extent(old)
        for primitive in old["primitives"]:
            own = middles(self.values, self.values_of(primitive))
            for rest in rests:
                if rest and self.is_part_of(primitive, own, rest[0], extent if self.is_draco(rest[0]) else 0):
                    found.append(rest.pop(0))
        return found + sum(rests, [])

    def is_part_of(self, primitive, own, part, extent):
        """Is the first triangle of `part` where one of `own` is, of the same material or a clone? What has no triangles is where it was."""
        first, material = middles(self.after, part)[:1], part.get("material")
        if not own or not first or material != primitive.get("material") and material in range(len(self.before.items("materials"))):
            return not own and not first
        step = rounding.allowed("POSITION", own, True, extent)
        return any(all(abs(a - b) <= 2 * step for a, b in zip(middle, first[0])) for middle in own)

    def mesh_extent(self, mesh):
        return rounding.extent([row for item in map(self.values_of, mesh["primitives"]) for row in self.values.numbers(item["attributes"]["POSITION"])])

    def copies(self, where, old, shown):
        """Copies of a node, which the nodes `shown` show together: each with all its attributes, in any order."""
        extensions = [item.get("extensions", {}).get(COPIES) for item in (old, *shown)]
        if not any(extensions):
            return
        if not all(extensions):
            self.say(where, f"{COPIES} was lost or added")
            return
        before, *parts = extensions
        for part in parts:
            self.same(f"{where}/{COPIES}", without(before, "attributes"), without(part, "attributes"))
            self.same(f"{where}/{COPIES}", sorted(before["attributes"]), sorted(part["attributes"].keys() - (COPY_PLACES - before["attributes"].keys())))
        names = sorted(before["attributes"].keys() & set.intersection(*(set(part["attributes"]) for part in parts)))
        for name in names:
            for part in parts:
                self.described(f"{where}/{COPIES}/{name}", before["attributes"][name], part["attributes"][name])
        rows = sorted(zip(*(self.values.elements(before["attributes"][name]) for name in names)))
        found = sorted(row for part in parts for row in zip(*(self.after.elements(part["attributes"][name]) for name in names)))
        if rows != found:
            self.say(f"{where}/{COPIES}", f"of {len(rows)} copies {len(collections.Counter(rows) - collections.Counter(found))} are lost or changed")

    def lonely_meshes(self):
        shown = {node["mesh"] for node in self.before.items("nodes") if "mesh" in node}
        for index, old in enumerate(self.before.items("meshes")):
            if index not in shown:
                self.mesh(f"meshes/{index}", old, self.after.items("meshes")[index])

    def skins_and_animations(self):
        for name, number in (("skins", "inverseBindMatrices"), ("animations", "")):
            for index, (old, new) in enumerate(zip(self.before.items(name), self.after.items(name))):
                self.same(f"{name}/{index}", without(old, number, "samplers"), without(new, number, "samplers"))
                if number and number in old:
                    self.array(f"{name}/{index}/{number}", old[number], new[number])
                for place, (one, other) in enumerate(zip(old.get("samplers", []), new.get("samplers", []))):
                    where = f"{name}/{index}/samplers/{place}"
                    self.same(where, without(one, "input", "output"), without(other, "input", "output"))
                    self.array(where + "/input", one["input"], other["input"])
                    self.array(where + "/output", one["output"], other["output"])
                self.same(f"{name}/{index}/samplers", len(old.get("samplers", [])), len(new.get("samplers", [])))
            self.same(name, len(self.before.items(name)), len(self.after.items(name)))

    # --- meshes --------------------------------------------------------------------------------------------------

    def mesh(self, where, old, new, is_relaid=False):
        """is_relaid: the second UV set of the input is of an earlier lightmap of its node."""
        self.same(where, without(old, "primitives"), without(new, "primitives"))
        rest = list(new["primitives"])
        if any(map(self.is_draco, rest)):
            self.extent = self.mesh_extent(old)
        for index, primitive in enumerate(old["primitives"]):
            here = f"{where}/primitives/{index}"
            if not rest:
                self.say(here, "is lost")
                return
            if self.has_no_layout(primitive, rest[0]):
                self.unchanged(here, primitive, rest.pop(0))
                continue
            counted = self.own_triangles if any(self.is_draco(item) for item in rest) else all_triangles
            parts, wanted = [], counted(self.values, self.values_of(primitive))
            while rest and wanted > 0:
                parts.append(rest.pop(0))
                wanted -= (all_triangles if self.is_draco(parts[-1]) else counted)(self.after, parts[-1])
            if wanted:
                self.say(here, f"{wanted} triangles are missing")
            self.parts(here, primitive, parts, is_relaid)
        if rest:
            self.say(where, f"{len(rest)} primitives were added")

    @staticmethod
    def is_draco(primitive):
        return DRACO in primitive.get("extensions", {})

    def own_triangles(self, file, primitive):
        """Those that Draco keeps: all where there are morph targets, else those with three places."""
        if "targets" in primitive or not file.triangles(primitive):
            return all_triangles(file, primitive)
        return sum(has_three_places(triangle) for triangle in corner_triangles(file, primitive, [file.elements(primitive["attributes"]["POSITION"])]))

    def has_no_layout(self, old, new):
        """Is it as it was? Of those with a layout the material tells, or where nodes name lightmaps the second UV set."""
        if not self.is_on_node:
            return new.get("material") == old.get("material")
        sets = [item["attributes"].get("TEXCOORD_1") for item in (old, new)]
        return sets[1] is None or sets[0] is not None and self.values.elements(sets[0]) == self.after.elements(sets[1])

    def values_of(self, primitive):
        """The same primitive without compression: its arrays have the same numbers there."""
        return without_extension(primitive, *COMPRESSION)

    def unchanged(self, where, old, new):
        arrays = ("attributes", "indices", "targets")
        self.same(where, *(without_extension(without(item, *arrays), *COMPRESSION) for item in (old, new)))
        if self.is_draco(new) and not self.is_draco(old):
            self.same(where, sorted(old["attributes"]), sorted(new["attributes"]))
            self.rounded_parts(where, old, [new], [(name, old["attributes"][name], [new["attributes"][name]]) for name in sorted(old["attributes"])])
            return
        self.arrays(where, old["attributes"], new["attributes"])
        for one, other in zip(old.get("targets", []), new.get("targets", [])):
            self.arrays(where + "/targets", one, other)
        self.same(where + "/targets", len(old.get("targets", [])), len(new.get("targets", [])))
        self.same(where, "indices" in old, "indices" in new)
        if "indices" in old and "indices" in new:
            self.indices(where + "/indices", old, new)

    def indices(self, where, old, new):
        """Of a primitive that is as it was; meshopt may begin a triangle with another corner."""
        if not self.is_packed or all_triangles(self.after, new) == 0:
            self.array(where, old["indices"], new["indices"])
            return
        self.described(where, old["indices"], new["indices"])
        lists = [file.triangles(primitive) for file, primitive in ((self.values, self.values_of(old)), (self.after, new))]
        before, after = ([turned(of[at:at + 3]) for at in range(0, len(of), 3)] for of in lists)
        if before != after:
            self.say(where, "its triangles have changed")

    def moved_set(self, primitive, is_relaid):
        """Where TEXCOORD_1 of the input must be now: a number, or None where it may go, 1 where there was none."""
        if "TEXCOORD_1" not in primitive["attributes"]:
            return 1
        materials = [self.before.items("materials")[index] for index in self.materials_of(primitive)]
        had_lightmap = is_relaid or any(OF_MATERIAL in material.get("extensions", {}) for material in materials)
        if had_lightmap and not any(uses_second_set(item) for item in (*materials, primitive)):
            return None
        free = 2
        while f"TEXCOORD_{free}" in primitive["attributes"]:
            free += 1
        return free

    @staticmethod
    def materials_of(primitive):
        mappings = primitive.get("extensions", {}).get("KHR_materials_variants", {}).get("mappings", [])
        return [item["material"] for item in (primitive, *mappings) if "material" in item]

    def parts(self, where, old, parts, is_relaid):
        moved = self.moved_set(old, is_relaid)
        rename = {"TEXCOORD_1": None if moved is None else f"TEXCOORD_{moved}"}
        rewritten = ("attributes", "indices", "targets", "mode", "material")
        for part in parts:
            self.part_members(where, *(without_extension(without(item, *rewritten), *COMPRESSION) for item in (old, part)), moved or 1)
            self.clone(where, old.get("material"), part.get("material"), moved or 1)
            names = {rename.get(name, name) for name in old["attributes"]} - {None}
            self.same(f"{where}/attributes", sorted(names | {"TEXCOORD_0", "TEXCOORD_1"}), sorted(part["attributes"]))
            self.lightmap_set(where, part["attributes"]["TEXCOORD_1"])
        sets = [(old["attributes"], [part["attributes"] for part in parts])]
        for index, target in enumerate(old.get("targets", [])):
            sets.append((target, [part["targets"][index] for part in parts]))
        triples = [(name, before[name], [after[rename.get(name, name)] for after in afters])
                   for before, afters in sets for name in sorted(before) if rename.get(name, name)]
        pairs = [(accessor, copies) for _, accessor, copies in triples]
        for accessor, copies in pairs:
            for one in copies:
                self.described(where, accessor, one)
        if any(map(self.is_draco, parts)) or self.is_packed and any(self.is_rounded(accessor) for accessor, _ in pairs):
            self.rounded_parts(where, old, parts, triples)
            return
        exact = [pair for pair in pairs if not self.is_rounded(pair[0])]
        before = self.corners(self.values, self.values_of(old), [accessor for accessor, _ in exact])
        after = [self.corners(self.after, part, [copies[number] for _, copies in exact]) for number, part in enumerate(parts)]
        if self.same_triangles(where, before, after):
            for accessor, copies in (pair for pair in pairs if self.is_rounded(pair[0])):
                self.rounded_corners(where, old, parts, (accessor, copies), in_order(before, after))

    def part_members(self, where, old, new, moved):
        """Members of a rewritten primitive. Its variants show clones as well."""
        name = "KHR_materials_variants"
        variants = [item.get("extensions", {}).get(name, {}).get("mappings", []) for item in (old, new)]
        self.same(where, with_moved_set(without_extension(old, name), moved), without_extension(new, name))
        self.same(where, len(variants[0]), len(variants[1]))
        for one, other in zip(*variants):
            self.same(where, without(one, "material"), without(other, "material"))
            self.clone(where, one["material"], other["material"], moved)

    def clone(self, where, old, new, moved):
        before, after = (file.items("materials")[index] if index is not None else {} for file, index in ((self.before, old), (self.after, new)))
        self.same(f"{where}/material", with_moved_set(without_extension(before, OF_MATERIAL), moved), without_extension(after, OF_MATERIAL))
        if (OF_MATERIAL in after.get("extensions", {})) == self.is_on_node:
            self.say(where, f"material {new} has {'a' if self.is_on_node else 'no'} lightmap")

    def lightmap_set(self, where, index):
        accessor = self.after.items("accessors")[index]
        self.same(f"{where}/TEXCOORD_1", ("VEC2", 5126), (accessor["type"], accessor["componentType"]))
        if not all(0 <= value <= 1 for pair in self.after.numbers(index) for value in pair):
            self.say(f"{where}/TEXCOORD_1", "leaves the page")

    def described(self, where, old, new):
        """Members of an accessor whose elements were gathered: all but those that say how many and where."""
        drop = PLACE | BOUNDS | {"count"}
        before, after = ({"normalized": False, **without(item, *drop)}
                         for item in (self.before.items("accessors")[old], self.after.items("accessors")[new]))
        self.same(where, before, after)

    def rounded_corners(self, where, old, parts, pair, order):
        """Corners of arrays whose decoders round; order: for each triangle of the input, (part, triangle) of the output."""
        accessor, copies = pair
        file_of = [(self.values, self.values_of(old), accessor), *((self.after, part, copy) for part, copy in zip(parts, copies))]
        lists = [[file.numbers(array)[i] for i in file.triangles(primitive)] for file, primitive, array in file_of]
        found = [corner for part, at in order for corner in lists[1 + part][3 * at:3 * at + 3]]
        self.nearly_same(where, lists[0], found)

    def rounded_parts(self, where, old, parts, triples):
        """Corners with all attributes, where Draco has put them into another order and rounded them. triples: name, accessor, those of the parts."""
        key = repr([[item["attributes"], item.get("indices"), item.get("targets")] for item in (old, *parts)])
        if key in self.rounded:
            return  # several nodes show these arrays
        self.rounded.add(key)
        before, after, place = [], [[] for _ in parts], 0
        for column, (name, accessor, copies) in enumerate(triples):
            rows, is_float = self.values.numbers(accessor), self.before.items("accessors")[accessor]["componentType"] == 5126
            step = 1 if self.is_rounded(accessor) else rounding.allowed(name, rows, is_float, self.extent)
            before.append(rounding.over(rows, step))
            for part, copy in zip(after, copies):
                part.append(rounding.over(self.after.numbers(copy), step))
            place = column if name == "POSITION" else place
        wanted = corner_triangles(self.values, self.values_of(old), before)
        found = [(triangle, self.is_draco(part)) for part, columns in zip(parts, after) for triangle in corner_triangles(self.after, part, columns)]
        if "targets" not in old:  # where order matters nothing is dropped
            wanted = [triangle for triangle in wanted if has_three_places([corner[place] for corner in triangle])]
            found = [(triangle, packed) for triangle, packed in found if packed or has_three_places([corner[place] for corner in triangle])]
        worst = rounding.worst_move(wanted, [triangle for triangle, _ in found])
        if worst > 1.001:
            self.say(where, f"{len(wanted)} triangles became {len(found)}, moved by up to {worst:.3g} of what Draco may")
        elif rounding.is_turned_over(*([[corner[place] for corner in triangle] for triangle in triangles] for triangles in (wanted, [t for t, _ in found]))):
            self.say(where, "triangles are turned over")

    def corners(self, file, primitive, accessors):
        """Per triangle: the bytes of its three corners in all these arrays."""
        triangles = corner_triangles(file, primitive, [file.elements(accessor) for accessor in accessors])
        return [b"".join(map(b"".join, turned(triangle) if self.is_packed else triangle)) for triangle in triangles]

    def same_triangles(self, where, before, parts):
        after = [triangle for part in parts for triangle in part]
        if before == after:
            return True
        if len(parts) == 1:
            wrong = next((i for i, (one, other) in enumerate(zip(before, after)) if one != other), min(len(before), len(after)))
            self.say(where, f"triangle {wrong} of {len(before)} has changed")
            return False
        lost = collections.Counter(before) - collections.Counter(after)
        if lost:
            self.say(where, f"{sum(lost.values())} triangles of {len(before)} are not among the parts")
        return not lost
