"""Gravel avalanches in a drum that turns."""

from __future__ import annotations

import numpy as np

from doseki.record.reader import Run, Snapshot

from ..page import Chart, Film, Line, Number, Page
from ..reading import over_time, parameter

STEADY = 2.5  # s: a quarter turn after the drum has begun to move, avalanches follow one another
MIDDLE = 0.6  # of the radius: where the surface is away from the wall
REPOSE = 34.1  # degrees; ./doseki validate grains-repose


def slope(snapshot: Snapshot, radius: float, d: float) -> float:
    """Angle of the surface, degrees: a line through the highest grain of each bin of 2 d."""
    x, y = snapshot.grains["position"].T
    cell = np.floor(x / (2 * d)).astype(int)
    cells = [k for k in np.unique(cell) if abs((k + 0.5) * 2 * d) < MIDDLE * radius]
    best = [np.flatnonzero(cell == k)[np.argmax(y[cell == k])] for k in cells]
    return float(np.degrees(np.arctan(np.polyfit(x[best], y[best], 1)[0])))


def angles(run: Run) -> np.ndarray:
    """The angle of the surface in each snapshot, degrees."""
    radius, d = parameter(run, "radius"), parameter(run, "diameter")
    return over_time(run, lambda s: slope(s, radius, d))


def numbers(run: Run) -> list[Number]:
    """The angle at which avalanches keep the surface, and how fast grains run down it."""
    angle, steady = angles(run), run.times > STEADY
    spin = 2 * np.pi * parameter(run, "turns")
    radius = parameter(run, "radius")
    fastest = over_time(run, lambda s: np.linalg.norm(s.grains["velocity"], axis=1).max())
    g = run.scenario["g"]
    return [
        Number(
            "angle of the surface, mean", float(angle[steady].mean()), "°", REPOSE,
            "heap of the same gravel after its side is taken away (validation)",
        ),
        Number("lowest, after an avalanche", float(np.quantile(angle[steady], 0.05)), "°"),
        Number("highest, before one", float(np.quantile(angle[steady], 0.95)), "°"),
        Number("speed of the drum's wall", float(spin * radius), "m/s"),
        Number("fastest grain, median over time", float(np.median(fastest[steady])), "m/s"),
        Number("Froude number of the drum, ω² R / g", float(spin**2 * radius / g)),
        Number("largest overlap of two grains", 100 * run.summary["largest_overlap"], "% of d"),
    ]  # fmt: skip


def chart(run: Run) -> Chart:
    """The angle over time: it grows until an avalanche."""
    begun = run.times > 0.5
    lines = [Line("surface of the gravel", run.times[begun], angles(run)[begun])]
    return Chart("Slope of the surface", ("time (s)", "degrees"), lines)


PAGE = Page(
    scenario="drum",
    teaches="""
Dry grains as bodies that collide, slide and roll; a wall that moves (`motion`) and that is made
of 24 turned copies of one box (`array`). Grains stand at an angle that their friction and rolling
friction decide, not the drum: turned slowly it is that of a heap. Between two avalanches the
slope grows, in one it falls, and both bounds are read from the record.
""",
    numbers=numbers,
    figures=("drum",),
    chart=chart,
    film=Film("speed", "drum"),
    then=(
        ("./doseki run drum --set rolling_friction=0", "grains that roll freely lie flatter"),
        ("./doseki run drum --set turns=0.6", "avalanches merge, the surface bends to an S"),
        ("./doseki run drum --set friction=0.2", "smooth grains"),
    ),
)
