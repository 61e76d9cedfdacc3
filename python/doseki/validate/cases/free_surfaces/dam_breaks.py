"""Dam breaks against measurements: front, pressure on a wall, a box in the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ....measure.series import first_above, impulse
from ...case import (
    Case,
    Control,
    Criterion,
    Curve,
    Outcome,
    Value,
    at_most,
    between,
    dots,
    small,
    within,
)
from ...estimators import front, level, pressure_at, volume
from ...reference import read_columns
from ...running import Running, moving

RHO, G = 1000.0, 9.81
SHARE = 0.25  # of its peak: where a pressure is said to arrive

FRONTS = {
    "Koshizuka and Oka": "koshizuka-oka-1996-front.csv",
    "Martin and Moyce, 1.125 in": "martin-moyce-1952-front-1.125in.csv",
    "Martin and Moyce, 2.25 in": "martin-moyce-1952-front-2.25in.csv",
}
FAR, END_OF_TANK = 2.0, 4.5  # Z = x/a where the front counts: before that it is the gate's
IDEAL = "dam-front-vof.csv"
MEAN = "arrival of the front, mean error"
WORST = "arrival of the front, worst error beyond the doubt of the reference"
BEHIND = "arrival of the front before the measured one, mean"

BAND = "lobovsky-2014-sensor-2.csv"
SENSOR_HEIGHT, END = 0.015, 6.0  # m; t*
IMPULSE, PLACE, ARRIVAL = "impulse to t* = 6", "its place in the 95 % band", "arrival t*"

BOX_PRESSURE, BOX_LEVELS = "kleefsman-2005-p1.csv", "kleefsman-2005-levels.csv"
PEAK, TIME = "peak of P1", "arrival of P1"
GAUGES = {"H2": (0.992, 1), "H4": (2.638, 2)}  # x in m, column of the file
ROOM = "change of volume"


def run_along(particles: float, *overrides: str) -> Outcome:
    """The ideal front: Z = x/a over T = t sqrt(2 g/a), without gate and friction."""
    times, z = _front("dam-front", particles, *overrides)
    errors = _late(times, z, IDEAL)
    known, _, doubt = read_columns(IDEAL)
    beyond = np.maximum(np.abs(errors) - doubt / known, 0.0)
    measured = np.concatenate([_late(times, z, file) for file in FRONTS.values()])
    reference = [dots(name, *_measured(file, 0.0)) for name, file in FRONTS.items()]
    return Outcome(
        {
            MEAN: Value(float(np.mean(errors))),
            WORST: Value(float(beyond.max())),
            BEHIND: Value(float(np.mean(measured))),
        },
        [Curve("", times, z)],
        [Curve("volume of fluid", *_measured(IDEAL, 0.0)), *reference],
    )


def run_behind_gate(particles: float) -> Outcome:
    """The front behind a gate that rises, over a floor with a boundary layer."""
    times, z = _front("dam-front-gate", particles)
    values = {
        f"arrival of the front, mean error, {name}": Value(float(np.mean(_late(times, z, file))))
        for name, file in FRONTS.items()
    }
    reference = [dots(name, *_measured(file, 0.0)) for name, file in FRONTS.items()]
    return Outcome(values, [Curve("", times, z)], reference)


def _front(scenario: str, particles: float, *overrides: str) -> tuple[np.ndarray, np.ndarray]:
    """T and Z of samples of a run."""
    run = Running(scenario, f"particles={particles:g}", *overrides)
    a = run.constant("column_width")
    times = np.linspace(0, run.scenario.time_max, 181)
    z = np.array([front(moving(state), run.scenario.dp) / a for state in run.sampled(times)])
    return times * np.sqrt(2 * G / a), z


def _late(times: np.ndarray, z: np.ndarray, file: str) -> np.ndarray:
    """Relative delay of the simulated front at each place beyond FAR of a table."""
    known_times, places = _measured(file, FAR)
    arrivals = np.array([first_above(times, z, place) for place in places])
    return arrivals / known_times - 1


def _measured(file: str, least: float) -> np.ndarray:
    """(T, Z) of a table, from Z = `least` to what this tank holds."""
    table = read_columns(file)[:2]
    return table[:, (table[1] >= least) & (table[1] <= END_OF_TANK)]


def run_against(particles: float, *overrides: str) -> Outcome:
    """Pressure at sensor 2 over t* = t sqrt(g/H), in rho g H."""
    run = Running("dam-impact", f"particles={particles:g}", *overrides)
    height, dp = run.constant("column_height"), run.scenario.dp
    times = np.linspace(0, run.scenario.time_max, 651)
    sensor = (run.constant("length") + dp / 2, max(SENSOR_HEIGHT, dp / 2))
    pressure = np.array(
        [pressure_at(run.of_body(state, "right_wall"), sensor, dp) for state in run.sampled(times)]
    )
    return _sensor_outcome(times * np.sqrt(G / height), pressure / (RHO * G * height))


def _sensor_outcome(times: np.ndarray, pressure: np.ndarray) -> Outcome:
    t, low, median, high = read_columns(BAND)
    least, middle, most = (impulse(t, p, 0, END) for p in (low, median, high))
    found = impulse(times, pressure, 0, END)
    expected = first_above(t, median, SHARE * median.max())
    return Outcome(
        {
            IMPULSE: Value(found, middle),
            PLACE: Value((found - least) / (most - least)),
            ARRIVAL: Value(first_above(times, pressure, SHARE * pressure.max()) - expected),
        },
        [Curve("", times, pressure)],
        [Curve("2.5 %", t, low), Curve("median", t, median), Curve("97.5 %", t, high)],
    )


def run_over(particles: float) -> Outcome:
    """Pressure on the box and levels at two gauges."""
    run = Running("dam-obstacle", f"particles={particles:g}")
    dp, width = run.scenario.dp, run.constant("width")
    times = np.linspace(0, run.scenario.time_max, 1201)
    sensor = (run.constant("box_face") - dp / 2, width / 2 + 0.029, max(0.021, dp / 2))
    pressure, room = [], []
    levels: dict[str, list[float]] = {name: [] for name in GAUGES}
    for state in run.sampled(times):
        pressure.append(pressure_at(run.of_body(state, "box"), sensor, dp))
        water = moving(state)
        room.append(volume(water))
        for name, (x, _) in GAUGES.items():
            levels[name].append(level(water, (x, width / 2), dp))
    return _box_outcome(times, np.array(pressure), levels, room[-1] / room[0] - 1)


def _box_outcome(
    times: np.ndarray, pressure: np.ndarray, levels: Mapping[str, Sequence[float]], drift: float
) -> Outcome:
    t, p1 = read_columns(BOX_PRESSURE)
    measured = read_columns(BOX_LEVELS)
    values = {
        PEAK: Value(float(pressure.max()), float(p1.max())),
        TIME: Value(
            first_above(times, pressure, SHARE * pressure.max())
            - first_above(t, p1, SHARE * p1.max())
        ),
        ROOM: Value(drift),
    }
    for name, (_, column) in GAUGES.items():
        there = np.interp(times, measured[0], measured[column])
        values[name] = Value(float(np.mean(np.abs(np.array(levels[name]) - there)) / 0.55))
    curves = [Curve("H4,", times, np.array(levels["H4"]))]
    return Outcome(values, curves, [Curve("measured H4", measured[0], measured[GAUGES["H4"][1]])])


FRONT = Case(
    name="dam-front",
    title="Front of a dam break",
    across="column height/dp",
    resolutions=(40, 80, 160),
    run=run_along,
    criteria=(
        Criterion(
            MEAN,
            (small(0.04), small(0.02), small(0.02)),
            "an ideal front against volume of fluid, extrapolated from 20 to 40 cells over a",
        ),
        Criterion(
            WORST,
            (at_most(0.04), at_most(0.02), at_most(0.02)),
            "each arrival from Z = 2 to 4.5 by itself; the reference is least sure at Z = 2",
        ),
        Criterion(
            BEHIND,
            (None,),
            "an ideal front is ahead of experiments, which have a gate and a floor that drags",
        ),
    ),
    axes=("T = t sqrt(2 g/a)", "Z = x/a"),
    controls=(
        Control("gravity half as strong again", MEAN, lambda n: run_along(n, "gravity=[0, -14.7]")),
    ),
)
GATE = Case(
    name="dam-front-gate",
    title="Front of a dam break behind a gate, over a floor that drags",
    across="column height/dp",
    resolutions=(40, 80, 160),
    run=run_behind_gate,
    criteria=tuple(
        Criterion(
            f"arrival of the front, mean error, {name}",
            (None,),
            "neither the speed of the gate nor the roughness of the floor was published",
        )
        for name in FRONTS
    ),
    axes=("T = t sqrt(2 g/a)", "Z = x/a"),
)
IMPACT = Case(
    name="dam-impact",
    title="Pressure of a dam break on the wall it runs against",
    across="H/dp",
    resolutions=(20, 40, 80),
    run=run_against,
    criteria=(
        Criterion(
            IMPULSE, (None,), "of the median of 100 repetitions; judged by its place in the band"
        ),
        Criterion(
            PLACE,
            (between(-0.5, 1.5), between(0, 1), between(0, 1)),
            "0 and 1 are where 2.5 and 97.5 % of 100 repetitions lie; at 20 particles the jet is "
            "thinner than a few of them",
        ),
        Criterion(
            ARRIVAL,
            (small(0.15), small(0.05), small(0.05)),
            "0.05 in t* against the median's 2.46; no gate is simulated",
        ),
    ),
    axes=("t* = t sqrt(g/H)", "p / rho g H"),
    controls=(
        Control("gravity a fifth too weak", ARRIVAL, lambda n: run_against(n, "gravity=[0, -7.8]")),
    ),
)
OBSTACLE = Case(
    name="dam-obstacle",
    title="A dam break runs over a box, 3-D",
    across="H/dp",
    resolutions=(8, 16, 30),
    run=run_over,
    criteria=(
        Criterion(
            PEAK,
            (within(0.5), within(0.25), within(0.15)),
            "11.2 kPa within 15 % where the sensor's height is a spacing; a peak is one instant",
            unit="Pa",
            short="single spikes of pressure on the box and its edges, up to three times the peak",
        ),
        Criterion(
            TIME,
            (small(0.04), small(0.02), small(0.01)),
            "0.395 s within 0.01 s, when it first has a quarter of its peak",
            unit="s",
        ),
        Criterion("H2", (at_most(0.1), at_most(0.07), at_most(0.05)), "mean error over 0.55 m"),
        Criterion("H4", (at_most(0.1), at_most(0.07), at_most(0.05)), "mean error over 0.55 m"),
        Criterion(ROOM, (small(0.005),), "water keeps its volume through the impact"),
    ),
    axes=("time (s)", "height (m)"),
)
CASES = (FRONT, GATE, IMPACT, OBSTACLE)
