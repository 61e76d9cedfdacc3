"""A dam break meets a step in the floor."""

from __future__ import annotations

import numpy as np

from doseki.record.reader import Run

from ..page import Film, Number, Page
from ..reading import first_time, load_on, moving, over_time, parameter


def numbers(run: Run) -> list[Number]:
    """The front, the blow on the step and what goes over it."""
    g, h = run.scenario["g"], parameter(run, "column_height")
    width, step = parameter(run, "column_width"), parameter(run, "step_at")
    front = over_time(run, lambda s: s["position"][moving(s, "water"), 0].max())
    # Between half and nine tenths of its way to the step.
    there = [np.interp(width + share * (step - width), front, run.times) for share in (0.5, 0.9)]
    speed = 0.4 * (step - width) / (there[1] - there[0])
    load = load_on(run, "step")
    total = load.parts["total"]
    formula = {each.formula: each.force for each in load.design}
    highest = over_time(run, lambda s: s["position"][moving(s, "water"), 1].max())
    over = run.gauges["over"]
    return [
        Number(
            "speed of the front before the step", float(speed), "m/s",
            2 * float(np.sqrt(g * h)), "Ritter (1892), 2 sqrt(g h): a bound, for an endless basin",
        ),
        Number("the wave is at the step", first_time(run.times, front > step - 0.02), "s"),
        Number(
            "load on the step, highest mean over 10 ms", total.means[0.01].value, "N/m",
            formula["rho v2 h b"].value, "highest rho v² h of the flow that comes",
        ),
        Number("highest mean over 100 ms", total.means[0.1].value, "N/m"),
        Number("highest drop, from the floor", float(highest.max()), "m"),
        Number(
            "share of the water past the step",
            100 * float(over["mass_passed"][-1] / over["mass_upstream"][0]), "%",
        ),
    ]  # fmt: skip


PAGE = Page(
    scenario="dam-step",
    teaches="""
What a structure bears. A load is an impulse over a time: the largest single step has no meaning
of its own, means over 10 and 100 ms have. The blow of the first tongue is about the momentum flux
rho v² h that a section gauge upstream reads, for a stream that is turned upwards; then the load
falls to that of the water that stands and flows over.
""",
    numbers=numbers,
    figures=("wave", "load"),
    film=Film("speed", frames_per_second=20),
    then=(
        ("./doseki run dam-step --set step_height=0.15", "a step that holds most of it back"),
        ("./doseki run dam-step --set 'dp=5 mm'", "the same with four times the particles"),
        ("./doseki run dam-step --set column_height=0.6", "a higher dam"),
    ),
)
