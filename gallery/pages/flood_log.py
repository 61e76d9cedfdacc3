"""A flood lifts a log and throws it against a bridge."""

from __future__ import annotations

import numpy as np

from doseki.record.reader import Run

from ..page import Chart, Film, Line, Number, Page
from ..reading import first_time, load_on, parameter

AFLOAT = 0.02  # m, that the log has risen


def numbers(run: Run) -> list[Number]:
    """When the log floats, how fast it goes, and what the bridge bears."""
    log, depth = run.gauges["log"], parameter(run, "log_depth")
    start = log["time"] > 0
    risen = log["y"] - log["y"][0]
    free = (risen > AFLOAT) & (log["x"] + parameter(run, "log_length") / 2 < 6.5)
    water = run.gauges["upstream"]
    flows = np.isfinite(water["velocity"]) & (water["time"] > 0.8 * run.times[-1])
    parts = load_on(run, "bridge").parts
    total, touch = parts["total"], parts["contact"]
    mass = parameter(run, "wood") * depth * parameter(run, "log_length")
    top = float(log["velocity_x"][free].max())
    contact = log["contact_force_x"]
    hit = start & (log["x"] + parameter(run, "log_length") / 2 > parameter(run, "bridge_at") - 0.3)
    blow = float(-np.sum((contact * np.gradient(log["time"]))[hit]))
    return [
        Number("the log floats up", first_time(log["time"], risen > AFLOAT), "s"),
        Number("fastest of the log before the bridge", top, "m/s"),
        Number(
            "of the water there, mean over its depth, late", float(water["velocity"][flows].mean()),
            "m/s", _keulegan(run), "Keulegan (1938), uniform flow on this slope",
        ),
        Number(
            "push of the log on the deck, impulse along x", blow, "N s/m", mass * top,
            "its momentum as it comes, m v",
        ),
        Number("load on the deck, highest mean over 10 ms", total.means[0.01].value, "N/m"),
        Number("highest mean over 100 ms", total.means[0.1].value, "N/m"),
        Number("of what the log gives by touch, over 100 ms", touch.means[0.1].value, "N/m"),
    ]  # fmt: skip


def _keulegan(run: Run) -> float:
    """Mean velocity of uniform flow of this discharge, m/s: of the depth that has it."""
    q, ks = parameter(run, "discharge"), parameter(run, "ks")
    pull = run.scenario["g"] * np.sin(np.radians(parameter(run, "slope_angle")))
    depths = np.linspace(0.02, 2, 20_000)
    speeds = np.sqrt(pull * depths) * (6.25 + 5.75 * np.log10(depths / ks))
    return float(np.interp(q, depths * speeds, speeds))


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
bore has it lifted, is slower than the front and jams against the deck of a bridge. The load on
the deck comes in parts: what the water gives and what the log gives where it touches, so that one
sees which of the two the bridge has to be built for.
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
