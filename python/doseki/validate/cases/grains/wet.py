"""Grains that do not stick, discs that settle or are held in a liquid, and the drag on one."""

from __future__ import annotations

import math

import numpy as np

from ....driver.gauges import build_gauges
from ...case import Case, Control, Criterion, Curve, Outcome, Value, between, within
from ...running import Running

G = 9.81
FALL, LAG = "fall / (g t^2/2)", "difference between grains"
SPEED, LIGHT = "terminal speed, steel", "terminal speed, stone"
DEEP = "terminal speed, stone, twice the depth"
RISE, SINK = "speed of a lighter disc", "speed of a heavier disc"
BOTH = "mean of both speeds"
STREAM = "mean speed"
LIFT = "lift over Archimedes"
LATE = 0.5  # share of the run after which the disc has its speed
LIQUID, DIAMETER, WIDTH = 1000.0, 0.01, 0.04  # kg/m3, m, m between the walls
STEEL, STONE = (8000.0, 2.6e-3), (2000.0, 1e-3)  # density of the disc, viscosity of the liquid
WATER = 1e-6  # m2/s
LET_GO = 0.6  # s


def hang(across: float) -> Outcome:
    """Discs that touch the bed above and one another, when they are let go."""
    run = Running("hung-grains", f"across={across:g}")
    before, moves = run.grains()["centre"], ~run.grains()["fixed"]
    run.advance(run.scenario.time_max)
    fall = (before - run.grains()["centre"])[moves, 1]
    free = G * run.time**2 / 2
    return Outcome(
        {FALL: Value(float(fall.mean() / free), 1.0), LAG: Value(float(np.ptp(fall) / free))}
    )


def printed(_across: float) -> Outcome:
    """The printed scheme: one-particle grains under a bed."""
    run = Running("hang")
    before = run.mean("position", "grains")[1]
    run.advance(0.1)
    fall = before - run.mean("position", "grains")[1]
    return Outcome({FALL: Value(float(fall / (9.8 * run.time**2 / 2)), 1.0)})


def hold(across: float, *overrides: str) -> Outcome:
    """What still water carries of a disc that is held in it, over two breaths of the column."""
    run = Running("held-disc", f"across={across:g}", *overrides)
    (gauge,) = build_gauges(run.scenario, run.body_names)
    times = np.linspace(0, run.scenario.time_max, 101)[1:]
    lift = []
    for time in times:
        run.advance(time)
        lift.append(gauge.read(run.simulation)[0][2])
    displaced = math.pi / 4 * DIAMETER**2 * LIQUID * G
    share = np.array(lift) / displaced
    sound = float(run.of_body(run.state(), "liquid")["sound_speed"].max())
    breath = 4 * run.constant("height") / sound
    return Outcome(
        {LIFT: Value(float(share[times > times[-1] - 2 * breath].mean()), 1.0)},
        [Curve("", times, share)],
        [Curve("Archimedes", times, np.ones(len(times)))],
    )


def settle(across: float) -> Outcome:
    """Discs midway between two walls: their speeds, late."""
    values, found, exact = {}, [], []
    deep = f"height={14 * DIAMETER:g}"
    for name, (density, nu), *more in ((SPEED, STEEL), (LIGHT, STONE), (DEEP, STONE, deep)):
        times, speed = _settled(across, density, nu, *more)
        values[name] = Value(_late(times, speed), faxen_speed(density, nu, WIDTH))
        found.append(Curve(name, times, speed))
        exact.append(Curve("Faxen", times, np.full(len(times), values[name].expected)))
    return Outcome(values, found, exact)


def too_viscous(across: float) -> Outcome:
    """Steel in an oil thrice as viscous as the formula is told."""
    density, nu = STEEL
    speed = _late(*_settled(across, density, 3 * nu))
    return Outcome({SPEED: Value(speed, faxen_speed(density, nu, WIDTH))})


def _settled(
    across: float, density: float, nu: float, *overrides: str
) -> tuple[np.ndarray, np.ndarray]:
    """Times, and the speed at which the disc falls."""
    disc = f"material.stone.rho0={density:g}", f"material.oil.nu={nu:g}", f"width={WIDTH:g}"
    run = Running("settling-disc", f"across={across:g}", *disc, *overrides)
    times = np.linspace(0, run.scenario.time_max, 61)[1:]
    speed = []
    for time in times:
        run.advance(time)
        speed.append(-float(run.grains()["velocity"][0, 1]))
    return times, np.array(speed)


def _late(times: np.ndarray, speed: np.ndarray) -> float:
    """Mean speed once it is steady."""
    return float(np.mean(speed[times > LATE * times[-1]]))


def afloat(across: float, share: float = 0.01) -> Outcome:
    """Discs a little lighter and heavier than the water that they are let go in."""
    values, found, bounds = {}, [], []
    for name, sign in {RISE: -1, SINK: 1}.items():
        density = LIQUID * (1 + sign * share)
        times, fall = _settled(across, density, WATER, f"time_max={LET_GO:g}")
        speed, bound = sign * fall, free_acceleration(LIQUID * (1 + 0.01 * sign)) * times
        values[name] = Value(float(np.sum(speed[-10:]) / np.sum(bound[-10:])))
        found.append(Curve(name, times, speed))
        bounds.append(Curve("without drag", times, bound))
    values[BOTH] = Value(0.5 * (values[RISE].number + values[SINK].number))
    return Outcome(values, found, bounds[:1])


