"""Dry grains: on an incline, in an impact, as a heap and as a column that collapses."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from ...case import (
    Band,
    Case,
    Control,
    Criterion,
    Curve,
    Outcome,
    Value,
    between,
    dots,
    small,
    within,
)
from ...estimators import largest_cluster, surface_slope
from ...running import Running

G, ANGLE, RADIUS = 9.81, math.radians(30), 0.005
DOWN, ACROSS = G * math.sin(ANGLE), G * math.cos(ANGLE)
SLIDES, STAYS = "block, friction 0.3", "block, friction 0.7: displacement / d"
# Friction of the ball and what it does: rolls while tan(angle) <= 3 mu (disc), 3.5 mu (sphere).
BALLS = {
    "disc rolls": (2, 0.5, DOWN / 1.5),
    "disc slides": (2, 0.1, DOWN - 0.1 * ACROSS),
    "sphere rolls": (3, 0.5, DOWN / 1.4),
    "sphere slides": (3, 0.1, DOWN - 0.1 * ACROSS),
}
SPINS = {"disc slides": 2 * 0.1 * ACROSS / RADIUS, "sphere slides": 2.5 * 0.1 * ACROSS / RADIUS}
LATE = (0.1, 0.4)  # s, between which accelerations are taken

SPEED, DIAMETER, DENSITY = 6.0, 0.01, 2750.0
YOUNG, POISSON = 53.06e9, 0.1688
REDUCED = 0.02  # xi of the slow contact
TIME, POWER, OVERLAP = "time of contact", "its power of xi", "overlap, softened"
LINEAR, HERTZ = "restitution, linear", "restitution, Hertz"
RESTITUTION = 0.5

REPOSE = "angle of repose"
PACKINGS = tuple(np.random.default_rng(1).integers(1, 1000, 9).tolist())  # their seeds
RUNS = PACKINGS[:3]  # of what does not scatter by five degrees
ASPECTS = (0.5, 1.0, 2.0, 5.0)
HIGHEST = ASPECTS[-1]


def on_incline(steps: float, *overrides: str) -> Outcome:
    """Accelerations of a block, a disc and a sphere; the spins of those that slide."""
    common = (f"steps={steps:g}", *overrides)
    sliding, _ = _acceleration("kind=block", "friction=0.3", *common)
    values = {SLIDES: Value(sliding, DOWN - 0.3 * ACROSS)}
    held = Running("incline", "kind=block", "friction=0.7", *common)
    held.advance(LATE[1])
    values[STAYS] = Value(float(held.grains()["centre"][0, 0]) / DIAMETER)
    for name, (dim, friction, expected) in BALLS.items():
        along, turning = _acceleration(f"dim={dim}", f"friction={friction}", *common)
        values[name] = Value(along, expected)
        if name in SPINS:
            values[_spin(name)] = Value(turning, SPINS[name])
    return Outcome(values)


def _spin(name: str) -> str:
    return f"{name}: rate of spin"


def _acceleration(*overrides: str) -> tuple[float, float]:
    """Along the incline, m/s2, and of the spin, rad/s2."""
    run, speeds, spins = Running("incline", *overrides), [], []
    for time in LATE:
        run.advance(time)
        table = run.grains()
        speeds.append(table["velocity"][0, 0])
        spins.append(np.linalg.norm(table["spin"][0]))
    passed = LATE[1] - LATE[0]
    return float(np.diff(speeds)[0] / passed), float(np.diff(spins)[0] / passed)


def impact(steps: float, *overrides: str) -> Outcome:
    """Spheres of basalt at 6 m/s, of Young's modulus and softened; discs, softened."""
    run = partial(_meet, f"steps={steps:g}", *overrides)
    stiff = "contact.stiffness=material"
    time, _, _ = run("dim=3", stiff)
    slow, _, _ = run("dim=3", stiff, f"reduction={REDUCED}")
    _, overlap, _ = run("dim=3")
    mass = DENSITY * math.pi / 6 * DIAMETER**3 / 2
    modulus = YOUNG / (1 - POISSON**2) / 2
    root = math.sqrt(DIAMETER / 4)
    deepest = (15 / 16 * mass * SPEED**2 / (modulus * root)) ** 0.4
    lossy = f"restitution={RESTITUTION}"
    return Outcome(
        {
            TIME: Value(time, 2.9432751 * deepest / SPEED),
            POWER: Value(math.log(slow / time) / math.log(REDUCED), -0.8),
            OVERLAP: Value(overlap, 0.01),
            LINEAR: Value(run(lossy)[2], RESTITUTION),
            HERTZ: Value(run("dim=3", lossy)[2], RESTITUTION),
        }
    )


