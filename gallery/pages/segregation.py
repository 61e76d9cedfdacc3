"""Large grains rise through small ones."""

from __future__ import annotations

import numpy as np

from doseki.record.reader import Run

from ..page import Chart, Film, Line, Number, Page
from ..reading import first_time, parameter

AT_REST = 0.3  # s, for the chart: the layers have settled on the bumps


def numbers(run: Run) -> list[Number]:
    """How high the large grains lie above the small ones, in small diameters."""
    large, small = run.gauges["large"], run.gauges["small"]
    d = parameter(run, "small")
    above = (large["y"] - small["y"]) / d
    share = parameter(run, "few") * parameter(run, "ratio") ** 2 * d**2
    share /= share + parameter(run, "many") * d**2
    thickness = 2 * (share * large["y"] + (1 - share) * small["y"])[-1]
    speeds = [np.abs(run[-1].grains["velocity"][:, 0]).mean()]
    return [
        Number("large above small at the start, mean heights", float(above[0]), "d of small"),
        Number(
            "large above small at the end", float(above[-1]), "d of small",
            float(thickness / (2 * d)), "all large ones on top of all small ones",
        ),
        Number("both at the same height", first_time(large["time"], above > 0), "s"),
        Number("mean speed down the chute at the end", float(speeds[0]), "m/s"),
        Number("largest overlap of two grains", 100 * run.summary["largest_overlap"], "% of d"),
    ]  # fmt: skip


def chart(run: Run) -> Chart:
    """The mean heights of both over time."""
    lines = [
        Line(name, run.gauges[gauge]["time"], 100 * run.gauges[gauge]["y"])
        for gauge, name in (("large", "large grains"), ("small", "small grains"))
    ]
    return Chart("Mean height above the bed", ("time (s)", "cm"), lines)


PAGE = Page(
    scenario="segregation",
    teaches="""
Why boulders are at the front and on top of a debris flow. Nothing but shear, gravity and two
sizes is needed: small grains drop into gaps that open below them, large ones find none and are
levered up (kinetic sieving and squeeze expulsion). The chute is periodic, so that 180 mm of it
stand for an endless one, and a gauge of kind `mass_centre` follows each size. After
ten seconds nearly all large grains are at the surface but the lowest row, which bumps as regular
as these hold in place.
""",
    numbers=numbers,
    figures=("chute",),
    chart=chart,
    film=Film("material", "chute"),
    then=(
        ("./doseki run segregation --set time_max=25", "does the lowest row come loose?"),
        (
            "./doseki run segregation --set ratio=1",
            "one size under two names: they mix, none rises",
        ),
        (
            "./doseki run segregation --set angle=20",
            "a flatter chute: it hardly flows, nothing rises",
        ),
        ("./doseki run segregation --set ratio=3 --set few=16", "larger boulders"),
    ),
)