def free_acceleration(density: float) -> float:
    """Acceleration, m/s2, of a disc that moves the water around it and has no drag."""
    return abs(density - LIQUID) * G / (density + LIQUID)


def faxen_speed(density: float, nu: float, width: float) -> float:
    """Slow fall of a disc midway between walls: Faxen (1946), in Happel and Brenner (1965)."""
    share = DIAMETER / width
    series = -math.log(share) - 0.9157 + 1.7244 * share**2 - 1.7302 * share**4
    weight = (density - LIQUID) * math.pi / 4 * DIAMETER**2 * G
    return weight * series / (4 * math.pi * LIQUID * nu)


def stream(across: float, *overrides: str) -> Outcome:
    """A square array of fixed discs of 10 mm in a slow stream: its mean speed, late."""
    run = Running("disc-array", f"across={across:g}", *overrides)
    times = np.linspace(0, run.scenario.time_max, 41)[1:]
    period = 2 * DIAMETER
    oils = (run.of_body(state, "liquid") for state in run.sampled(times))
    speed = np.array([oil["mass"] @ oil["velocity"][:, 0] for oil in oils]) / (LIQUID * period**2)
    pull, nu = run.constant("pull"), run.constant("viscosity_m2")
    expected = pull * period**2 / (array_drag(DIAMETER / period) * nu)
    return Outcome(
        {STREAM: Value(_late(times, speed), expected)},
        [Curve("", times, speed)],
        [Curve("Sangani and Acrivos", times, np.full(len(times), expected))],
    )


def array_drag(share: float) -> float:
    """Drag over mu U on a disc of a square array, of diameter `share` of the period.

    Series of Sangani and Acrivos, Int. J. Multiphase Flow 8 (1982), for slow flow.
    """
    c = math.pi / 4 * share**2
    return 4 * math.pi / (-math.log(c) / 2 - 0.738 + c - 0.887 * c**2 + 2.038 * c**3)


HANG = Case(
    name="grains-hang",
    title="Grains hung under a bed fall",
    across="d/dp",
    resolutions=(5, 8, 12),
    run=hang,
    criteria=(
        Criterion(FALL, (within(1e-3),), "contacts never pull, and stress stays inside a body"),
        Criterion(LAG, (within(1e-3),), "none leaves another behind"),
    ),
    axes=("", ""),
    controls=(Control("the printed scheme", FALL, printed),),
)
SETTLING = Case(
    name="grains-settling",
    title="Discs settle between two walls",
    across="d/dp",
    resolutions=(8, 12, 16),
    run=settle,
    criteria=(
        Criterion(
            SPEED,
            (within(0.1), within(0.05), within(0.05)),
            "5 % at 12 particles across",
            unit="m/s",
        ),
        Criterion(
            LIGHT,
            (within(0.1), within(0.05), within(0.05)),
            "the same where the weight is small beside the pressure of the liquid",
            unit="m/s",
        ),
        Criterion(
            DEEP,
            (within(0.1), within(0.05), within(0.05)),
            "the same under twice the pressure",
            unit="m/s",
        ),
    ),
    axes=("time (s)", "speed (m/s)"),
    controls=(Control("an oil thrice as viscous", SPEED, too_viscous),),
)
FREE = Case(
    name="grains-afloat",
    title="Discs a hundredth lighter and heavier than water",
    across="d/dp",
    resolutions=(12, 16, 20),
    run=afloat,
    criteria=(
        Criterion(RISE, (between(0.2, 1.5),), "over the speed without drag; 0.3 % of lift are 0.3"),
        Criterion(SINK, (between(0.2, 1.5),), "the same"),
        Criterion(
            BOTH, (between(0.2, 1.0),), "nothing drives them; what is wrong with lift is out"
        ),
    ),
    axes=("time (s)", "speed (m/s)"),
    controls=(Control("discs three times as light and as heavy", BOTH, lambda n: afloat(n, 0.03)),),
)
DRAG = Case(
    name="grains-drag",
    title="Drag on discs of 10 mm in a slow stream",
    across="d/dp",
    resolutions=(8, 12, 16),
    run=stream,
    criteria=(
        Criterion(
            STREAM,
            (within(0.1), within(0.05), within(0.05)),
            "the drag of a square array of discs to 5 % at 12 particles across",
            unit="m/s",
        ),
    ),
    axes=("time (s)", "mean speed (m/s)"),
    controls=(Control("free slip", STREAM, lambda n: stream(n, "wall=free_slip")),),
)
BUOYANCY = Case(
    name="grains-buoyancy",
    title="A disc is held in still water",
    across="d/dp",
    resolutions=(8, 12, 16),
    run=hold,
    criteria=(
        Criterion(
            LIFT,
            (within(0.02), within(0.01), within(0.01)),
            "1 % at 12 particles across; a lattice cut along the circle had 0.91 at 8",
        ),
    ),
    axes=("time (s)", "lift / weight of water displaced"),
    controls=(
        Control("a lattice cut along the circle", LIFT, lambda n: hold(n, "body.disc.jitter=1e-9")),
    ),
)
CASES = (HANG, SETTLING, FREE, DRAG, BUOYANCY)
