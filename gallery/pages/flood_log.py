"""A flood lifts a log and throws it against a bridge."""

from __future__ import annotations

import numpy as np

from doseki.record.reader import Run

from ..page import Chart, Film, Line, Number, Page
from ..reading import first_time, load_on, parameter

AFLOAT = 0.02  # m, that the log has risen


def numbers(run: Run) -> list[Number]:
    """When the log floats, how fast it goes, and what the bridge bears."""
    log = run.gauges["log"]
    risen = log["y"] - log["y"][0]
    free = log["x"] + parameter(run, "log_length") / 2 < parameter(run, "bridge_at") - 0.1
    water = run.gauges["upstream"]
    late = water["time"] > run.times[-1] - 0.5
    parts = load_on(run, "bridge").parts
    total, touch = parts["total"], parts["contact"]
    flows = parts["static"].means[0.1].value + parts["dynamic"].means[0.1].value
    return [
        Number("the log floats up", first_time(log["time"], risen > AFLOAT), "s"),
        Number("fastest of the log before the bridge", float(log["velocity_x"][free].max()), "m/s"),
        Number(
            "depth a metre before the bridge, last 0.5 s", float(water["depth"][late].mean()), "m",
            _uniform_depth(run), "uniform flow without a bridge, Keulegan (1938)",
        ),
        Number("load on the deck, highest mean over 10 ms", total.means[0.01].value, "N/m"),
        Number("highest mean over 100 ms", total.means[0.1].value, "N/m"),
        Number("of what the log gives by touch, over 100 ms", touch.means[0.1].value, "N/m"),
        Number("of what the water gives, over 100 ms, at most", flows, "N/m"),
    ]  # fmt: skip


def _uniform_depth(run: Run) -> float:
    """Depth of uniform flow of this discharge, m."""
    q, ks = parameter(run, "discharge"), parameter(run, "ks")
    pull = run.scenario["g"] * np.sin(np.radians(parameter(run, "slope_angle")))
    depths = np.linspace(0.02, 2, 20_000)
    speeds = np.sqrt(pull * depths) * (6.25 + 5.75 * np.log10(depths / ks))
    return float(np.interp(q, depths * speeds, depths))


def chart(run: Run) -> Chart:
    """The speed of the log."""
    log = run.gauges["log"]
    lines = [
        Line("along the bed", log["time"], log["velocity_x"]),
        Line("upwards", log["time"], log["velocity_y"]),
    ]
    return Chart("Velocity of the log", ("time (s)", "m/s"), lines)


PAGE = Page(
    scenario="flood-log",
    teaches="""
Driftwood: a rigid body that is lighter than water. It waits on the dry bed, floats as soon as the
bore has it lifted, dives below the deck of a low bridge and is wedged between deck and bed. From
then on the bridge is a dam: the water behind it rises. The load on the deck comes in parts, what
the water gives and what the log gives where it touches. While the log is driven under the deck its
share is by far the larger; once it lies, both are alike.
""",
    numbers=numbers,
    figures=("flood", "bridge"),
    chart=chart,
    film=Film("material"),
    then=(
        ("./doseki run flood-log --set clearance=1.2", "a bridge high enough: the log passes"),
        ("./doseki run flood-log --set wood=950", "a log that has soaked for a year"),
        ("./doseki run flood-log --set discharge=0.8", "a small flood"),
    ),
)
