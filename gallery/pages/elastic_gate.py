"""Water pushes a gate of rubber open."""

from __future__ import annotations

import numpy as np

from doseki.record.reader import Run
from doseki.validate.reference import read_columns

from ..page import Chart, Line, Number, Page
from ..reading import moving, over_time, parameter

MEASURED = {axis: read_columns(f"antoci-2007-{axis}.csv") for axis in "xy"}


def foot(run: Run) -> np.ndarray:
    """How far the foot of the gate has gone (T, 2), m."""
    first = run[0]
    lowest = first["id"][
        moving(first, "gate", "body") & (first["position"][:, 1] < run.scenario["dp"])
    ]
    places = over_time(run, lambda s: s["position"][np.isin(s["id"], lowest)].mean(axis=0))
    return np.asarray(places - places[0])


def numbers(run: Run) -> list[Number]:
    """How far the gate opens, beside the experiment, and how far the water sinks."""
    gone, (at, measured) = foot(run), MEASURED["x"]
    level = run.gauges["level"]["height"]
    peak = int(np.argmax(gone[:, 0]))
    return [
        Number(
            "foot of the gate, farthest along x", 1000 * float(gone[peak, 0]), "mm",
            1000 * float(measured.max()), "experiment, Antoci et al. (2007)",
        ),
        Number(
            "when", float(run.times[peak]), "s", float(at[np.argmax(measured)]), "experiment",
        ),
        Number(
            "foot of the gate, highest", 1000 * float(gone[:, 1].max()), "mm",
            1000 * float(MEASURED["y"][1].max()), "experiment",
        ),
        Number(
            "level in the tank at the end, of that at the start",
            100 * float(level[-1] / parameter(run, "depth")), "%",
        ),
    ]  # fmt: skip


def chart(run: Run) -> Chart:
    """The path of the foot beside the experiment."""
    gone = 1000 * foot(run)
    lines = [Line(axis, run.times, gone[:, k]) for k, axis in enumerate("xy")]
    inside = {axis: at[:, at[0] <= run.times[-1]] for axis, at in MEASURED.items()}
    lines += [
        Line(f"{axis}, measured", at[0], 1000 * at[1], points=True) for axis, at in inside.items()
    ]
    return Chart("How far the foot of the gate goes", ("time (s)", "mm"), lines)


PAGE = Page(
    scenario="elastic-gate",
    teaches="""
Water and an elastic body that push each other. The gate is three layers of particles thick, which
is less than the five that are advised, and `check` says so: a plate of so few layers bends a
little too easily. The experiment goes farther all the same; with five layers the difference
stays, and it is the rubber's stiffness at large strain that is not well known.
""",
    numbers=numbers,
    figures=("gate",),
    chart=chart,
    then=(
        (
            "./doseki run elastic-gate --set layers=5",
            "five layers: the same curve, ten times the work",
        ),
        ("./doseki run elastic-gate --set young=31e6", "rubber four times as stiff"),
        ("./doseki run elastic-gate --set depth=0.1", "less water"),
    ),
)
