"""Irradiance by path tracing on Mitsuba 3's ray casting: the independent truth that lightmaps are compared with.

Unidirectional paths with next event estimation, weighted against the cosine rays (balance heuristic, Veach 1997), no
limit of bounces, Russian roulette by throughput. Surfaces are diffuse. One that is not doubleSided reflects and emits on
its front and absorbs on its back; a doubleSided one does both on both. What lets light through (alpha, transmission) is met by
the chance of its opacity, or passed straight on in the pane's colour; shadow rays multiply what passes. Bounces use geometric normals, as exchange areas
do; the receiving point may have a shading normal. Lengths are normalised to a half extent of 1 before single precision.
Needs the variant llvm_ad_rgb, so libLLVM 16 or newer (Debian: libllvm19).
"""
import glob
import os

import numpy as np

if "DRJIT_LIBLLVM_PATH" not in os.environ:
    for _path in sorted(glob.glob("/usr/lib/*/libLLVM.so.19*")):
        os.environ["DRJIT_LIBLLVM_PATH"] = _path
import drjit as dr          # noqa: E402
import mitsuba as mi        # noqa: E402

mi.set_variant("llvm_ad_rgb")
from lamps import LUMINANCE, LampTable   # noqa: E402

F, U, B, V3, V2 = mi.Float, mi.UInt32, mi.Bool, mi.Vector3f, mi.Vector2f
OFFSET = 1e-5        # of the half extent: ray starts leave their surface by this
MANY_BOUNCES = 256   # from here on chance ends a path whatever it carries: between white surfaces nothing else would
BATCHES = 16         # independent runs, for the standard error
LANES = 1 << 20      # paths in flight


def floats(array):
    return F(np.ascontiguousarray(array, np.float32).ravel())


def vectors(array):
    return V3(np.ascontiguousarray(np.asarray(array, np.float32).T))


def rows(vector):
    return np.array(vector, np.float64).T


class TextureStore:
    """All pixels in one array, sRGB bytes packed in 32 bits; looked up by texture number with its own wrap and filter."""

    def __init__(self, scene, wanted):
        packed, self.index, table = [], {}, []
        start = 0
        for texture in wanted:
            found = scene.texture_pixels(texture)
            pixels, wrap, nearest = found if found else (np.full((1, 1, 4), 255, np.uint8), (10497, 10497), False)
            self.index[texture] = len(table)
            modes = [{10497: 0, 33071: 1, 33648: 2}[w] for w in wrap]
            table.append([start, pixels.shape[1], pixels.shape[0], *modes, int(nearest)])
            wide = pixels.reshape(-1, 4).astype(np.uint32)
            packed.append(wide[:, 0] | wide[:, 1] << 8 | wide[:, 2] << 16 | wide[:, 3] << 24)
            start += len(wide)
        self.count = len(table)
        if self.count:
            self.pixels = U(np.concatenate(packed))
            self.columns = [U(np.array(c, np.uint32)) for c in zip(*table)]
            s = np.arange(256) / 255
            self.linear = floats(np.where(s <= 0.04045, s / 12.92, ((s + 0.055) / 1.055) ** 2.4))

    def _wrapped(self, i, size, mode):
        i, size = mi.Int32(i), dr.maximum(mi.Int32(size), 1)    # lanes that are off have size 0
        repeat = ((i % size) + size) % size
        double = ((i % (2 * size)) + 2 * size) % (2 * size)
        mirror = dr.select(double < size, double, 2 * size - 1 - double)
        return U(dr.select(mode == 0, repeat, dr.select(mode == 1, dr.clip(i, 0, size - 1), mirror)))

    def value(self, texture, uv, active):
        """Linear colour, alpha, and red as a plain number; uv (0, 0) is the upper left corner."""
        start, width, height, wrap_s, wrap_t, nearest = [dr.gather(U, c, texture, active) for c in self.columns]
        shift = dr.select(nearest == 1, 0.0, 0.5)
        x, y = uv.x * F(width) - shift, uv.y * F(height) - shift
        x0, y0 = dr.floor(x), dr.floor(y)
        fx, fy = dr.select(nearest == 1, 0.0, x - x0), dr.select(nearest == 1, 0.0, y - y0)
        total, alpha, red = V3(0), F(0), F(0)
        for dx, dy, w in ((0, 0, (1 - fx) * (1 - fy)), (1, 0, fx * (1 - fy)), (0, 1, (1 - fx) * fy), (1, 1, fx * fy)):
            column = self._wrapped(mi.Int32(x0) + dx, width, wrap_s)
            line = self._wrapped(mi.Int32(y0) + dy, height, wrap_t)
            pixel = dr.gather(U, self.pixels, start + line * width + column, active)
            total += w * V3(*[dr.gather(F, self.linear, (pixel >> s) & 255, active) for s in (0, 8, 16)])
            alpha += w * F(pixel >> 24) / 255
            red += w * F(pixel & 255) / 255
        return total, alpha, red


