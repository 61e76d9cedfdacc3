"""A bank of mud with boulders gives way and comes to rest."""

from __future__ import annotations

import numpy as np

from doseki.record.reader import Run

from ..page import Chart, Film, Line, Number, Page
from ..reading import moving, over_time, parameter


def toe(run: Run) -> np.ndarray:
    """How far the mud has come (T,), m: beyond all but a thousandth of it."""
    return over_time(run, lambda s: np.quantile(s["position"][moving(s, "mud"), 0], 0.999))


def depth_at(run: Run, x: float) -> float:
    """Depth of the mud at x at the end, m; its boulders count."""
    last, dp = run[-1], run.scenario["dp"]
    here = ~last["fixed"] & (np.abs(last["position"][:, 0] - x) < 2 * dp)
    return float(np.quantile(last["position"][here, 1], 0.98)) + dp / 2


def depth_at_rest(run: Run, length: float) -> float:
    """Depth, m, at a distance from the toe of Bingham's plastic that has come to rest.

    On a slope theta the yield stress bears rho g h (sin theta + cos theta dh/ds), s from the toe
    upwards (Liu & Mei, J. Fluid Mech. 207, 1989).
    """
    mud = run.scenario["material"]["mud"]
    theta = np.radians(parameter(run, "angle"))
    bears = mud["yield_stress"] / (mud["rho0"] * run.scenario["g"] * np.cos(theta))
    depth = np.linspace(0, bears / np.tan(theta), 20_001)[:-1]
    distance = np.cumsum(depth / (bears - depth * np.tan(theta))) * depth[1]
    return float(np.interp(length, distance, depth))


def numbers(run: Run) -> list[Number]:
    """How far, how fast and how steep."""
    front, speed = toe(run), np.gradient(toe(run), run.times)
    mean = np.linalg.norm(run[-1]["velocity"][moving(run[-1], "mud")], axis=1).mean()
    boulders = run[-1].grains["position"][:, 0] - run[0].grains["position"][:, 0]
    half = front[-1] / 2
    return [
        Number("toe at the start, from the wall", float(front[0]), "m"),
        Number("toe at the end", float(front[-1]), "m"),
        Number("fastest of the toe", float(speed.max()), "m/s"),
        Number(
            "depth halfway from the wall to the toe, at the end", depth_at(run, half), "m",
            depth_at_rest(run, half), "Bingham's plastic at rest (Liu & Mei 1989)",
        ),
        Number("mean speed of the mud at the end", 1000 * float(mean), "mm/s"),
        Number("way of the boulder that went least far", float(boulders.min()), "m"),
        Number("of that which went farthest", float(boulders.max()), "m"),
    ]  # fmt: skip


def chart(run: Run) -> Chart:
    """The toe over time."""
    return Chart("Toe of the mud", ("time (s)", "x (m)"), [Line("toe", run.times, toe(run))])


PAGE = Page(
    scenario="mud-slump",
    teaches="""
Mud is no water: it has a yield stress, here that of a sample that was measured, at 42 % of
sediment by volume (`preset`). A bank that is too high for it gives way, runs out, and stops as a
bank of another shape, which theory knows. Boulders ride along; where they touch the bed or one
another, the friction of contacts acts.
""",
    numbers=numbers,
    figures=("slump",),
    chart=chart,
    film=Film("material"),
    then=(
        ("./doseki run mud-slump --set cv=0.45", "3 % more sediment: the mud is twice as strong"),
        ("./doseki run mud-slump --set cv=0.3", "a thin mud, of a twentieth of the strength"),
        ("./doseki run mud-slump --set dim=3", "a strip of it in three dimensions"),
    ),
)
