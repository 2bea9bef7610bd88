"""A pinhole camera, and a search for a place from which a scene shows something."""
import numpy as np


class Camera:
    """position, target in metres; fov: vertical, degrees. Y is up."""

    def __init__(self, position, target, fov=60.0):
        self.position, self.fov = np.array(position, float), fov
        self.forward = np.array(target, float) - self.position
        self.forward /= np.linalg.norm(self.forward)
        up = np.array([0, 1.0, 0]) if abs(self.forward[1]) < 0.999 else np.array([0, 0, 1.0])
        self.right = np.cross(self.forward, up)
        self.right /= np.linalg.norm(self.right)
        self.up = np.cross(self.right, self.forward)

    def directions(self, width, height, samples=1):
        """Unit directions (height * width * samples^2, 3), row by row from the top; samples x samples places in a pixel."""
        n = np.tan(np.radians(self.fov) / 2)
        places = (np.arange(samples) + 0.5) / samples
        y, x, v, u = np.meshgrid(np.arange(height), np.arange(width), places, places, indexing="ij")
        across = ((x + u) / width * 2 - 1) * n * width / height
        down = (1 - (y + v) / height * 2) * n
        d = self.forward + across.reshape(-1, 1) * self.right + down.reshape(-1, 1) * self.up
        return d / np.linalg.norm(d, axis=1, keepdims=True)

    def text(self):
        place = ",".join(f"{v:.4g}" for v in (*self.position, *(self.position + self.forward)))
        return f"--camera={place} --fov={self.fov:g}"


def from_file(scene):
    """The first perspective camera of the glTF, or None."""
    from gltf_scene import node_matrix
    document = scene.document.json
    scenes = document.get("scenes", [])
    pending = [(n, np.eye(4)) for n in (scenes[document.get("scene", 0)].get("nodes", []) if scenes else [])]
    while pending:
        index, parent = pending.pop()
        node = document["nodes"][index]
        world = parent @ node_matrix(node)
        pending += [(c, world) for c in node.get("children", [])]
        if "camera" in node and document["cameras"][node["camera"]]["type"] == "perspective":
            fov = np.degrees(document["cameras"][node["camera"]]["perspective"]["yfov"])
            return Camera(world[:3, 3], world[:3, 3] - world[:3, 2], float(fov))
    return None


def score(front, depth, things, light, size):
    """How much a view shows: fronts, not backs; some distance; many different things; light and shade. Arrays of one view,
    depth infinite where nothing is (which is a smaller fault than a back)."""
    if front.mean() < 0.3:
        return 0.0
    shown = front.sum() / (front.sum() + 0.3 * np.isinf(depth).sum() + (~front & np.isfinite(depth)).sum())
    count = np.unique(things[front], return_counts=True)[1] / front.sum()
    variety = -(count * np.log2(count)).sum()
    value = light[front] / max(light[front].max(), 1e-30)
    contrast = value.std() if light[front].max() > 0 else 0.0
    lit = (value > 0.02).mean()
    open_view = min(float(np.median(depth[front])) / (0.25 * size), 1.0) * (depth[front] > 0.03 * size).mean()
    return float(shown ** 4 * (1 + variety) * (0.2 + contrast) * lit * open_view)


def outside(low, high, noise, count):
    """Cameras that have the whole box in view: along each axis, then from anywhere but steeply above or below."""
    fov, centre = 38.0, (low + high) / 2
    ways = [sign * np.eye(3)[axis] for axis in (0, 2, 1) for sign in (1, -1)]
    ways += [way / np.linalg.norm(way) for way in noise.normal(size=(count, 3)) * (1, 0.4, 1)]
    for way in ways:
        across = float(np.abs((high - low) - np.abs(way) * (high - low)).max()) * 1.08
        distance = across / 2 / np.tan(np.radians(fov) / 2) + float(np.abs(way) @ (high - low)) / 2
        yield Camera(centre + way * distance, centre, fov)


def search(scene, look, seed=0, places=160, turns=6, fov=65.0):
    """The best of many views. look(position, directions) -> front, depth, things, light."""
    noise = np.random.default_rng([seed, 5])
    points = scene.corners.reshape(-1, 3)
    # far strays and outer hulls of game maps should not decide what "the scene" is
    low, high = np.quantile(points, 0.01, axis=0), np.quantile(points, 0.99, axis=0)
    size = float(np.linalg.norm(high - low))
    views = list(outside(low, high, noise, places // 8))
    for _ in range(places):   # before a random surface, looking around
        t = noise.choice(len(scene.areas), p=scene.areas / scene.areas.sum())
        position = scene.corners[t].mean(0) + scene.flat[t] * noise.uniform(0.02, 0.2) * size
        around = noise.uniform(0, 2 * np.pi) + np.arange(turns) * 2 * np.pi / turns
        views += [Camera(position, position + (np.cos(a), noise.uniform(-0.35, 0.1), np.sin(a)), fov) for a in around]
    scores = [score(*look(v.position, v.directions(24, 16)), size) for v in views]
    return views[int(np.argmax(scores))]
