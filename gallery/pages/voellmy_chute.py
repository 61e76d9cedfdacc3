"""A mass slides down a slope and comes to rest on its run-out."""

from __future__ import annotations

import numpy as np

from doseki.record.reader import Run

from ..page import Chart, Film, Line, Number, Page
from ..reading import moving, over_time, parameter

SLIDES = (0.2, 1.0)  # s: the whole mass is still on the slope


def speed(run: Run) -> np.ndarray:
    """Speed of the mass centre (T,), m/s."""
    front = run.gauges["front"]
    return np.hypot(front["velocity_x"], front["velocity_y"])


def slides(run: Run, time: np.ndarray) -> np.ndarray:
    """Speed (n,) of a block on an endless slope at `time`, m/s.

    Of v' = g (sin - mu cos) - g v²/(xi h); it is v_end tanh(t a/v_end) with the acceleration a
    at rest and the terminal speed v_end.
    """
    g, theta = run.scenario["g"], np.radians(parameter(run, "angle"))
    a = g * (np.sin(theta) - parameter(run, "friction") * np.cos(theta))
    end = np.sqrt(a * parameter(run, "turbulent") * parameter(run, "thickness") / g)
    return np.asarray(end * np.tanh(a * time / end))


def numbers(run: Run) -> list[Number]:
    """The start, the fastest and where it comes to rest."""
    front = run.gauges["front"]
    time, pace = front["time"], speed(run)
    early = (time > SLIDES[0] - 1e-9) & (time < SLIDES[1] + 1e-9)
    slope, _ = np.polyfit(time[early], pace[early], 1)
    block, _ = np.polyfit(time[early], slides(run, time[early]), 1)
    x = over_time(run, lambda s: np.quantile(s["position"][moving(s, "debris"), 0], 0.999))
    fallen = front["y"][0] - front["y"][-1]
    return [
        Number(
            "acceleration of the mass centre, 0.2 to 1 s", float(slope), "m/s²", float(block),
            "Voellmy (1955): g (sin θ - µ cos θ) - g v² / (ξ h)",
        ),
        Number("fastest of the mass centre", float(pace.max()), "m/s"),
        Number("its speed at the end", float(pace[-1]), "m/s"),
        Number("toe at the end, from the foot of the slope", float(x[-1]), "m"),
        Number(
            "fall of the mass centre over its way on the map",
            float(fallen / (front["x"][-1] - front["x"][0])), "", parameter(run, "friction"),
            "µ: what Coulomb's friction alone would have; ξ takes the rest",
        ),
    ]  # fmt: skip


def chart(run: Run) -> Chart:
    """The speed beside that of a block on an endless slope."""
    time = run.gauges["front"]["time"]
    on_slope = time[time <= 1.5]
    lines = [
        Line("mass centre", time, speed(run)),
        Line("block on an endless slope", on_slope, slides(run, on_slope)),
    ]
    return Chart("Speed of the debris", ("time (s)", "m/s"), lines)


PAGE = Page(
    scenario="voellmy-chute",
    teaches="""
The friction law that practice has for debris flows and avalanches, Voellmy's: a share µ of the
normal stress and a drag with v², on the bed alone. The debris itself keeps the stronger friction
of its grains, so that it slides as a whole. Its centre follows the closed form of a block while
it is on the slope, and it comes to rest on the level by itself.
""",
    numbers=numbers,
    figures=("slide",),
    chart=chart,
    film=Film("speed", frames_per_second=8),
    then=(
        ("./doseki run voellmy-chute --set friction=0.1", "half the friction: it runs out farther"),
        ("./doseki run voellmy-chute --set turbulent=100", "more drag: slower, hardly shorter"),
        ("./doseki run voellmy-chute --set dim=3", "it spreads sideways as well"),
    ),
)