def _meet(*overrides: str) -> tuple[float, float, float]:
    """Time of contact, s, largest overlap over the diameter, speed after over that before."""
    run = Running("impact", *overrides)
    start = 0.02 * DIAMETER / SPEED  # they touch
    run.advance(0.99 * start)
    sample, overlap = 0.01 * start, [0.0]
    touching: list[float] = []
    while not touching or run.grains()["contacts"][0] > 0:
        run.advance(run.time + sample)
        table = run.grains()
        overlap.append(float(table["overlap"][0]))
        if table["contacts"][0] > 0:
            touching.append(run.time)
    after = -float(run.grains()["velocity"][0, 0]) / (SPEED / 2)
    return touching[-1] - touching[0] + sample, max(overlap), after


def repose(grains: float, *overrides: str, packings: tuple[int, ...] = PACKINGS) -> Outcome:
    """The slope that stays when a box of grains loses a side; the mean of several packings."""
    angles, curves = [], []
    for seed in packings:
        run = Running(
            "grain-repose", f"grains={grains:g}", f"body.load.random_seed={seed}", *overrides
        )
        run.advance(run.scenario.time_max)
        x, d = _centres(run), run.constant("d")
        angle, edge, top = surface_slope(x, 2 * d, run.constant("width"))
        angles.append(math.degrees(angle))
        curves.append(Curve(f"packing {seed},", edge / d, top / d, points=True))
    return Outcome({REPOSE: Value(float(np.mean(angles)))}, curves)


def _centres(run: Running) -> np.ndarray:
    table = run.grains()
    return table["centre"][~table["fixed"] & ~table["removed"]]


def collapse(grains: float, *overrides: str, aspects: tuple[float, ...] = ASPECTS) -> Outcome:
    """How far columns of different shapes run out; the mean of several packings."""
    values, reach = {}, []
    for aspect in aspects:
        common = (f"grains={grains:g}", f"aspect={aspect}", *overrides)
        runs = [_collapsed(f"body.load.random_seed={seed}", *common) for seed in RUNS]
        height, ratio = np.mean(runs, axis=0)
        reach.append((height, ratio))
        values[run_out(aspect)] = Value(float(ratio / _middle(height)))
    line = np.geomspace(0.4, 6, 40)
    least, most = np.array([published(a) for a in line]).T
    return Outcome(
        values,
        [dots("", *np.array(reach).T)],
        [Curve("published, least", line, least), Curve("published, most", line, most)],
    )


def _collapsed(*overrides: str) -> tuple[float, float]:
    """Height over width of a settled column, and how far it ran over its width.

    What lies apart from the heap does not count.
    """
    run = Running("grains-dry", *overrides)
    d, width = run.constant("d"), run.constant("width")
    height = float(_centres(run)[:, 1].max()) + d / 2
    run.advance(run.scenario.time_max)
    heap = largest_cluster(_centres(run), 1.2 * d)
    return height / width, (float(heap[:, 0].max()) + d / 2 - width) / width


def run_out(aspect: float) -> str:
    """The name of a quantity."""
    return f"run-out over the published mean, a = {aspect:g}"


