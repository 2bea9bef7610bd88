"""Which lamp a shadow ray goes to: emissive triangles and punctual lamps, with probabilities that depend on the place.

The scene's box is cut into cells; each cell has a table of probabilities (power over squared distance; triangles that
turn their back to the whole cell get none). The tables only steer the noise: any lamp that a table misses is still met by
the cosine rays, punctual ones always keep a part.
"""
import numpy as np

TABLE_ENTRIES = 1 << 23   # cells times lamps at most; 32 MB of floats
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


class LampTable:
    """triangles: scene triangle and side (+1 front, -1 back) of each emissive lamp; then come the punctual lamps.
    cdf: (cells, lamps) cumulative. All lengths are in the coordinates that are given."""

    def __init__(self, corners, flat, areas, triangles, sides, luminances, punctual):
        self.triangles, self.sides, self.punctual = triangles, sides, punctual
        self.count = len(triangles) + len(punctual)
        low, high = corners.reshape(-1, 3).min(0), corners.reshape(-1, 3).max(0)
        size = np.maximum(high - low, 1e-6 * (high - low).max() + 1e-30)
        cells = max(1, min(32768, TABLE_ENTRIES // max(self.count, 1)))
        step = (size.prod() / cells) ** (1 / 3)
        self.shape = np.clip(np.floor(size / step), 1, 64).astype(int)
        self.low, self.step = low, size / self.shape
        if self.count:
            self.cdf = self._tables(corners, flat, areas, luminances)

    def _tables(self, corners, flat, areas, luminances):
        grid = np.stack(np.meshgrid(*[np.arange(n) for n in self.shape], indexing="ij"), -1).reshape(-1, 3)
        centres = self.low + (grid + 0.5) * self.step
        reach2 = (self.step ** 2).sum() / 4
        weights = np.zeros((len(centres), self.count), np.float32)
        n = len(self.triangles)
        if n:
            middle = corners[self.triangles].mean(1)
            power = areas[self.triangles] * luminances
            normal = flat[self.triangles] * self.sides[:, None]
            radius2 = ((corners[self.triangles] - middle[:, None]) ** 2).sum(2).max(1)
            for cell, centre in enumerate(centres):
                offset = centre - middle
                height = (offset * normal).sum(1)
                lit = height > -np.sqrt(reach2)
                weights[cell, :n] = lit * power / ((offset ** 2).sum(1) + radius2 + reach2)
        for k, lamp in enumerate(self.punctual):
            strength = float(lamp["colour"] @ LUMINANCE)
            if lamp["kind"] == "directional":
                weights[:, n + k] = strength
            else:
                weights[:, n + k] = strength / (((centres - lamp["position"]) ** 2).sum(1) + reach2)
        total = weights.sum(1, keepdims=True, dtype=np.float64)
        average = weights.mean(0, keepdims=True, dtype=np.float64)
        average = average / average.sum() if average.sum() > 0 else np.full((1, self.count), 1 / self.count)
        share = np.where(total > 0, weights / np.maximum(total, 1e-300), average)
        # a tenth goes by the average of all cells, so no lamp of the scene is ever left out
        cdf = np.cumsum(0.9 * share + 0.1 * average, axis=1)
        cdf /= cdf[:, -1:]
        return cdf.astype(np.float32)
