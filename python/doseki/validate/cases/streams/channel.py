"""Water alone down the flume, over beds of two roughnesses, with the same parameters."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from ....scenario.hydrographs import normal_depth
from ...case import Case, Control, Criterion, Curve, Outcome, Value, between, within
from ...estimators import mean_velocity
from ...running import Running, chosen, moving

G, SLOPE, RATE = 9.81, math.radians(20), 0.03  # m2/s: 3 L/s through a width of 0.1 m
PLANE, GRAINS = 4.7e-3, 10e-3  # m, ks of a plane bed and of one of 10 mm grains
SPEED, BALANCE = "mean speed", "out / in"
LATE = 0.5  # share of the run after which it is averaged
SAMPLES = 40


def keulegan(ks: float) -> tuple[float, float]:
    """Normal depth and mean speed of 30 L/s per metre of width on the slope."""
    depth = normal_depth(RATE, G * math.sin(SLOPE), ks)
    return depth, RATE / depth


def passing(run: Running, low: float, high: float) -> float:
    """Discharge per width in a reach, m2/s: sum of m u over rho and the length of the reach.

    Particles go with their velocity and with what shifts them.
    """
    wide = [math.inf] * (run.scenario.dim - 1)
    there = moving(run.simulation.sample([low, *(-x for x in wide)], [high, *wide]))
    speed = there["velocity"][:, 0] + there["shift"][:, 0]
    return float(-np.sum(there["mass"] * speed)) / 1000 / (high - low)


def flow(ks: float, particles: float, *overrides: str) -> Outcome:
    """A flume of 1.5 m: speed and discharge near the outlet, averaged over the second half."""
    depth, expected = keulegan(ks)
    run = Running(
        "channel",
        "flume_length=1.5",
        f"dp={depth / particles}",
        f"ks={ks}",
        "time_max=2.5",
        *overrides,
    )
    length, end = run.constant("upper_end"), run.scenario.time_max
    times = np.linspace(LATE, 1, SAMPLES) * end
    speeds, rates = [], []
    for last in map(moving, run.sampled(times)):
        near = chosen(last, last["position"][:, 0] < 0.4 * length)
        speeds.append(-mean_velocity(near))
        rates.append(passing(run, 0.1 * length, 0.4 * length))
    x, u = last["position"][:, 0], -last["velocity"][:, 0]
    reaches = np.linspace(0, length, 21)
    mean = [float(u[(x >= a) & (x < b)].mean()) for a, b in pairwise(reaches)]
    middle = 0.5 * (reaches[1:] + reaches[:-1])
    return Outcome(
        {
            SPEED: Value(float(np.mean(speeds)), expected),
            BALANCE: Value(float(np.mean(rates)) / RATE),
        },
        [Curve("", middle, np.array(mean))],
        [Curve("Keulegan", middle, np.full(len(middle), expected))],
    )


def case(name: str, title: str, ks: float) -> Case:
    """The flume with one bed."""
    return Case(
        name=name,
        title=title,
        across="depth/dp",
        resolutions=(4, 6, 8),
        run=lambda n: flow(ks, n),
        criteria=(
            Criterion(
                SPEED,
                (within(0.15),),
                "formulas for rough beds differ by that much; both beds have the same parameters",
                unit="m/s",
            ),
            Criterion(BALANCE, (between(0.98, 1.02),), "what enters leaves, averaged over 1.25 s"),
        ),
        axes=("distance from the outlet (m)", "mean speed (m/s)"),
        controls=(Control("no friction", SPEED, lambda n: flow(ks, n, "body.bed.wall=free_slip")),),
    )


CASES = (
    case("channel-plane", "The flume without debris, plane bed", PLANE),
    case("channel-grains", "The flume without debris, bed of 10 mm grains", GRAINS),
)
