"""A sphere that settles in a tank of oil, as ten Cate et al. (2002) measured it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, at_most, dots, within
from ...reference import read_columns
from ...running import Running

LATE, SPEED, WAY = "terminal speed", "worst miss of the speed", "worst miss of the way"
DIAMETER = 0.015  # m
SAMPLE = 0.01  # s
STEADY = 0.85  # share of the run after which the sphere has its speed
STARTED = 0.05  # s; before that the measured points scatter by more than the bands
FALLEN = 1.0  # diameters, from which on the miss of a way is relative to it
CONTROL = 0.25  # s, in which an oil thrice as viscous takes the sphere to its speed


@dataclass(frozen=True)
class Oil:
    """One of the oils of the experiment, and what was measured in it."""

    speeds: str  # table of m/s
    heights: str  # table of diameters above the floor
    density: float  # kg/m3
    viscosity: float  # Pa s
    terminal: float  # m/s, the largest that was measured


THIN = Oil(
    "ten-cate-2002-re-31.9-speed.csv", "ten-cate-2002-re-31.9-height.csv", 960.0, 0.058, 0.1233
)
THINNER = Oil(
    "ten-cate-2002-re-11.6-speed.csv", "ten-cate-2002-re-11.6-height.csv", 962.0, 0.113, 0.0869
)
THICKER = Oil(
    "ten-cate-2002-re-4.1-speed.csv", "ten-cate-2002-re-4.1-height.csv", 965.0, 0.212, 0.0577
)
THICK = Oil(
    "ten-cate-2002-re-1.5-speed.csv", "ten-cate-2002-re-1.5-height.csv", 970.0, 0.373, 0.0370
)


def settle(oil: Oil, across: float, thicker: float = 1.0, *overrides: str) -> Outcome:
    """The speed and the way of the sphere in an oil, or in one `thicker` times as viscous."""
    run = Running(
        "sphere-in-oil", f"across={across:g}", f"oil_density={oil.density:g}",
        f"oil_viscosity={thicker * oil.viscosity:g}", *overrides,
    )  # fmt: skip
    times = np.arange(SAMPLE, run.scenario.time_max + SAMPLE / 2, SAMPLE)
    speed, height = [0.0], [_height(run)]
    for time in times:
        run.advance(time)
        speed.append(-float(run.grains()["velocity"][0, 2]))
        height.append(_height(run))
    return judged(oil, np.append(0.0, times), np.array(speed), np.array(height))


def _height(run: Running) -> float:
    """Of the sphere over the floor, in diameters."""
    return float(run.grains()["centre"][0, 2]) / DIAMETER - 0.5


def judged(oil: Oil, times: np.ndarray, speed: np.ndarray, height: np.ndarray) -> Outcome:
    """A fall (s, m/s, diameters above the floor) beside the measured one."""
    late = float(np.mean(speed[times > STEADY * times[-1]]))
    t_u, u = _until(times[-1], oil.speeds)
    miss = np.abs(np.interp(t_u, times, speed) - u)[t_u > STARTED] / oil.terminal
    t_h, h = _until(times[-1], oil.heights)
    way, ours = h[0] - h, np.interp(t_h[0], times, height) - np.interp(t_h, times, height)
    far = way > FALLEN
    missed = np.abs(ours[far] / way[far] - 1) if far.any() else np.array([np.nan])
    return Outcome(
        {
            LATE: Value(late, oil.terminal),
            SPEED: Value(float(miss.max())),
            WAY: Value(float(missed.max())),
        },
        [Curve("", times, speed)],
        [dots("ten Cate et al.", t_u, u)],
    )


def _until(end: float, table: str) -> np.ndarray:
    """The measured points up to the end of a run."""
    measured = read_columns(table)
    return measured[:, measured[0] <= end]


def in_oil(name: str, title: str, oil: Oil, short: str) -> Case:
    """The case of one oil."""
    return Case(
        name=name,
        title=title,
        across="d/dp",
        resolutions=(4, 8, 12),
        run=lambda across: settle(oil, across),
        criteria=(
            Criterion(
                LATE,
                (within(0.2), within(0.1), within(0.05)),
                "that of discs between walls, 10 % at 8 across, and twice as much at half of that",
                unit="m/s",
            ),
            Criterion(SPEED, (at_most(0.08),), "over the terminal speed", short=short),
            Criterion(
                WAY, (at_most(0.08),), "over the measured way, after a diameter", short=short
            ),
        ),
        axes=("time (s)", "speed (m/s)"),
        controls=(
            Control(
                "an oil thrice as viscous",
                LATE,
                lambda across: settle(oil, across, 3.0, f"time_max={CONTROL}"),
            ),
        ),
    )


CASES = (
    in_oil(
        "sphere-in-oil",
        "A sphere settles in oil, Re 31.9",
        THIN,
        "the layer at the sphere is thinner than the spacing: 1.3 mm against 3.7 mm at 4 across",
    ),
    in_oil(
        "sphere-in-thinner-oil",
        "A sphere settles in oil, Re 11.6",
        THINNER,
        "at 4 across its drag is a tenth too low, and it starts too fast",
    ),
    in_oil(
        "sphere-in-thicker-oil",
        "A sphere settles in oil, Re 4.1",
        THICKER,
        "at 4 across its drag is a sixth too low, and it starts too fast",
    ),
    in_oil(
        "sphere-in-thick-oil",
        "A sphere settles in oil, Re 1.5",
        THICK,
        "at 4 across its drag is an eighth too low, and it starts too fast",
    ),
)
