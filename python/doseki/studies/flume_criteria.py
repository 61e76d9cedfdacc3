"""What the flume experiment saw, as numbers read from the record of a run, and their bands.

The statements are those of Ueta et al. (2022) about their experiment; the bands say when a
simulation is taken to agree with them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..errors import UserError
from ..measure import numbers as measure
from ..measure.census.census import (
    DEPOSITED,
    FLOATING,
    PRECEDING,
    Census,
    SpeedDraws,
    draw_speeds,
    take_census,
)
from ..measure.flow import Flow, measure_flow
from ..measure.views import fluid_names, tables, windows
from ..record.reader import Run
from ..scenario.schemes import RESOLVED, UETA2022
from ..scenario.tables.inflow import Inflow
from ..validate.case import Case, Criterion, Outcome, Value, at_most, between
from ..validate.judging import Row, judged

OUTLET, LOAD = "outlet", "load"  # windows that the scenario must have
SPEED, BALANCE = "water velocity at the slope end", "water out / water in"
AHEAD, FLOATS = "load ahead of the water", "load that floats, at most"
PASSED, STUCK = "load past the outlet in 7 s", "load left on the slope"
RATIO = "grain speed / water velocity"
SETTLED = 1.0  # s between the arrival of water at the outlet and the time over which it is averaged
EVACUATION = 7.0  # s
NOT_MEASURED = "not measured"  # the run ended too early, or nothing came by

CRITERIA = (
    Criterion(SPEED, (between(1.7, 2.3),), "measured: about 2 m/s, with a camera", "m/s"),
    Criterion(BALANCE, (between(0.98, 1.02),), "3 L/s go in, so 3 L/s must come out"),
    Criterion(
        AHEAD,
        (between(0.01, 0.2),),
        "grains that the water pushes arrive before it; most of them do not",
    ),
    Criterion(FLOATS, (between(0.01, 1.0),), "others ride above half the depth of the flow"),
    Criterion(
        PASSED,
        (between(0.95, 1.001),),
        "the water erodes the load; the transport capacity of 3 L/s takes it away in 4 to 5 s",
    ),
    Criterion(STUCK, (at_most(0.01),), "no grain comes to rest on the slope"),
    Criterion(
        RATIO,
        (between(0.85, 1.5),),
        "drag brings a grain of 10 mm to the speed of the stream within 0.3 to 0.6 m",
    ),
)
SHORT_OF_PAPER = "what the printed scheme is known to get wrong (docs/weaknesses.md)"


@dataclass(frozen=True)
class FlumeRun:
    """A run of the flume with what was measured of it."""

    run: Run
    census: Census
    flow: Flow
    speeds: SpeedDraws  # of grains in the outlet window while water runs there
    arrival: float  # of the water in the outlet window, s; nan: never
    outcome: Outcome

    @property
    def scheme(self) -> str:
        """Name of the scheme."""
        return self.run.scenario.get("scheme", UETA2022)

    @property
    def water(self) -> np.ndarray:
        """Mean velocity (T,) of the water down the slope in the outlet window, m/s."""
        return self.census.direction * np.array(self.flow.windows[OUTLET].fluid_velocity)


def measure_flume(run: Run) -> FlumeRun:
    """Measure a run; raises UserError where it is not one of the flume."""
    known = windows(run)
    missing = [name for name in (OUTLET, LOAD) if name not in known]
    if missing:
        raise UserError(f"{run.directory}: not a run of the flume: no window {missing[0]!r}")
    census, flow = take_census(run), measure_flow(run)
    if flow is None:
        raise UserError(f"{run.directory}: no water in this run")
    view, direction = known[OUTLET], census.direction
    upstream, end = (
        (view.upper[0], view.lower[0]) if direction < 0 else (view.lower[0], view.upper[0])
    )
    arrival = _reached(census, float(upstream))
    steady = (_reached(census, float(end)) + SETTLED, _supply_end(run))
    water = direction * np.array(flow.windows[OUTLET].fluid_velocity)
    steadily = (flow.times >= steady[0]) & (flow.times <= steady[1])
    rows = census.rows(view, arrival, _supply_end(run))
    evacuated = _at_load(census) + EVACUATION
    speeds = draw_speeds(measure.speed(census.table["velocity"][rows]))
    values = {
        SPEED: _mean(water, steadily),
        BALANCE: _balance(run, float(end), direction, steady),
        AHEAD: _ahead(census, arrival, float(end)),
        FLOATS: float(census.share(census.mass_of(FLOATING)).max()),
        PASSED: float(np.interp(evacuated, census.times, census.share(census.passed(end)))),
        STUCK: _stuck(census, float(end), float(view.lower[-1])),
        RATIO: _ratio(speeds.speeds, np.interp(census.table["time"][rows], flow.times, water)),
    }
    if not evacuated <= census.times[-1]:  # what the load does until then is not known
        values |= dict.fromkeys((FLOATS, PASSED, STUCK), math.nan)
    outcome = Outcome({name: Value(number) for name, number in values.items()})
    return FlumeRun(run, census, flow, speeds, arrival, outcome)


def verdicts(flume: FlumeRun) -> list[Row]:
    """A row for each criterion; the paper's scheme falls short where it misses one.

    What was not measured has no verdict.
    """
    short = "" if flume.scheme == RESOLVED else SHORT_OF_PAPER
    criteria = tuple(
        Criterion(c.quantity, c.bands, c.reason, c.unit, short=short) for c in CRITERIA
    )
    across = float(flume.census.table["diameter"].mean()) / flume.run.scenario["dp"]
    case = Case(
        flume.scheme, "The flume", "d/dp", (across,), lambda _: flume.outcome, criteria, ("", "")
    )
    rows = judged(case, {across: flume.outcome})
    return [
        row if math.isfinite(flume.outcome.values[row.quantity].number)
        else replace(row, verdict=NOT_MEASURED, note="")
        for row in rows
    ]  # fmt: skip


def _reached(census: Census, x: float) -> float:
    """Time at which the front of the water is first at or beyond x, s; nan if never."""
    with np.errstate(invalid="ignore"):
        there = np.flatnonzero(census.direction * (census.front - x) >= 0)
    return float(census.times[there[0]]) if len(there) else math.nan


def _supply_end(run: Run) -> float:
    """When the last inflow stops, s."""
    return max(
        (float(t.rows[-1, 0]) for t in tables(run, "inflow", Inflow).values()), default=math.inf
    )


def _mean(values: np.ndarray, mask: np.ndarray) -> float:
    chosen = values[mask & np.isfinite(values)]
    return float(chosen.mean()) if len(chosen) else math.nan


def _ratio(speeds: np.ndarray, water: np.ndarray) -> float:
    """Mean speed of grains over the mean velocity that the water had beside them."""
    beside = np.isfinite(water)
    return float(speeds[beside].mean() / water[beside].mean()) if beside.any() else math.nan


def _balance(run: Run, section: float, direction: int, steady: tuple[float, float]) -> float:
    """Water that crosses the section over what enters, between two times."""
    first, last = steady
    if not last - first >= 1.0:
        return math.nan
    fluids = sorted(fluid_names(run))
    passed, times, left = measure.PassedMass(section, direction), run.times, []
    for snapshot in run:
        water = np.isin(snapshot["material"], fluids) & (snapshot["motion"] == 0)
        x = snapshot["position"][water, 0]
        left.append(passed.update(x, snapshot["mass"][water], snapshot["id"][water]))
    out = np.interp(last, times, left) - np.interp(first, times, left)
    entered = run.history["mass_entered"]
    came = np.interp([first, last], run.history["time"], entered)
    return float(out / (came[1] - came[0]))


def _ahead(census: Census, arrival: float, outlet: float) -> float:
    """Share of the load that moves ahead of the water or has passed, when it is at the window."""
    if math.isnan(arrival):
        return math.nan
    k = int(np.searchsorted(census.times, arrival))
    gone = census.passed(outlet)[k]
    beyond = census.direction * (census.table["position"][:, 0] - outlet) > 0
    now = (census.table["time"] == census.times[k]) & (census.table["kind"] == PRECEDING) & ~beyond
    now &= census.table["is_load"]
    return float(census.share(census.table["mass"][now].sum() + gone))


def _at_load(census: Census) -> float:
    """Time at which the water has reached the load, s; nan if never."""
    first = census.table["time"] == census.times[0]
    x = census.table["position"][first, 0]
    return _reached(census, float(x.max() if census.direction < 0 else x.min()))


def _stuck(census: Census, outlet: float, below: float) -> float:
    """Share of the load at rest upstream of the outlet at the end, moved or not.

    What lies lower than `below` lies under the flume.
    """
    table = census.table
    upstream = census.direction * (table["position"][:, 0] - outlet) < 0
    upstream &= table["position"][:, -1] > below
    resting = table["is_load"] & ((table["kind"] == DEPOSITED) | (table["kind"] == 0))
    return float(census.share(table["mass"][census.last() & upstream & resting].sum()))
