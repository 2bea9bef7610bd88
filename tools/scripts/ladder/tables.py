"""The figures as Markdown."""
from ladder import rules


def percent(share):
    return f"{share * 100:.0f} %" if share >= 0.995 else f"{share * 100:.2g} %"


def seconds(number):
    return f"{number:.0f}" if number >= 10 else f"{number:.2g}"


def name_of(setting):
    """(("gather-rays", "32"), ("quality", "draft"), ("rays", "64")) as "draft, rays 64, gather-rays 32"."""
    options = dict(setting)
    first = options.pop("quality", "")
    order = sorted(options, key=lambda o: (["rays", "gather-rays", "tolerance"].index(o) if o in ("rays", "gather-rays", "tolerance") else 9, o))
    return ", ".join([first] * bool(first) + [f"{option} {options[option]}" for option in order])


def table(head, rows):
    return "\n".join(["| " + " | ".join(head) + " |", "| " + " | ".join(["---"] * len(head)) + " |"] + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def ratio_text(figures, before, setting, scene):
    if figures.at_floor(setting, scene):
        return "at floor"
    return f"{figures.error(before, scene) / figures.error(setting, scene):.1f}"


def by_scene(figures, sweeps):
    """Of each scene: texels, noise, and of each preset seconds, RMSE, p95, and how many times less error than the preset before."""
    rows = []
    for sweep in sweeps:
        row = [sweep.scene, f"{sweep.texels:,}", percent(sweep.noise)]
        for k, rung in enumerate(rules.RUNGS):
            m = sweep.points[rules.preset(rung)]
            row.append(f"{seconds(m.seconds)} of {seconds(m.whole)}")
            row.append(f"{percent(m.error)}, {percent(m.p95)}")
            if k:
                row.append("exact" if sweep.scene in figures.exact else ratio_text(figures, rules.preset(rules.RUNGS[k - 1]), rules.preset(rung), sweep.scene))
        rows.append(row)
    head = ["scene", "texels", "noise"]
    for k, rung in enumerate(rules.RUNGS):
        head += [f"{rung}: s", "RMSE, p95"] + ["less"] * bool(k)
    return table(head, rows)


def step_text(step):
    return "-" if not step.scene else f"{step.least:.2f} ({step.scene}" + (f"; {step.missed} below {rules.FACTOR:g})" if step.missed else ")")


def keeps(figures, ladder, k, aims):
    """Whether rung `k` keeps all rules."""
    name, setting = ladder[k]
    steps = k == 0 or figures.step(ladder[k - 1][1], setting).missed == 0
    return steps and figures.excess(setting).share <= rules.EXCESS and figures.typical_error(setting) <= aims[name]


def rungs(figures, ladder, aims):
    """A ladder: what each of its rungs is, and how it keeps the rules. `ladder`: [(name, setting)]"""
    rows = []
    for k, (name, setting) in enumerate(ladder):
        excess = figures.excess(setting)
        step = figures.step(ladder[k - 1][1], setting) if k else rules.Step()
        rows.append([name, name_of(setting), f"{figures.seconds(setting):.3g}", percent(figures.typical_error(setting)), percent(aims[name]), step_text(step),
                     f"{excess.share * 100:.0f} % ({name_of(excess.by)})" if excess.by else "none", "yes" if keeps(figures, ladder, k, aims) else "no"])
    return table(["rung", "setting", "seconds", "error", "aim", "least step", "excess", "kept"], rows)


def verdict(figures, ladder):
    others = [name for name, setting in ladder if not figures.is_same(setting, rules.preset(name))]
    return f"The presets are others: {', '.join(others)}.\n" if others else "The presets are these.\n"


def grid(figures):
    """All settings by seconds."""
    rows = []
    for setting in sorted(figures.settings, key=figures.seconds):
        excess = figures.excess(setting)
        worst = max(figures.scenes, key=lambda scene: figures.error(setting, scene))
        rows.append([name_of(setting), f"{figures.seconds(setting):.3g}", percent(figures.typical_error(setting)),
                     f"{percent(figures.error(setting, worst))} ({worst})", f"{excess.share * 100:.0f} % ({name_of(excess.by)})" if excess.by else "none"])
    return table(["setting", "seconds", "error", "worst scene", "excess"], rows)
