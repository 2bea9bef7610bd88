"""What a ladder of presets must keep, and the cheapest settings that do.

Of each scene the error of a setting is its relative RMSE, but not less than the floor: what the reference can tell. Seconds are processor_seconds of
the stages that depend on settings (sweeps.py). A ratio over scenes is the geometric mean, where each scene counts the same.

step       error of the setting before / error. On every scene at least FACTOR, unless the error is at the floor.
better     S is better than P where its errors are at most those of P: their ratio over scenes at most 1, and on no scene above WORSE.
excess     of P: how much longer than the quickest better setting it takes, at most EXCESS. The criterion is lenient where S is worse on one scene
           by up to WORSE, which is what two seeds differ by, and where S has less error: then it need not have just as little.
aim        typical error (ratio over scenes against 1) that a rung must reach. Steps alone would let a reference be ten times worse than it can be.
"""
import dataclasses
import math

FACTOR = 2.0
WORSE = 1.1
EXCESS = 0.2
LEAST_FLOOR = 0.0005
RUNGS = ["draft", "medium", "high", "reference"]


def geometric_mean(values):
    values = list(values)
    return math.exp(sum(map(math.log, values)) / len(values)) if values else math.nan


def preset(name):
    return (("quality", name),)


@dataclasses.dataclass
class Excess:
    by: tuple = ()       # the quickest better setting; (): none
    share: float = 0.0   # 0.2: takes 20 % longer than that


@dataclasses.dataclass
class Step:
    least: float = math.inf  # over scenes that are not at the floor
    scene: str = ""
    missed: int = 0          # scenes with less than FACTOR


class Figures:
    """Seconds and errors of the settings that all scenes have."""

    def __init__(self, sweeps):
        self.floors = {sweep.scene: max(LEAST_FLOOR, sweep.noise) for sweep in sweeps}
        self.settings = [s for s in sweeps[0].points if all(s in sweep.points for sweep in sweeps)]
        self.measured = {sweep.scene: sweep.points for sweep in sweeps}
        # Where no setting is above the floor, light is exact: there is nothing to compare.
        self.exact = [name for name, points in self.measured.items() if all(points[s].error <= self.floors[name] for s in self.settings)]
        self.scenes = [name for name in self.measured if name not in self.exact]

    def error(self, setting, scene):
        return max(self.measured[scene][setting].error, self.floors[scene])

    def seen(self, setting, scene):
        return max(self.measured[scene][setting].seen, self.floors[scene])

    def at_floor(self, setting, scene):
        return self.measured[scene][setting].error <= self.floors[scene]

    def seconds(self, setting):
        return geometric_mean(self.measured[scene][setting].seconds for scene in self.scenes)

    def typical_error(self, setting):
        return geometric_mean(self.error(setting, scene) for scene in self.scenes)

    def step(self, before, setting):
        steps = {scene: self.error(before, scene) / self.error(setting, scene) for scene in self.scenes if not self.at_floor(setting, scene)}
        if not steps:
            return Step()
        scene = min(steps, key=steps.get)
        return Step(steps[scene], scene, sum(ratio < FACTOR for ratio in steps.values()))

    def is_same(self, setting, other):
        """Whether they give the same light: the same options under another name."""
        return all(self.measured[scene][setting].seen == self.measured[scene][other].seen for scene in self.scenes)

    def is_better(self, setting, than):
        """Compares bake with bake, so that the reference gains nothing by being measured three times."""
        ratios = [self.seen(setting, scene) / self.seen(than, scene) for scene in self.scenes]
        return geometric_mean(ratios) <= 1 and max(ratios) <= WORSE

    def excess(self, setting):
        found = Excess()
        for other in self.settings:
            share = self.seconds(setting) / self.seconds(other) - 1
            if share > found.share and self.is_better(other, setting):
                found = Excess(other, share)
        return found


@dataclasses.dataclass
class Rung:
    name: str
    setting: tuple
    step: Step
    keeps: bool  # False: no setting keeps the rules; of those that reach the aim, or of all, this one misses its step on the fewest scenes


def derive(figures, aims):
    """Rungs from the bottom: each the quickest setting within EXCESS that reaches its aim and steps FACTOR down on every scene."""
    sound = sorted((s for s in figures.settings if figures.excess(s).share <= EXCESS), key=figures.seconds)
    rungs = []
    for name in RUNGS:
        before = rungs[-1].setting if rungs else None
        steps = {s: figures.step(before, s) if before else Step() for s in sound}
        good = [s for s in sound if figures.typical_error(s) <= aims[name]]
        chosen = min(good or sound, key=lambda s: steps[s].missed)  # the quickest of them
        rungs.append(Rung(name, chosen, steps[chosen], bool(good) and steps[chosen].missed == 0))
    return rungs