class Tracer:
    """The scene in Mitsuba, and what the estimator looks up for a triangle. blend_colours: light through alpha BLEND takes the
    base colour."""

    def __init__(self, scene, sky=None, blend_colours=False):
        """sky: a Mitsuba environment emitter as a dictionary (sky.py), or None."""
        self.blend_colours = blend_colours
        points = scene.corners.reshape(-1, 3)
        self.centre = (points.min(0) + points.max(0)) / 2
        self.half = float((points.max(0) - points.min(0)).max()) / 2
        corners = (scene.corners - self.centre) / self.half
        mesh = mi.Mesh("scene", vertex_count=len(points), face_count=len(corners))
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = floats(corners)
        parameters["faces"] = U(np.arange(len(points), dtype=np.uint32))
        parameters.update()
        self.scene = mi.load_dict({"type": "scene", "mesh": mesh, **({"sky": sky} if sky else {})})
        self.sky = self.scene.environment()
        self.aims_at_sky = sky is not None and sky["type"] == "envmap"
        self.corner = floats(corners)
        self.flat = floats(scene.flat)
        self.material = U(scene.material.astype(np.uint32))
        self._load_materials(scene)
        self._load_lamps(scene, corners)

    def _load_materials(self, scene):
        materials = scene.materials
        keys = ("albedo_texture", "emission_texture", "transmission_texture")
        uses = [(m, k) for m in materials for k in keys if m[k]]
        self.textures = TextureStore(scene, sorted({m[k]["texture"] for m, k in uses}))
        self.albedo = floats([m["albedo"] for m in materials])
        self.nits = floats([m["emission"] for m in materials])
        self.two_sided = U(np.array([m["double_sided"] for m in materials], np.uint32))
        self.emits = any(m["emission"].max() > 0 for m in materials)
        self.pane = floats([m["pane"] for m in materials])
        column = lambda key: floats([m[key] for m in materials])
        self.alpha, self.cutoff, self.transmission = column("alpha"), column("cutoff"), column("transmission")
        self.alpha_mode = U(np.array([m["alpha_mode"] for m in materials], np.uint32))
        shown = set(scene.material.tolist())
        clear = [m["alpha_mode"] > 0 or m["transmission"] > 0 for m in materials]
        self.clear = U(np.array(clear, np.uint32))
        self.see_through = any(c for k, c in enumerate(clear) if k in shown)
        self.vertex_colour = None if scene.colours is None else floats(scene.colours[..., :3])
        self.vertex_alpha = None if scene.colours is None else floats(scene.colours[..., 3])
        self.uses = {}
        for key in keys:
            if not any(m[key] for m in materials):
                continue
            number = np.array([self.textures.index[m[key]["texture"]] if m[key] else -1 for m in materials], np.int32)
            uv = np.zeros((len(scene.material), 3, 2))
            for k, m in enumerate(materials):
                if m[key]:
                    own = scene.material == k
                    source = scene.uv.get(m[key]["uv_set"], scene.uv[0])[own]
                    uv[own] = source @ m[key]["matrix"][:, :2].T + m[key]["matrix"][:, 2]
            uv -= np.floor(uv.min(1, keepdims=True) / 2) * 2    # whole (mirrored) periods are nothing, precision is something
            self.uses[key] = (mi.Int32(number), floats(uv))

    def _texture(self, key, triangle, weights, material, active):
        """Colour, alpha and red as a number; all 1 where the material has no such texture."""
        if key not in self.uses:
            return V3(1), F(1), F(1)
        number, corner_uv = self.uses[key]
        texture = dr.gather(mi.Int32, number, material, active)
        use = active & (texture >= 0)
        uv = V2(0)
        for k in range(3):
            uv += weights[k] * dr.gather(V2, corner_uv, triangle * 3 + k, use)
        colour, alpha, red = self.textures.value(U(dr.maximum(texture, 0)), uv, use)
        return dr.select(use, colour, V3(1)), dr.select(use, alpha, 1), dr.select(use, red, 1)

    def _base(self, triangle, weights, material, active):
        """What multiplies base colour and alpha: texture times colours of the vertices."""
        colour, alpha, _ = self._texture("albedo_texture", triangle, weights, material, active)
        if self.vertex_colour is None:
            return colour, alpha
        corners = [dr.gather(V3, self.vertex_colour, triangle * 3 + k, active) * weights[k] for k in range(3)]
        alphas = [dr.gather(F, self.vertex_alpha, triangle * 3 + k, active) * weights[k] for k in range(3)]
        return colour * (corners[0] + corners[1] + corners[2]), alpha * (alphas[0] + alphas[1] + alphas[2])

    def _textured(self, key, base, triangle, weights, material, active):
        return dr.gather(V3, base, material, active) * self._texture(key, triangle, weights, material, active)[0]

    def passage_at(self, triangle, weights, active=True):
        """Opacity (the chance to meet the surface), and the colour that light keeps which does not."""
        active = B(active)
        material = dr.gather(U, self.material, triangle, active)
        mode = dr.gather(U, self.alpha_mode, material, active)
        colour, alpha = self._base(triangle, weights, material, active)
        base = dr.gather(V3, self.pane, material, active) * colour
        cover = dr.gather(F, self.alpha, material, active) * alpha
        cut = dr.select(cover >= dr.gather(F, self.cutoff, material, active), F(1), F(0))
        cover = dr.select(mode == 0, 1, dr.select(mode == 1, cut, cover))
        pane = cover * dr.gather(F, self.transmission, material, active)
        pane *= self._texture("transmission_texture", triangle, weights, material, active)[2]
        opacity = cover - pane
        beside = dr.select(B(self.blend_colours) & (mode == 2), base, V3(1))
        return opacity, ((1 - cover) * beside + pane * base) / dr.maximum(1 - opacity, 1e-20)

    def albedo_at(self, triangle, weights, active=True):
        material = dr.gather(U, self.material, triangle, active)
        return dr.gather(V3, self.albedo, material, active) * self._base(triangle, weights, material, B(active))[0]

    def nits_at(self, triangle, weights, active=True):
        return self._textured("emission_texture", self.nits, triangle, weights,
                              dr.gather(U, self.material, triangle, active), B(active))

    def _load_lamps(self, scene, corners):
        bright = np.array([m["emission"].max() > 0 for m in scene.materials])
        triangles = np.nonzero(bright[scene.material])[0] if len(scene.material) else np.zeros(0, int)
        sides = np.ones(len(triangles))
        both = np.array([m["double_sided"] for m in scene.materials])[scene.material[triangles]]
        # mean over 16 fixed points of each triangle: only steers, so it need not be exact
        mean = np.zeros(len(triangles))
        if len(triangles):
            for k in range(16):
                u, v = np.sqrt((k + 0.5) / 16), (k * 0.6180339887498949) % 1
                weights = [F(1 - u), F(u * (1 - v)), F(u * v)]
                mean += rows(self.nits_at(U(triangles.astype(np.uint32)), weights)) @ LUMINANCE / 16
        triangles, sides, mean = (np.concatenate([triangles, triangles[both]]), np.concatenate([sides, -sides[both]]),
                                  np.concatenate([mean, mean[both]]))
        punctual = [dict(l, position=(l["position"] - self.centre) / self.half,
                         colour=l["colour"] * (1 if l["kind"] == "directional" else self.half ** -2.0)) for l in scene.lamps]
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
        table = self.table = LampTable(corners, scene.flat, areas, triangles, sides, mean, punctual)
        self.area_lamps, self.area = len(triangles), floats(areas)
        if not table.count:
            return
        self.cdf, self.low, self.step = floats(table.cdf), table.low, table.step
        self.lamp_triangle = U(np.concatenate([triangles, np.zeros(len(punctual))]).astype(np.uint32))
        self.lamp_side = floats(np.concatenate([sides, np.zeros(len(punctual))]))
        lamp_of = np.full(2 * len(corners), -1, np.int32)     # by triangle and side
        lamp_of[2 * triangles + (sides < 0)] = np.arange(len(triangles))
        self.lamp_of = mi.Int32(lamp_of)
        if punctual:
            column = lambda key, default=0.0: np.array([l.get(key, default) for l in punctual])
            self.p_position, self.p_direction, self.p_colour = map(floats, (column("position"), column("direction"), column("colour")))
            self.p_kind = U(np.array([{"point": 0, "spot": 1, "directional": 2}[l["kind"]] for l in punctual], np.uint32))
            self.p_inner, self.p_outer = floats(column("cos_inner")), floats(column("cos_outer"))
            self.p_range = floats(column("range") / self.half)
            self.p_radius, self.p_sine = floats(column("radius") / self.half), floats(column("sine"))
            self.sizes = bool(max(column("radius").max(), column("sine").max()) > 0)

    # --- lamps -----------------------------------------------------------------------------------------------------

    def cell(self, p):
        index = U(0)
        for k in range(3):
            n = int(self.table.shape[k])
            index = index * n + U(dr.clip((p[k] - float(self.low[k])) / float(self.step[k]), 0, n - 0.5))
        return index * self.table.count

    def probability(self, cell, lamp, active):
        upper = dr.gather(F, self.cdf, cell + lamp, active)
        return upper - dr.select(lamp > 0, dr.gather(F, self.cdf, cell + lamp - 1, active & (lamp > 0)), 0)

    def lamp_light(self, p, normal, u, u1, u2, active):
        """One shadow ray: the irradiance at p that it stands for, weighted against cosine rays."""
        cell = self.cell(p)
        lamp = dr.binary_search(0, self.table.count - 1, lambda i: dr.gather(F, self.cdf, cell + i, active) < u)
        chance = self.probability(cell, lamp, active)
        is_area = active & (lamp < self.area_lamps)
        result, target, direction, distance = V3(0), V3(p), V3(0, 0, 1), F(0)
        if self.area_lamps:
            triangle = dr.gather(U, self.lamp_triangle, lamp, is_area)
            root = dr.sqrt(u1)
            weights = [1 - root, root * (1 - u2), root * u2]
            for k in range(3):
                corner = dr.gather(V3, self.corner, triangle * 3 + k, is_area)
                target = dr.select(is_area, (target if k else V3(0)) + weights[k] * corner, target)
            way = target - p
            distance = dr.norm(way)
            direction = way / distance
            facing = -dr.dot(dr.gather(V3, self.flat, triangle, is_area), direction) * dr.gather(F, self.lamp_side, lamp, is_area)
            cosine = dr.dot(direction, normal)
            lit = is_area & (facing > 0) & (cosine > 0) & (distance > 0)
            density = chance / dr.gather(F, self.area, triangle, lit) * dr.square(distance) / dr.maximum(facing, 1e-20)
            value = self.nits_at(triangle, weights, lit) * cosine / (density + cosine * dr.inv_pi)
            result = dr.select(lit, value, 0)
        if self.table.count > self.area_lamps:
            is_point = active & (lamp >= self.area_lamps)
            value, toward, far = self.punctual_light(p, normal, lamp - self.area_lamps, u1, u2, is_point)
            result = dr.select(is_point, value / chance, result)
            direction, distance = dr.select(is_point, toward, direction), dr.select(is_point, far, distance)
        wanted = active & (dr.max(result) > 0)
        if self.see_through:
            return dr.select(wanted, result * self.transmittance(p, direction, distance, wanted), 0)
        shadow = mi.Ray3f(p, direction, distance - OFFSET, F(0), mi.Color0f())
        return dr.select(wanted & ~self.scene.ray_test(shadow, wanted), result, 0)

    @dr.syntax
    def transmittance(self, p, direction, distance, active):
        """What all that stands between lets through, per channel."""
        left, origin, rest, on = V3(1), V3(p), distance - OFFSET, B(active)
        while on:
            hit = self.scene.ray_intersect_preliminary(mi.Ray3f(origin, direction, rest, F(0), mi.Color0f()), coherent=False, active=on)
            on &= hit.is_valid()
            weights = [1 - hit.prim_uv.x - hit.prim_uv.y, hit.prim_uv.x, hit.prim_uv.y]
            opacity, tint = self.passage_at(hit.prim_index, weights, on)
            left = dr.select(on, left * tint * (1 - opacity), left)
            origin += direction * (hit.t + OFFSET)
            rest -= hit.t + OFFSET
            on &= (dr.max(left) > 0) & (rest > 0)
        return left

    def punctual_light(self, p, normal, lamp, u1, u2, active):
        """Irradiance without shadow, direction and distance. Of a sized lamp: by one direction, uniform over its cone."""
        kind = dr.gather(U, self.p_kind, lamp, active)
        axis = dr.gather(V3, self.p_direction, lamp, active)
        way = dr.gather(V3, self.p_position, lamp, active) - p
        distance = dr.norm(way)
        toward = dr.select(kind == 2, -axis, way / distance)
        inner, outer = dr.gather(F, self.p_inner, lamp, active), dr.gather(F, self.p_outer, lamp, active)
        cone = dr.square(dr.clip((-dr.dot(axis, toward) - outer) / dr.maximum(inner - outer, 1e-3), 0, 1))
        reach = dr.gather(F, self.p_range, lamp, active)
        window = dr.select(reach > 0, dr.clip(1 - (distance / dr.maximum(reach, 1e-20)) ** 4, 0, 1), 1)
        fall = dr.select(kind == 2, 1, window * dr.select(kind == 1, cone, 1) / dr.square(distance))
        full = dr.gather(V3, self.p_colour, lamp, active) * fall
        colour, far = full * dr.maximum(dr.dot(toward, normal), 0), dr.select(kind == 2, 10.0, distance)
        if not self.sizes:
            return colour, toward, far
        radius = dr.gather(F, self.p_radius, lamp, active)
        sine = dr.select(kind == 2, dr.gather(F, self.p_sine, lamp, active), radius / distance)
        inside = sine >= 1
        s = dr.minimum(sine, 0.999999)
        height = 1 - dr.square(s) / (1 + dr.sqrt(1 - dr.square(s)))             # cosine of the cone's half angle
        cone = mi.Frame3f(toward).to_world(mi.warp.square_to_uniform_cone(mi.Point2f(u1, u2), height))
        ball = mi.Frame3f(normal).to_world(mi.warp.square_to_cosine_hemisphere(mi.Point2f(u1, u2)))
        direction = dr.select(inside, ball, cone)
        # luminance = full / (pi s^2), solid angle = 2 pi (1 - height), which is 2 pi s^2 / (1 + sqrt(1 - s^2))
        facing = dr.maximum(dr.dot(direction, normal), 0) * 2 / (1 + dr.sqrt(1 - dr.square(s)))
        even = dr.select(inside, full * dr.square(distance) / dr.maximum(dr.square(radius), 1e-30), full * facing)
        along = dr.dot(way, direction)
        chord = dr.safe_sqrt(dr.square(radius) - dr.squared_norm(way - direction * along))
        end = dr.select(kind == 2, 10.0, dr.select(inside, along + chord, along - chord))
        sized = sine > 0
        return dr.select(sized, even, colour), dr.select(sized, direction, toward), dr.select(sized, end, far)

    # --- sky -------------------------------------------------------------------------------------------------------

    def sky_nits(self, direction, active):
        surface = dr.zeros(mi.SurfaceInteraction3f, dr.width(direction))
        surface.wi = -direction
        return V3(self.sky.eval(surface, active))

    def sky_density(self, p, direction, active):
        sample = dr.zeros(mi.DirectionSample3f, dr.width(direction))
        sample.d = direction
        surface = dr.zeros(mi.SurfaceInteraction3f, dr.width(direction))
        surface.p = p
        return self.sky.pdf_direction(surface, sample, active)

    def sky_light(self, p, normal, u1, u2, active):
        """One shadow ray to the sky, weighted against cosine rays: irradiance at p."""
        surface = dr.zeros(mi.SurfaceInteraction3f, dr.width(p))
        surface.p = p
        sample, _ = self.sky.sample_direction(surface, mi.Point2f(u1, u2), active)
        cosine = dr.dot(sample.d, normal)
        wanted = active & (cosine > 0) & (sample.pdf > 0)
        value = self.sky_nits(sample.d, wanted) * cosine / (sample.pdf + cosine * dr.inv_pi)
        if self.see_through:
            return dr.select(wanted, value * self.transmittance(p, sample.d, F(10), wanted), 0)
        return dr.select(wanted & ~self.scene.ray_test(mi.Ray3f(p, sample.d), wanted), value, 0)

    # --- paths -----------------------------------------------------------------------------------------------------

    @dr.syntax
    def trace(self, p, flat, normal, u1, u2, rng):
        """Irradiance samples. p already off its surface; u1, u2: the first direction."""
        total, throughput = V3(0), V3(1)
        active = B(True)
        # a ray that passed a pane goes on from there: `along` metres from p, and `fresh` no more
        along, fresh, direction, cosine = F(0), B(True), V3(0, 0, 1), F(1)
        bounces = U(0)
        while active:
            if dr.hint(self.table.count > 0, mode="scalar"):
                total += throughput * self.lamp_light(p, normal, rng.next_float32(), rng.next_float32(), rng.next_float32(), active & fresh)
            if dr.hint(self.aims_at_sky, mode="scalar"):
                total += throughput * self.sky_light(p, normal, rng.next_float32(), rng.next_float32(), active & fresh)
            local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(u1, u2))
            direction = dr.select(fresh, mi.Frame3f(normal).to_world(local), direction)
            cosine = dr.select(fresh, local.z, cosine)
            active &= ~fresh | (dr.dot(direction, flat) > 0)
            hit = self.scene.ray_intersect_preliminary(mi.Ray3f(p + direction * along, direction), coherent=False, active=active)
            if dr.hint(self.sky is not None, mode="scalar"):
                left = active & ~hit.is_valid()
                share = cosine * dr.inv_pi
                if dr.hint(self.aims_at_sky, mode="scalar"):
                    share /= dr.maximum(share + self.sky_density(p, direction, left), 1e-30)
                else:
                    share = F(1)
                total += dr.select(left, throughput * dr.pi * share * self.sky_nits(direction, left), 0)
            active &= hit.is_valid()
            triangle = hit.prim_index
            weights = [1 - hit.prim_uv.x - hit.prim_uv.y, hit.prim_uv.x, hit.prim_uv.y]
            far = along + hit.t
            passes = B(False)
            if dr.hint(self.see_through, mode="scalar"):
                opacity, tint = self.passage_at(triangle, weights, active)
                passes = active & (rng.next_float32() >= opacity)
                throughput = dr.select(passes, throughput * tint, throughput)
                active &= ~passes | (dr.max(throughput) > 0)
            meets = active & ~passes
            ng = dr.gather(V3, self.flat, triangle, active)
            front = dr.dot(ng, direction) < 0
            both = dr.gather(U, self.two_sided, dr.gather(U, self.material, triangle, active), active) == 1
            active &= passes | front | both
            meets &= active
            if dr.hint(self.emits, mode="scalar"):
                lamp = dr.gather(mi.Int32, self.lamp_of, triangle * 2 + dr.select(front, U(0), U(1)), active)
                shines = meets & (lamp >= 0)
                facing = dr.abs(dr.dot(ng, direction))
                density = (self.probability(self.cell(p), U(dr.maximum(lamp, 0)), shines) / dr.gather(F, self.area, triangle, shines)
                           * dr.square(far) / dr.maximum(facing, 1e-20))
                share = cosine * dr.inv_pi
                weight = share / dr.maximum(share + density, 1e-30)
                total += dr.select(shines, throughput * dr.pi * weight * self.nits_at(triangle, weights, shines), 0)
            throughput = dr.select(meets, throughput * self.albedo_at(triangle, weights, meets), throughput)
            flat = dr.select(meets, dr.select(front, ng, -ng), flat)
            normal = dr.select(meets, flat, normal)
            corner = V3(0)
            for k in range(3):
                corner += weights[k] * dr.gather(V3, self.corner, triangle * 3 + k, active)
            p = dr.select(meets, corner + flat * OFFSET, p)
            along = dr.select(meets, 0, far + OFFSET)
            fresh = B(meets)
            bounces += dr.select(meets, U(1), U(0))
            most = dr.select(bounces < MANY_BOUNCES, F(1), F(0.99))
            keep = dr.select(meets, dr.minimum(dr.max(throughput) * 4, most), 1)
            active &= rng.next_float32() < keep
            throughput /= dr.maximum(keep, 1e-20)
            u1, u2 = rng.next_float32(), rng.next_float32()
        return total

    def irradiance(self, points, flat, normals, samples, seed=0):
        """points, flat, normals (N, K, 3): world positions whose mean is wanted, geometric and shading normals.
        Returns mean (N, 3) in lux and its standard error (N, 3)."""
        count, places = points.shape[:2]
        start = (points - self.centre) / self.half + flat * OFFSET
        each = max(1, samples // BATCHES)
        step = max(1, LANES // each)
        results = np.zeros((BATCHES, count, 3))
        for batch in range(BATCHES):
            for first in range(0, count, step):
                n = min(step, count - first)
                noise = np.random.default_rng([seed, batch, first])
                owner = np.repeat(np.arange(first, first + n), each)
                k = np.tile(np.arange(each), n)
                place = (k + noise.integers(places, size=n).repeat(each)) % places
                shift = noise.random((2, n)).repeat(each, 1)
                # the plastic-number lattice, shifted per point
                u = (np.array([[0.7548776662466927], [0.5698402909980532]]) * k + shift) % 1
                rng = mi.PCG32(size=n * each, initstate=mi.UInt64(int(noise.integers(1 << 62))))
                value = self.trace(vectors(start[owner, place]), vectors(flat[owner, place]), vectors(normals[owner, place]),
                                   floats(np.minimum(u[0], 1 - 1e-7)), floats(np.minimum(u[1], 1 - 1e-7)), rng)
                results[batch, first:first + n] = rows(value).reshape(n, each, 3).mean(1)
        return results.mean(0), results.std(0, ddof=1) / np.sqrt(BATCHES)

    def buried(self, points, flat, seed=0, rays=64):
        """Share of cosine rays from each point (N, 3) that meet the back of a surface which has none to show."""
        share = np.zeros(len(points))
        step = max(1, LANES // rays)
        for first in range(0, len(points), step):
            share[first:first + step] = self._backs(points[first:first + step], flat[first:first + step], [seed, 77, first], rays)
        return share

    def _backs(self, points, flat, seed, rays):
        noise = np.random.default_rng(seed)
        start = np.repeat((points - self.centre) / self.half + flat * OFFSET, rays, 0)
        normal = vectors(np.repeat(flat, rays, 0))
        u = noise.random((2, len(start)))
        direction = mi.Frame3f(normal).to_world(mi.warp.square_to_cosine_hemisphere(mi.Point2f(floats(u[0]), floats(u[1]))))
        hit = self.scene.ray_intersect_preliminary(mi.Ray3f(vectors(start), direction), coherent=False)
        ng = dr.gather(V3, self.flat, hit.prim_index, hit.is_valid())
        material = dr.gather(U, self.material, hit.prim_index, hit.is_valid())
        # what can be seen through encloses nothing
        both = (dr.gather(U, self.two_sided, material, hit.is_valid()) | dr.gather(U, self.clear, material, hit.is_valid())) == 1
        back = hit.is_valid() & (dr.dot(ng, direction) > 0) & ~both
        return np.array(dr.select(back, F(1), F(0))).reshape(len(points), rays).mean(1)
