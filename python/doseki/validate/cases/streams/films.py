"""Films on a slope of 20 degrees: without friction, laminar, and over a rough bed."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, within
from ...estimators import mean_velocity
from ...running import Running, State, moving

T = TypeVar("T", float, np.ndarray)

G, SLOPE, DEPTH = 9.81, math.radians(20), 0.02
ALONG = G * math.sin(SLOPE)
NU = 1e-3  # m2/s, of the laminar film
RATE, SURFACE = "q", "speed at the surface"
SPEED, THICKNESS = "mean speed", "thickness"
GAIN = "gain of speed / g sin(20 degrees) t"
KEULEGAN = math.sqrt(ALONG * DEPTH) * (6.25 + 5.75 * math.log10(DEPTH / 0.01))
STEADY, SAMPLE = 3.0, 0.05  # s: when the rough film is steady; how often it is looked at


def profile(state: State, label: str = "") -> Curve:
    """Speed down the slope over height."""
    y = state["position"][:, 1]
    return Curve(label, -state["velocity"][:, 0], y, points=True)


def slide(particles: float, *overrides: str) -> Outcome:
    """The film without friction, at the end."""
    run = Running("slip-film", f"particles={particles:g}", *overrides)
    times = np.linspace(0, run.scenario.time_max, 16)
    speed = np.array([-mean_velocity(moving(state)) for state in run.sampled(times)])
    return Outcome(
        {GAIN: Value(float(speed[-1] / (ALONG * times[-1])), 1.0)},
        [Curve("", times, speed)],
        [Curve("g sin(20 degrees) t", times, ALONG * times)],
    )


def laminar(particles: float, *overrides: str) -> Outcome:
    """The laminar film, when it has come to its parabola."""
    run = Running("nusselt-film", f"particles={particles:g}", *overrides)
    state = moving(run.advance(run.scenario.time_max))
    rate = float(-np.sum(state["mass"] * state["velocity"][:, 0])) / 1000 / run.constant("length")
    top = state["position"][:, 1] > DEPTH - 1.5 * run.scenario.dp
    y = np.where(top, state["position"][:, 1], np.nan)
    there = np.nanmean(nusselt_speed(y))  # the top particles lie a little below the surface
    surface = np.mean(-state["velocity"][top, 0]) * nusselt_speed(DEPTH) / there
    line = np.linspace(0, DEPTH, 50)
    return Outcome(
        {
            RATE: Value(rate, ALONG * DEPTH**3 / (3 * NU)),
            SURFACE: Value(float(surface), nusselt_speed(DEPTH)),
        },
        [profile(state)],
        [Curve("Nusselt", nusselt_speed(line), line)],
    )


def nusselt_speed(y: T) -> T:
    """u(y) of a laminar film."""
    return ALONG / NU * (DEPTH * y - y**2 / 2)


def rough(particles: float, *overrides: str) -> Outcome:
    """The film over a rough bed, averaged from when it is steady."""
    run = Running("rough-film", f"particles={particles:g}", *overrides)
    times = np.linspace(0, run.scenario.time_max, round(run.scenario.time_max / SAMPLE) + 1)
    speed, thickness = [], []
    for state in run.sampled(times):
        film = moving(state)
        speed.append(-mean_velocity(film))
        # The median: a single particle that hops over 80 others would add a tenth to the mean.
        thickness.append(2 * np.median(film["position"][:, 1]))
    late = times > STEADY
    return Outcome(
        {
            SPEED: Value(float(np.mean(np.array(speed)[late])), KEULEGAN),
            THICKNESS: Value(float(np.mean(np.array(thickness)[late])), DEPTH),
        },
        [Curve("", times, np.array(speed))],
        [Curve("Keulegan", times, np.full(len(times), KEULEGAN))],
    )


def printed(_particles: float) -> Outcome:
    """The printed scheme on its own film, 20 mm deep at 10 mm spacing."""
    run = Running("film", "depth=0.02", "dp=0.01")
    state = moving(run.advance(2.0))
    return Outcome({SPEED: Value(-mean_velocity(state), KEULEGAN)})


SLIP = Case(
    name="slip-film",
    title="Film on a bed without friction",
    across="depth/dp",
    resolutions=(2, 4, 8),
    run=slide,
    criteria=(
        Criterion(
            GAIN,
            (within(1e-3),),
            "no force acts along a plane bed without friction; walls that take the direction of "
            "pairs for their normal lose 6 to 58 %",
        ),
    ),
    axes=("time (s)", "mean speed (m/s)"),
    controls=(
        Control("a rough bed", GAIN, lambda n: slide(n, "body.bed.wall=rough", "body.bed.ks=0.01")),
    ),
)
NUSSELT = Case(
    name="nusselt-film",
    title="Laminar film",
    across="depth/dp",
    resolutions=(8, 16, 32),
    run=laminar,
    criteria=(
        Criterion(
            RATE,
            (within(0.08), within(0.03), within(0.03)),
            "3 % at 16 particles over the depth; order 1.5 from there to the coarser one",
            unit="m2/s",
        ),
        Criterion(SURFACE, (within(0.08), within(0.03), within(0.03)), "as for q", unit="m/s"),
    ),
    axes=("speed (m/s)", "y (m)"),
    controls=(
        Control("a bed without friction", RATE, lambda n: laminar(n, "body.bed.wall=free_slip")),
    ),
)
ROUGH = Case(
    name="rough-film",
    title="Film of water on a rough bed",
    across="depth/dp",
    resolutions=(4, 8, 16),
    run=rough,
    criteria=(
        Criterion(
            SPEED,
            (within(0.1),),
            "formulas for rough beds differ among themselves by 10 %; nothing is tuned",
            unit="m/s",
        ),
        Criterion(
            THICKNESS,
            (within(0.07), within(0.03), within(0.03)),
            "twice the height of the centre of mass: no swelling. The film is chaotic: runs that "
            "differ by rounding scatter by 0.32 % about +5.2 % at 4 across, where its surface is "
            "as rough as a particle, and by 0.04 % about +0.9 % at 8",
            unit="m",
        ),
    ),
    axes=("time (s)", "mean speed (m/s)"),
    controls=(
        Control("without turbulence", SPEED, lambda n: rough(n, "turbulence=none", "time_max=5")),
        Control("the printed scheme", SPEED, printed),
    ),
)  # fmt: skip
CASES = (SLIP, NUSSELT, ROUGH)
