"""Slabs and blocks on Voellmy's bed: acceleration, terminal speed, and rest, eqs. (92) and (93)."""

from __future__ import annotations

import math

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, at_most, within
from ...running import Running, State, moving

G = 9.81
DEPTH, ANGLE = 0.2, math.radians(25)  # those of voellmy-slab.toml
MU, PORE, XI = 0.3, 0.4, 100.0
GAIN, BURIED = "acceleration", "acceleration with pore pressure"
TERMINAL, HELD = "terminal speed", "way at rest / dp"
TURNED, HELD_TURNED = "acceleration on a turned bed", "way at rest on a turned bed / dp"
# Rest: a bed of 15 degrees, whose tangent is 0.268, under a block that would creep by itself.
REST = ("angle=15", "speed=1", "stiffness== 25*particles**2")


def pull(mu: float) -> float:
    """Acceleration of what slides under Coulomb's friction, m/s2."""
    return G * (math.sin(ANGLE) - mu * math.cos(ANGLE))


def mean(state: State, key: str) -> np.ndarray:
    """Mean of a field over what moves, weighted with mass."""
    body = moving(state)
    return np.asarray(np.average(body[key], axis=0, weights=body["mass"]))


def down(run: Running) -> np.ndarray:
    """Unit vector down the bed."""
    turned = math.radians(run.scenario.constants.get("turned", 0.0))
    return -np.array([math.cos(turned), math.sin(turned)])


def accelerated(name: str, particles: float, *overrides: str) -> tuple[float, Curve]:
    """Acceleration down the bed between 0.1 s, when the start has rung out, and 0.6 s."""
    run = Running(name, f"particles={particles:g}", *overrides)
    times = np.linspace(0.1, 0.6, 11)
    speeds = np.array([mean(state, "velocity") @ down(run) for state in run.sampled(times)])
    return float(np.polyfit(times, speeds, 1)[0]), Curve("", times, speeds)


def way(name: str, particles: float, *overrides: str) -> float:
    """How far down the bed the centre of mass goes in a second, over dp; it starts at rest."""
    run = Running(name, f"particles={particles:g}", *REST, *overrides)
    start = mean(run.state(), "position")
    return float((mean(run.advance(1.0), "position") - start) @ down(run)) / run.scenario.dp


def terminal(particles: float, *overrides: str) -> float:
    """Speed of the slab after many times sqrt(xi h)/g."""
    setting = (f"turbulent={XI}", "time_max=8", "speed=2.5", *overrides)
    run = Running("voellmy-slab", f"particles={particles:g}", *setting)
    return float(mean(run.advance(8.0), "velocity") @ down(run))


def slab(particles: float, *overrides: str) -> Outcome:
    """The endless slab."""
    gain, curve = accelerated("voellmy-slab", particles, *overrides)
    buried, _ = accelerated("voellmy-slab", particles, f"pore={PORE}", *overrides)
    exact = pull(MU)
    return Outcome(
        {
            GAIN: Value(gain, exact),
            BURIED: Value(buried, pull((1 - PORE) * MU)),
            TERMINAL: Value(terminal(particles, *overrides), math.sqrt(XI * DEPTH * exact / G)),
            HELD: Value(way("voellmy-slab", particles, *overrides)),
        },
        [curve],
        [Curve("g (sin - mu cos) t", curve.x, exact * curve.x)],
    )


def block(particles: float, *overrides: str) -> Outcome:
    """A block with ends, on a bed along x and on one that is turned."""
    gain, curve = accelerated("voellmy-block", particles, *overrides)
    turned, _ = accelerated("voellmy-block", particles, "turned=25", *overrides)
    exact = pull(MU)
    return Outcome(
        {
            GAIN: Value(gain, exact),
            TURNED: Value(turned, exact),
            HELD: Value(way("voellmy-block", particles, *overrides)),
            HELD_TURNED: Value(way("voellmy-block", particles, "turned=15", *overrides)),
        },
        [curve],
        [Curve("g (sin - mu cos) t", curve.x, exact * curve.x)],
    )


AT_REST = "a spring holds what does not slide; the rest is its own creep as a stiff liquid"
NO_FRICTION = "friction=0"
SLAB = Case(
    name="voellmy-slab",
    title="Endless slab on Voellmy's bed",
    across="depth/dp",
    resolutions=(4, 6, 8),
    run=slab,
    criteria=(
        Criterion(GAIN, (within(0.02),), "friction of the whole weight, whatever dp is", "m/s2"),
        Criterion(BURIED, (within(0.02),), "Coulomb's friction of the effective stress", "m/s2"),
        Criterion(TERMINAL, (within(0.03),), "the square of it is what balances", "m/s"),
        Criterion(HELD, (at_most(0.1),), AT_REST),
    ),
    axes=("time (s)", "mean speed (m/s)"),
    controls=(Control("mu = 0", GAIN, lambda n: slab(n, NO_FRICTION)),),
)
BLOCK = Case(
    name="voellmy-block",
    title="Block on Voellmy's bed",
    across="height/dp",
    resolutions=(4, 6, 8),
    run=block,
    criteria=(
        Criterion(GAIN, (within(0.02),), "friction of the whole weight, ends and all", "m/s2"),
        Criterion(TURNED, (within(0.02),), "no direction is preferred", "m/s2"),
        Criterion(HELD, (at_most(0.1),), AT_REST),
        Criterion(HELD_TURNED, (at_most(0.1),), AT_REST),
    ),
    axes=("time (s)", "mean speed (m/s)"),
    controls=(Control("mu = 0", HELD_TURNED, lambda n: block(n, NO_FRICTION)),),
)
CASES = (SLAB, BLOCK)
