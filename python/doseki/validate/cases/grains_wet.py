"""Grains that do not stick, and a disc that settles in a liquid."""

from __future__ import annotations

import math

import numpy as np

from ..case import Case, Control, Criterion, Curve, Outcome, Value, within
from ..running import Running

G = 9.81
FALL, LAG = "fall / (g t^2/2)", "difference between grains"
SPEED = "terminal speed"
LATE = 0.5  # share of the run after which the disc has its speed
DISC = {"density": 2000.0, "liquid": 1000.0, "diameter": 0.01, "nu": 1e-3}


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


def settle(across: float, *overrides: str) -> Outcome:
    """A disc midway between two walls: its speed, late."""
    run = Running("settling-disc", f"across={across:g}", *overrides)
    times = np.linspace(0, run.scenario.time_max, 61)[1:]
    speed = []
    for time in times:
        run.advance(time)
        speed.append(-float(run.grains()["velocity"][0, 1]))
    late = times > LATE * times[-1]
    expected = faxen_speed(run.constant("width"))
    return Outcome(
        {SPEED: Value(float(np.mean(np.array(speed)[late])), expected)},
        [Curve("", times, np.array(speed))],
        [Curve("Faxen", times, np.full(len(times), expected))],
    )


def faxen_speed(width: float) -> float:
    """Slow fall of a disc midway between walls: Faxen (1946), in Happel and Brenner (1965)."""
    share = DISC["diameter"] / width
    series = -math.log(share) - 0.9157 + 1.7244 * share**2 - 1.7302 * share**4
    area = math.pi / 4 * DISC["diameter"] ** 2
    weight = (DISC["density"] - DISC["liquid"]) * area * G
    return weight * series / (4 * math.pi * DISC["liquid"] * DISC["nu"])


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
    title="A disc settles between two walls",
    across="d/dp",
    resolutions=(8, 12, 16),
    run=settle,
    criteria=(
        Criterion(
            SPEED,
            (within(0.1), within(0.05), within(0.05)),
            "5 % at 12 particles across",
            unit="m/s",
            short="39 % too slow at 8 particles across: too much drag in creeping flow",
        ),
    ),
    axes=("time (s)", "speed (m/s)"),
    controls=(
        Control("an oil thrice as viscous", SPEED, lambda n: settle(n, "material.oil.nu=3e-3")),
    ),
)
CASES = (HANG, SETTLING)
