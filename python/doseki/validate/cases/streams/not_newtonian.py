"""Liquids that yield: Bingham's plastic between plates, and grains with the friction mu(I)."""

from __future__ import annotations

import math

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, at_most, within
from ...estimators import rms
from ...running import Running, moving

G = 9.81
PROFILE, PLUG = "L2(u)", "speed of the plug"
SURFACE, CREEP = "speed at the surface", "creep at 20 degrees"
STRESS_AT_WALL, VISCOSITY, HALF = 400.0, 100.0, 0.5  # Pa, Pa s, m: those of bingham.toml
YIELD_STRESS = 160.0
DEPTH, BEAD, PACKING, DENSITY = 0.02, 1e-3, 0.6, 2500.0  # those of chute.toml
MU_S, MU_2, I_0 = 0.382, 0.643, 0.279
VISCOSITY_MAX = 50.0  # Pa s


def bingham_speed(y: np.ndarray) -> np.ndarray:
    """u(y) between plates at 0 and 1 m (Bird, Stewart & Lightfoot, Transport Phenomena)."""
    plug = HALF * YIELD_STRESS / STRESS_AT_WALL
    s = np.maximum(np.abs(y - HALF), plug)
    slope = STRESS_AT_WALL / HALF
    return (slope / 2 * (HALF**2 - s**2) - YIELD_STRESS * (HALF - s)) / VISCOSITY


def plates(particles: float, *overrides: str) -> Outcome:
    """The profile at the end and the mean speed of the inner half of the plug."""
    run = Running("bingham", f"particles={particles:g}", *overrides)
    state = moving(run.advance(run.scenario.time_max))
    y, u = state["position"][:, 1], state["velocity"][:, 0]
    exact = bingham_speed(y)
    inner = np.abs(y - HALF) < 0.1
    line = np.linspace(0, 1, 201)
    return Outcome(
        {
            PROFILE: Value(rms(u - exact) / rms(exact)),
            PLUG: Value(float(u[inner].mean()), float(bingham_speed(np.array(HALF)))),
        },
        [Curve("", u, y, points=True)],
        [Curve("exact", bingham_speed(line), line)],
    )


def chute_speed(z: np.ndarray, angle: float = 24.0) -> np.ndarray:
    """Bagnold's profile of mu(I) on a slope (Jop, Forterre & Pouliquen 2006), m/s."""
    theta = math.radians(angle)
    inertial = I_0 * (math.tan(theta) - MU_S) / (MU_2 - math.tan(theta))
    scale = 2 / 3 * inertial * math.sqrt(PACKING * G * math.cos(theta)) * DEPTH**1.5 / BEAD
    return scale * (1 - (1 - np.clip(z / DEPTH, 0, 1)) ** 1.5)


def chute_profile(particles: float, *overrides: str) -> tuple[np.ndarray, np.ndarray]:
    """(height, speed down the slope) at the end, means over 8 moments of its last fifth."""
    run = Running("chute", f"particles={particles:g}", *overrides)
    heights, speeds = [], []
    for state in run.sampled(np.linspace(0.8, 1, 8) * run.scenario.time_max):
        beads = moving(state)
        heights.append(beads["position"][:, 1])
        speeds.append(-beads["velocity"][:, 0])
    return np.concatenate(heights), np.concatenate(speeds)


def chute(particles: float, *overrides: str) -> Outcome:
    """The steady profile, and how the layer creeps below its angle of friction, 20.9 degrees."""
    y, u = chute_profile(particles, *overrides)
    _, slow = chute_profile(particles, "angle=20", *overrides)
    weight = PACKING * DENSITY * G * math.sin(math.radians(20))
    exact = chute_speed(y)
    top = y > 0.75 * DEPTH
    line = np.linspace(0, DEPTH, 101)
    return Outcome(
        {
            PROFILE: Value(rms(u - exact) / rms(exact)),
            SURFACE: Value(float(u[top].mean()), float(exact[top].mean())),
            CREEP: Value(float(slow.mean()), weight * DEPTH**2 / (3 * VISCOSITY_MAX)),
        },
        [Curve("", u, y, points=True)],
        [Curve("Bagnold", chute_speed(line), line)],
    )


BINGHAM = Case(
    name="bingham",
    title="Bingham's plastic between two plates",
    across="d/dp",
    resolutions=(10, 20, 40),
    run=plates,
    criteria=(
        Criterion(
            PROFILE,
            (at_most(0.08), at_most(0.04), at_most(0.02)),
            "twice the newtonian bands: a kink at the edge of the plug, and its regularisation",
        ),
        Criterion(PLUG, (within(0.08), within(0.04), within(0.02)), "as for the profile", "m/s"),
    ),
    axes=("u (m/s)", "y (m)"),
    controls=(Control("no yield stress", PLUG, lambda n: plates(n, "yield_stress=0")),),
)
CHUTE = Case(
    name="granular-chute",
    title="Dense granular flow down a chute",
    across="depth/dp",
    resolutions=(8, 16, 32),
    run=chute,
    criteria=(
        Criterion(
            PROFILE,
            (at_most(0.12), at_most(0.05), at_most(0.02)),
            "a parabola of the same surface speed is 8 % away; order 1.5 to the coarser ones",
        ),
        Criterion(SURFACE, (within(0.12), within(0.05), within(0.02)), "as for the profile", "m/s"),
        Criterion(
            CREEP,
            (within(0.1),),
            "friction holds the layer: it creeps as a liquid of viscosity_max, but for its surface",
            "m/s",
        ),
    ),
    axes=("speed (m/s)", "y (m)"),
    controls=(
        Control(
            "friction that does not grow with I",
            SURFACE,
            lambda n: chute(n, "material.beads.mu_2=0.382"),
        ),
    ),
)
CASES = (BINGHAM, CHUTE)
