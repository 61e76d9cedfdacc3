"""A tap lets go of three drops over a basin."""

from __future__ import annotations

import numpy as np

from doseki.record.reader import Run

from ..page import Film, Number, Page
from ..reading import moving, over_time, parameter

LOOKED_AT = 0.14  # s: the first drop is whole, and has not come to the basin


def numbers(run: Run) -> list[Number]:
    """The fall of the first drop, the level that three drops make, and the splash."""
    g, fall, depth = run.scenario["g"], parameter(run, "fall"), parameter(run, "depth")
    speed, tap, opened = (parameter(run, name) for name in ("speed", "tap", "open"))
    drop = run.at(LOOKED_AT, nearest=True)
    of_it = moving(drop, "tap", "body") & (drop["position"][:, 1] < depth + fall)
    fallen = depth + fall - drop["position"][of_it, 1].mean()
    pace = float(-drop["velocity"][of_it, 1].mean())
    volume = run.history["mass_entered"][-1] / 1000
    middle, side = run.gauges["middle"]["height"], run.gauges["side"]
    late = side["time"] > side["time"][-1] - 0.1
    highest = over_time(run, lambda s: s["position"][moving(s, "water", "body"), 1].max())
    return [
        Number(
            f"speed of the first drop, {100 * fallen:.1f} cm below the tap", pace, "m/s",
            float(np.sqrt(speed**2 + 2 * g * fallen)), "free fall, sqrt(u² + 2 g s)",
        ),
        Number(
            "water that three drops bring, of a slice 1 m wide", 1000 * volume, "L",
            1000 * 3 * speed * tap * opened, "3 u b t of the tap",
        ),
        Number(
            "level at the side at the end, mean over 0.1 s", 1000 * side["height"][late].mean(),
            "mm", 1000 * (depth + volume / parameter(run, "basin")),
            "depth + volume / width, at rest",
        ),
        Number("deepest crater: water left below it", 1000 * float(middle.min()), "mm"),
        Number("highest splash, from the floor", 1000 * float(highest.max()), "mm"),
    ]  # fmt: skip


PAGE = Page(
    scenario="drip",
    teaches="""
How water enters a run: an `[inflow.tap]` with a `hydrograph`, here opened and shut three times. A
drop in the air has no pressure to hold it back and falls as a stone does; what it brings is
counted to the last particle. And the smallest habit worth having: compare a number with a formula
before trusting a picture.
""",
    numbers=numbers,
    figures=("drops", "level"),
    film=Film("speed", width=480),
    then=(
        ("./doseki run drip --set fall=0.1", "drops that fall half as far"),
        ("./doseki run drip --set depth=0.08", "a deeper basin: where does the crater end?"),
        ("./doseki run drip --set speed=0.25", "the tap opened half as far"),
    ),
)
