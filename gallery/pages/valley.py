"""A debris flow on a map, a check dam with a slit, and a fan."""

from __future__ import annotations

import math

from doseki.measure.hydrographs import passage
from doseki.record.reader import Run

from ..page import Film, Number, Page
from ..reading import load_on, parameter


def numbers(run: Run) -> list[Number]:
    """What was released, what passed the dam, what it bore, how far it all went."""
    asked, volume = (float(each) for each in run.summary["released"]["release"])
    seen = passage(run.gauges["slit"])
    load = load_on(run, "dam")
    formula = {each.formula: each.force for each in load.design}
    went = run.summary["runout"]
    return [
        Number("volume that is released", volume, "m³", asked, "polygon times thickness"),
        Number("it is below the dam after", float(seen.arrival or "nan"), "s"),
        Number("highest discharge below the dam", seen.peak, "m³/s"),
        Number("share of the release that has passed", 100 * seen.volume / volume, "%"),
        Number(
            "load on the dam, highest mean over 100 ms",
            load.parts["total"].means[0.1].value / 1e6, "MN",
            formula["Kwan (2012), alpha 2.5"].value / 1e6, "Kwan (2012), 2.5 rho v² h b",
        ),
        Number("run-out, as the crow flies", went["distance"], "m"),
        Number(
            "angle of the run-out (Heim's Fahrböschung)", went["angle"], "°",
            _friction_angle(run), "arctan µ: with Coulomb's friction alone",
        ),
        Number("area covered", went["area"], "m²"),
    ]  # fmt: skip


def _friction_angle(run: Run) -> float:
    """The angle whose tangent is the bed's friction, degrees."""
    return math.degrees(math.atan(parameter(run, "friction")))


PAGE = Page(
    scenario="valley",
    teaches="""
The whole chain of a hazard study, small: a map, a release drawn on it as a polygon, boulders,
Voellmy's bed, a dam, and what an engineer asks for at the end: hydrograph, load, maps of the
peaks. The cells are coarse, six particles over the release, and `check` says what that costs; the
chain is the same on a real map.
""",
    numbers=numbers,
    figures=("overview", "peak_depth"),
    film=Film("material", frames_per_second=8, width=480),
    then=(
        ("./doseki maps runs/valley", "depth, speed, pressure, arrival: rasters with coordinates"),
        ("./doseki run valley --set slit=1.5", "a dam that is nearly shut"),
        ("./doseki run valley --set friction=0.2", "a rougher bed: does it come to the fan?"),
    ),
)
