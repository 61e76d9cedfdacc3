"""The flume of the paper: water runs over 20 kg of grains."""

from __future__ import annotations

import numpy as np

from doseki.measure.census.census import PRECEDING, take_census
from doseki.record.reader import Run

from ..page import Chart, Film, Line, Number, Page
from ..reading import moving, over_time


def front(run: Run) -> np.ndarray:
    """Where the water has come to (T,), m above the outlet; it comes down from above."""
    return over_time(run, lambda s: _lowest(s["position"][moving(s, "water"), 0]))


def _lowest(x: np.ndarray) -> float:
    return float(np.quantile(x, 0.002)) if len(x) else float("nan")


def numbers(run: Run) -> list[Number]:
    """The water, the load, and the ledger."""
    census, water = take_census(run), front(run)
    last = census.last()
    table = census.table
    mass = table["mass"][last]
    ahead = mass[table["kind"][last] == PRECEDING].sum()
    speed = np.linalg.norm(table["velocity"][last], axis=1)
    moves = speed > 0.1
    history = run.history
    came = float(history["mass_entered"][-1])
    rate = 1000 * 0.003 / 0.1 * float(run.times[-1])
    late = run.times > 0.5 * run.times[-1]
    pace = -np.polyfit(run.times[late], water[late], 1)[0]
    return [
        Number("water that has entered", came, "kg/m", rate, "3 L/s over 0.1 m"),
        Number("front of the water at the end, above the outlet", float(water[-1]), "m"),
        Number("speed of that front, second half", float(pace), "m/s"),
        Number("share of the load that moves", 100 * mass[moves].sum() / mass.sum(), "%"),
        Number("share of it ahead of the water", 100 * float(ahead / mass.sum()), "%"),
        Number("mean speed of the grains that move", float(speed[moves].mean()), "m/s"),
        Number(
            "ledger of mass: initial + entered - left - inside",
            float(run.summary["ledger_residual"]), "kg/m", 0.0, "exact",
        ),
    ]  # fmt: skip


def chart(run: Run) -> Chart:
    """The front of the water over time."""
    return Chart(
        "Front of the water", ("time (s)", "x above the outlet (m)"),
        [Line("front", run.times, front(run))],
    )  # fmt: skip


PAGE = Page(
    scenario="flume",
    settings=("time_max=2",),
    teaches="""
The experiment that doseki was written for, with the scheme of its paper: water and grains are
both particles of a continuum, a grain is one particle. These are the first two seconds: the water
floods the load and begins to carry it. The scheme's weaknesses are part of it and are measured:
its water is too slow, because its artificial viscosity acts like thousands of times that of
water. The other scheme cures that (`--set scheme=resolved`), and both stand beside the experiment
in [compare.md](../compare.md).
""",
    numbers=numbers,
    figures=("overview",),
    chart=chart,
    film=Film("material", frames_per_second=10),
    then=(
        ("./doseki run flume", "the whole experiment, 9 s"),
        (
            "./doseki run flume --set scheme=resolved",
            "grains that collide and roll, water at the right speed",
        ),
        ("./doseki compare flume", "both schemes beside the experiment (an hour)"),
    ),
)
