"""Debris slides into a reservoir and drives a wave."""

from __future__ import annotations

import numpy as np

from doseki.record.reader import Run

from ..page import Chart, Film, Line, Number, Page
from ..reading import first_time, load_on, moving, over_time, parameter


def numbers(run: Run) -> list[Number]:
    """The slide, the wave at two poles and what the far wall bears."""
    g, h = run.scenario["g"], parameter(run, "depth")
    theta = np.radians(parameter(run, "angle"))
    along = np.array([np.cos(theta), -np.sin(theta)])
    shore = h / np.sin(theta)  # of the water, along the slope from its foot

    def fastest_front(snapshot: object) -> float:
        return float(np.max(snapshot.grains["position"] @ along))  # type: ignore[attr-defined]

    front = over_time(run, fastest_front) + parameter(run, "block") / 2
    speed = over_time(run, lambda s: np.mean(s.grains["velocity"] @ along))
    arrives = first_time(run.times, front > -shore)
    friction = (parameter(run, "slope_friction") + 0.5) / 2
    length = parameter(run, "toe") - shore
    free = np.sqrt(2 * g * length * (np.sin(theta) - friction * np.cos(theta)))
    at_shore = float(np.interp(arrives, run.times, speed))
    first, second = run.gauges["first"], run.gauges["second"]
    before = second["time"] < _reflected(run)
    crests = [int(np.argmax(np.where(before, gauge["height"], 0))) for gauge in (first, second)]
    heights = [gauge["height"][k] - h for gauge, k in zip((first, second), crests, strict=True)]
    passed = second["time"][crests[1]] - first["time"][crests[0]]
    away = parameter(run, "second_pole") - parameter(run, "first_pole")
    amplitude = float(np.mean(heights))
    load = load_on(run, "shore").parts["total"]
    rest = 0.5 * 1000 * g * h**2
    run_up = over_time(run, lambda s: _wet_height(s, parameter(run, "length"), run.scenario["dp"]))
    return [
        Number(
            "mean speed of the blocks as the first one is in the water", at_shore, "m/s",
            float(free), "a block that slides, sqrt(2 s g (sin θ - µ cos θ))",
        ),
        Number("crest at the first pole, above the level at rest", 100 * heights[0], "cm"),
        Number("crest at the second pole", 100 * heights[1], "cm"),
        Number(
            "speed of the crest between the poles", float(away / passed), "m/s",
            float(np.sqrt(g * (h + amplitude))), "solitary wave, sqrt(g (h + a))",
        ),
        Number(
            "run-up at the far wall, above the level at rest", 100 * float(run_up.max() - h), "cm",
            200 * heights[1], "2 a: a low wave that a wall throws back",
        ),
        Number(
            "thrust on the far wall, highest mean over 100 ms, over that at rest",
            load.means[0.1].value / rest, "", float((1 + 2 * heights[1] / h) ** 2),
            "(h + 2 a)² / h²: water at rest so high; a bound",
        ),
    ]  # fmt: skip


def _reflected(run: Run) -> float:
    """When the wave that the wall has thrown back may be at the second pole, s: then at the
    latest the crest has passed there.
    """
    h, g = parameter(run, "depth"), run.scenario["g"]
    crest = run.gauges["first"]["time"][np.argmax(run.gauges["first"]["height"])]
    way = (
        2 * parameter(run, "length") - parameter(run, "first_pole") - parameter(run, "second_pole")
    )
    return float(crest + 0.8 * way / np.sqrt(1.3 * g * h))


def _wet_height(snapshot: object, wall: float, dp: float) -> float:
    """The highest water within three spacings of the far wall, m; drops in the air left out."""
    x, y = snapshot["position"][moving(snapshot, "water")].T  # type: ignore[index, arg-type]
    near = np.sort(y[x > wall - 3 * dp])
    gaps = np.flatnonzero(np.diff(near) > 1.5 * dp)
    return float(near[gaps[0]] if len(gaps) else near[-1])


def chart(run: Run) -> Chart:
    """What the poles saw."""
    h = parameter(run, "depth")
    lines = [
        Line(
            f"{name} pole, x = {parameter(run, f'{name}_pole'):g} m",
            run.gauges[name]["time"],
            100 * (run.gauges[name]["height"] - h),
        )
        for name in ("first", "second")
    ]
    return Chart("Level above that at rest", ("time (s)", "cm"), lines)


PAGE = Page(
    scenario="slide-wave",
    teaches="""
A landslide into a lake does harm on the other shore. The wave that forms is long beside the depth
and runs nearly as a solitary wave does, the faster the higher it is; a wall at least doubles its
height, and more where the wave is as steep as here. Both can be checked from two gauges and the
particles at the wall. The wave breaks, and sheets of water tear between the blocks: there the
spacing is too coarse, as the checks below say.
""",
    numbers=numbers,
    figures=("wave",),
    chart=chart,
    film=Film("material", frames_per_second=15),
    then=(
        ("./doseki run slide-wave --set blocks=14", "half the slide: how much lower is the wave?"),
        ("./doseki run slide-wave --set toe=1", "a pile from higher up"),
        ("./doseki run slide-wave --set slope_friction=0.6", "a rough slope: the slide creeps in"),
    ),
)
