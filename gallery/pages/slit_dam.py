"""Boulders jam in the slit of a check dam."""

from __future__ import annotations

import numpy as np

from doseki.record.reader import Run

from ..page import Film, Number, Page
from ..reading import load_on, parameter


def numbers(run: Run) -> list[Number]:
    """What is held, what the dam bears, beside what formulas for design expect."""
    load = load_on(run, "dam")
    total, touch = load.parts["total"], load.parts["contact"]
    formula = {each.formula: each.force for each in load.design}
    grains = run[-1].grains
    face = parameter(run, "dam_at") + parameter(run, "thick")
    held = int(np.count_nonzero(grains["position"][:, 0] < face))
    behind = run.gauges["behind"]
    water = behind["mass_upstream"][0] - float(grains["mass"].sum())
    passed = float(behind["mass_passed"][-1])
    return [
        Number(
            "width of the slit over the diameter of a boulder",
            parameter(run, "slit") / parameter(run, "boulder"),
        ),
        Number("boulders that are held at the end", held, f"of {len(grains['mass'])}"),
        Number("share of the water past the dam at the end", 100 * passed / water, "%"),
        Number(
            "load on the dam, highest mean over 100 ms", total.means[0.1].value / 1000, "kN",
            formula["Kwan (2012), alpha 2.5"].value / 1000,
            "Kwan (2012), 2.5 rho v² h b, of the flow that comes",
        ),
        Number(
            "highest mean over 10 ms", total.means[0.01].value / 1000, "kN",
            formula["Huebl & Holzinger (2003)"].value / 1000,
            "Hübl & Holzinger (2003), 5 rho v^0.8 (g h)^0.6 h b",
        ),
        Number(
            "share of the impulse that boulders give where they touch",
            100 * touch.impulse / total.impulse, "%",
        ),
    ]  # fmt: skip


PAGE = Page(
    scenario="slit-dam",
    teaches="""
A torrent in three dimensions on a few thousand particles: coarse, but enough for the question
that a slit dam asks. Boulders wider than the slit jam, the water goes through and over. The gauge
of loads keeps both apart, and prints what two formulas for design expect of the same flow. A dam
that reaches three layers into bed and banks is seen whole by its gauge.
""",
    numbers=numbers,
    figures=("dam", "load"),
    film=Film("material", frames_per_second=12),
    then=(
        ("./doseki run slit-dam --set 'slit=8*dp'", "a slit that boulders pass"),
        ("./doseki run slit-dam --set angle=15", "a steeper torrent"),
        ("./doseki report runs/slit-dam", "a page with a view that turns"),
    ),
)