def published(aspect: float) -> tuple[float, float]:
    """Least and most of (L - L0)/L0: Lube et al. (2005), and as in Lagree et al. (2011), eq. 3.1.

    The laws of low and high columns change over where they meet.
    """
    return (
        min(1.2 * aspect, 1.9 * aspect ** (2 / 3)),
        min(1.8 * aspect, 2.3 * aspect ** (2 / 3)),
    )


def _middle(aspect: float) -> float:
    return float(np.mean(published(aspect)))


def _published_band(aspect: float) -> Band:
    """Widened by 15 %."""
    low, high = published(aspect)
    return between(0.85 * low / _middle(aspect), 1.15 * high / _middle(aspect))


INCLINE = Case(
    name="grains-incline",
    title="A block, a disc and a sphere on an incline of 30 degrees",
    across="steps in a contact",
    resolutions=(10, 20, 40),
    run=on_incline,
    criteria=(
        Criterion(SLIDES, (within(0.01),), "g (sin - mu cos)", unit="m/s2"),
        Criterion(STAYS, (small(0.01),), "tan 30 degrees is less than 0.7"),
        *(Criterion(name, (within(0.01),), "closed form", unit="m/s2") for name in BALLS),
        *(Criterion(_spin(name), (within(0.01),), "closed form", unit="rad/s2") for name in SPINS),
    ),
    axes=("", ""),
    controls=(
        Control(
            "rolling friction",
            "disc rolls",
            lambda n: on_incline(n, "material.stone.rolling_friction=0.1"),
        ),
        Control("gravity a fiftieth too weak", SLIDES, lambda n: on_incline(n, "g=9.6")),
    ),
)
IMPACT = Case(
    name="grains-impact",
    title="Grains of basalt that meet at 6 m/s",
    across="steps in a contact",
    resolutions=(10, 20, 40),
    run=impact,
    criteria=(
        Criterion(TIME, (within(0.05),), "Hertz: 24.59 us", unit="s"),
        Criterion(POWER, (within(0.01),), "the time of contact goes with xi^(-4/5)"),
        Criterion(OVERLAP, (within(0.02),), "the stiffness is chosen so that it is 1 %"),
        Criterion(LINEAR, (within(0.01),), "as declared"),
        Criterion(HERTZ, (within(0.01),), "as declared"),
    ),
    axes=("", ""),
    controls=(
        Control(
            "rock as soft as plastic", TIME, lambda n: impact(n, "material.stone.young_modulus=3e9")
        ),
    ),
)
REPOSE_CASE = Case(
    name="grains-repose",
    title="Angle of repose of discs",
    across="grains",
    resolutions=(400, 800, 1500),
    run=repose,
    criteria=(
        Criterion(
            REPOSE,
            (between(30, 40),),
            "gravel has 35 to 40 degrees; discs have no third direction to lock in",
            unit="degrees",
        ),
    ),
    axes=("x/d", "y/d"),
    controls=(
        Control(
            "grains that roll freely",
            REPOSE,
            lambda n: repose(n, "rolling_friction=0", packings=RUNS),
        ),
    ),
)
COLUMN = Case(
    name="grains-column",
    title="Columns of discs that collapse",
    across="grains",
    resolutions=(400, 800, 1500),
    run=collapse,
    criteria=tuple(
        Criterion(
            run_out(aspect),
            (_published_band(aspect),),
            "1.2 a to 1.8 a, for high columns 1.9 to 2.3 a^(2/3), and 15 % beyond",
            short="1500 discs run 3 % beyond it (one packing)" if aspect == HIGHEST else "",
        )
        for aspect in ASPECTS
    ),
    axes=("a", "(L - L0)/L0"),
    controls=(
        Control(
            "grains that hardly slide or roll",
            run_out(1.0),
            lambda n: collapse(n, "friction=5", "rolling_friction=5", aspects=(1.0,)),
        ),
    ),
)
CASES = (INCLINE, IMPACT, REPOSE_CASE, COLUMN)
