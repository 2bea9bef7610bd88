"""Irradiance by Mitsuba's own path integrator, emitters and diffuse material, in the variant scalar_rgb: no LLVM is needed.

For machines where pathtrace.py cannot run, and as a second opinion on it: the two share the rays' geometry and nothing else. One ray
at a time from Python, so for few texels; plain scenes only (no textures, no colours of vertices, nothing to see through, no spots, ranges or sizes
of lamps, no emission on both sides), others are refused with a ValueError. At the texel: one shadow ray to Mitsuba's emitter sample, and one
cosine ray whose first hit's own light is taken away, as the shadow ray has it.
"""
import numpy as np
import mitsuba as mi

mi.set_variant("scalar_rgb")

OFFSET = 1e-5    # of the half extent: ray starts leave their surface by this
BATCHES = 16     # independent runs, for the standard error
RAYS = 16        # to find out whether a point is inside a solid


def rgb(values):
    return {"type": "rgb", "value": [float(v) for v in values]}


def refuse_what_is_not_plain(scene, materials):
    if scene.colours is not None:
        raise ValueError("scalar_rgb is for scenes without colours of vertices only")
    for m in materials:
        if m["albedo_texture"] or m["emission_texture"] or m["alpha_mode"] or m["transmission"] > 0:
            raise ValueError(f"material {m['name']}: scalar_rgb is for plain materials only")
        if m["double_sided"] and m["emission"].max() > 0:
            raise ValueError(f"material {m['name']}: scalar_rgb has no emission on both sides")
    for lamp in scene.lamps:
        if lamp["kind"] == "spot" or lamp.get("range") or lamp.get("radius") or lamp.get("sine"):
            raise ValueError("scalar_rgb has no spots, ranges or sizes of lamps")


class Tracer:
    """As pathtrace.Tracer."""

    def __init__(self, scene, sky=None, _=False):
        points = scene.corners.reshape(-1, 3)
        self.centre = (points.min(0) + points.max(0)) / 2
        self.half = float((points.max(0) - points.min(0)).max()) / 2
        shown = np.unique(scene.material)
        refuse_what_is_not_plain(scene, [scene.materials[k] for k in shown])
        corners = (scene.corners - self.centre) / self.half
        parts = {f"material_{k}": self._mesh(corners[scene.material == k], scene.materials[k]) for k in shown}
        self.closed = {f"material_{k}": not scene.materials[k]["double_sided"] for k in shown}
        for k, lamp in enumerate(scene.lamps):
            parts[f"lamp_{k}"] = self._lamp(lamp)
        if sky:
            parts["sky"] = sky
        self.scene = mi.load_dict({"type": "scene", **parts})
        self.path = mi.load_dict({"type": "path", "max_depth": -1})
        self.sampler = mi.load_dict({"type": "independent"})

    def _mesh(self, corners, material):
        properties = mi.Properties()
        diffuse = {"type": "diffuse", "reflectance": rgb(material["albedo"])}
        properties["mesh_bsdf"] = mi.load_dict({"type": "twosided", "material": diffuse} if material["double_sided"] else diffuse)
        if material["emission"].max() > 0:
            properties["mesh_emitter"] = mi.load_dict({"type": "area", "radiance": rgb(material["emission"])})
        mesh = mi.Mesh("mesh", 3 * len(corners), len(corners), props=properties)
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = corners.astype(np.float32).ravel()
        parameters["faces"] = np.arange(3 * len(corners), dtype=np.uint32)
        parameters.update()
        return mesh

    def _lamp(self, lamp):
        if lamp["kind"] == "directional":
            return {"type": "directional", "direction": [float(v) for v in lamp["direction"]], "irradiance": rgb(lamp["colour"])}
        return {"type": "point", "position": [float(v) for v in (lamp["position"] - self.centre) / self.half],
                "intensity": rgb(lamp["colour"] / self.half ** 2)}

    def _sample(self, surface, frame):
        """One sample of the irradiance."""
        aim, light = self.scene.sample_emitter_direction(surface, self.sampler.next_2d())
        total = np.array(light) * max(float(np.dot(np.array(aim.d), np.array(frame.n))), 0.0)
        ray = mi.RayDifferential3f(surface.p, frame.to_world(mi.warp.square_to_cosine_hemisphere(self.sampler.next_2d())))
        hit = self.scene.ray_intersect(ray)
        emitter = hit.emitter(self.scene)
        nits = np.array(self.path.sample(self.scene, self.sampler, ray)[0])
        return total + np.pi * (nits - (np.array(emitter.eval(hit)) if emitter else 0))

    def irradiance(self, points, flat, normals, samples, seed=0):
        """As pathtrace.Tracer.irradiance; at the geometric normals."""
        count, places = points.shape[:2]
        each = max(1, samples // BATCHES)
        start = (points - self.centre) / self.half + flat * OFFSET
        results = np.zeros((BATCHES, count, 3))
        self.sampler.seed(seed)
        noise = np.random.default_rng([seed, 3])
        for texel in range(count):
            for batch in range(BATCHES):
                for k in noise.integers(places, size=each):
                    surface = mi.SurfaceInteraction3f()
                    surface.p, surface.n = start[texel, k], flat[texel, k]
                    results[batch, texel] += self._sample(surface, mi.Frame3f(mi.Vector3f(normals[texel, k]))) / each
        return results.mean(0), results.std(0, ddof=1) / np.sqrt(BATCHES)

    def buried(self, points, flat, seed=0):
        """As pathtrace.Tracer.buried."""
        self.sampler.seed(seed + 77)
        share = np.zeros(len(points))
        for n, (point, normal) in enumerate(zip((points - self.centre) / self.half + flat * OFFSET, flat)):
            frame = mi.Frame3f(mi.Vector3f(normal))
            for _ in range(RAYS):
                ray = mi.Ray3f(point, frame.to_world(mi.warp.square_to_cosine_hemisphere(self.sampler.next_2d())))
                hit = self.scene.ray_intersect_preliminary(ray)
                if hit.is_valid():
                    full = self.scene.ray_intersect(ray)
                    share[n] += self.closed[full.shape.id()] and np.dot(np.array(full.n), np.array(ray.d)) > 0
        return share / RAYS
