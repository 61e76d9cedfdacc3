"""A cube that a stream takes along knows no direction but its own and that of the stream."""

from __future__ import annotations

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, small, within
from ...running import Running

ACROSS = "sideways over forward"
ALONG = "forward, other sides"
TURNED, ASIDE = "forward, all turned by 30 degrees", "sideways over forward, all turned"
SPEED = 0.5  # m/s
AXES = (*np.eye(3), *-np.eye(3)[:1])


def drift(across: float) -> Outcome:
    """The speed that the cube gets in streams onto some of its sides, and with both turned."""
    curves = [_speeds(across, SPEED * axis) for axis in AXES]
    forward = np.array([speed[-1] @ axis for axis, (_, speed) in zip(AXES, curves, strict=True)])
    late = np.array([speed[-1] for _, speed in curves])
    sideways = np.abs(late - forward[:, None] * np.array(AXES)).max()
    angle = np.radians(30)
    along = np.array([np.cos(angle), np.sin(angle), 0])
    turned = _speeds(across, SPEED * along, 30)[1][-1]
    aside = float(np.linalg.norm(turned - (turned @ along) * along))
    times, speed = curves[0]
    return Outcome(
        {
            ACROSS: Value(float(sideways / forward[0])),
            ALONG: Value(float(np.abs(forward / forward[0] - 1).max())),
            TURNED: Value(float(turned @ along), float(forward[0])),
            ASIDE: Value(aside / float(turned @ along)),
        },
        [Curve("", times, speed[:, 0])],
    )


def askew(across: float) -> Outcome:
    """The cube alone is turned."""
    speed = _speeds(across, np.array([SPEED, 0, 0]), 20)[1][-1]
    return Outcome({ACROSS: Value(float(np.abs(speed[1:]).max() / speed[0]))})


def _speeds(across: float, stream: np.ndarray, turn: float = 0) -> tuple[np.ndarray, np.ndarray]:
    """Times, and the velocity of the cube at them."""
    parts = [f"stream_{axis}={part:.17g}" for axis, part in zip("xyz", stream, strict=True)]
    run = Running("cube-stream", f"across={across:g}", f"turn={turn:g}", *parts)
    times = np.linspace(0, run.scenario.time_max, 11)[1:]
    speed = []
    for time in times:
        run.advance(time)
        speed.append(run.grains()["velocity"][0])
    return times, np.array(speed)


CASE = Case(
    name="grains-stream",
    title="A cube in streams from all sides",
    across="side/dp",
    resolutions=(6, 8, 12),
    run=drift,
    criteria=(
        Criterion(ACROSS, (small(1e-9),), "nothing pushes it sideways but rounding"),
        Criterion(ALONG, (small(1e-9),), "its sides are alike but for rounding"),
        Criterion(
            TURNED,
            (within(0.1), within(0.07), within(0.05)),
            "the lattice on which the water starts does not turn: the error of the scheme",
            unit="m/s",
        ),
        Criterion(ASIDE, (small(0.05), small(0.04), small(0.03)), "the same"),
    ),
    axes=("time (s)", "speed (m/s)"),
    controls=(Control("a cube askew to its stream", ACROSS, askew),),
)
CASES = (CASE,)
