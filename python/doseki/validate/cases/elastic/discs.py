"""Elastic discs, however their particles lie: head-on, off the line of centres, and spinning."""

from __future__ import annotations

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, at_most, small, within
from ...running import Running, State
from .solids import FORCE, MOMENTUM, RESTITUTION, TIME, discs, finite_elements

SPEEDS = (0.5, 1.0, 2.0)  # m/s, of approach
WAYS = 9  # to lie
SPREAD = "time between ways to lie"
SMOOTH, ROUGH, ANGULAR = "turned, smooth", "friction over normal impulse", "angular momentum lost"
CENTRE, WORST = "stress in the middle", "worst stress"
APART = 0.008  # s, when discs have parted
TURNS = 10


def ways_to_lie(particles: float, *overrides: str) -> Outcome:
    """Head-on at three speeds, each with the particles of either disc turned nine ways."""
    values: dict[str, Value] = {}
    spread: list[float] = []
    lost: list[float] = []
    curves: list[Curve] = []
    for speed in SPEEDS:
        expected = finite_elements(speed)
        runs = [_head_on(particles, speed, way, *overrides) for way in range(WAYS)]
        for quantity in (RESTITUTION, TIME, FORCE):
            mean = float(np.mean([run.values[quantity].number for run in runs]))
            values[f"{quantity}, {speed:g} m/s"] = Value(mean, expected[quantity][0])
        times = [run.values[TIME].number for run in runs]
        spread.append((max(times) - min(times)) / float(np.mean(times)))
        lost += [run.values[MOMENTUM].number for run in runs]
        curve = runs[0].curves[0]
        curves.append(Curve(f"{speed:g} m/s,", curve.x, curve.y))
    values |= {SPREAD: Value(max(spread)), MOMENTUM: Value(max(lost))}
    return Outcome(values, curves)


def _head_on(particles: float, speed: float, way: int, *overrides: str) -> Outcome:
    """The hexagons of the two discs turned by different angles."""
    left, right = 60 * way / WAYS, -37 * way / WAYS
    turned = (f"body.left.rotate={left:g}", f"body.right.rotate={right:g}")
    return discs(particles, f"speed={speed:g}", *turned, *overrides)


def oblique(particles: float, *overrides: str) -> Outcome:
    """Discs that meet off their line of centres: smooth and mirrored, and rough."""
    values: dict[str, Value] = {}
    lost: list[list[float]] = []
    for quantity, friction, mirror in ((SMOOTH, 0.0, 1), (SMOOTH, 0.0, -1), (ROUGH, None, 1)):
        chosen = [] if friction is None else [f"friction={friction:g}"]
        for name, angle in (("left", 13), ("right", 31)):
            chosen.append(f"body.{name}.rotate={mirror * angle}")
        if mirror < 0:
            chosen.append("body.left.centre=['= -0.9*radius', '= 0.5*radius']")
            chosen.append("body.right.centre=['= 0.9*radius', '= -0.5*radius']")
        run = Running("elastic-oblique", f"particles={particles:g}", *chosen, *overrides)
        turned, momenta = _turned_by(run)
        lost.append(momenta)
        if quantity == SMOOTH and SMOOTH in values:
            turned = max(abs(turned), values[SMOOTH].number)
        exact = run.constant("friction") if quantity == ROUGH else None
        values[quantity] = Value(abs(float(turned)), exact)
    worst = np.max(lost, axis=0)
    values |= {MOMENTUM: Value(float(worst[0])), ANGULAR: Value(float(worst[1]))}
    return Outcome(values)


def _turned_by(run: Running) -> tuple[float, list[float]]:
    """Impulse along the surface over that normal to it, and what is lost of both momenta."""
    before = run.state()
    after = run.advance(APART)
    left = [run.of_body(state, "left") for state in (before, after)]
    p, own = zip(*(_momenta(state) for state in left), strict=True)
    impulse = float(np.linalg.norm(p[1] - p[0]))
    along = (own[1] - own[0]) / run.constant("radius")
    whole = [_momenta(state, np.zeros(2)) for state in (before, after)]
    lost = [float(np.abs(whole[1][k] - whole[0][k]).max()) for k in (0, 1)]
    scale = impulse, impulse * run.constant("radius")
    return along / np.sqrt(impulse**2 - along**2), [lost[0] / scale[0], lost[1] / scale[1]]


def _momenta(state: State, about: np.ndarray | None = None) -> tuple[np.ndarray, float]:
    """Momentum, and angular momentum about a point, or about the centre and in its frame."""
    x, v, m = state["position"], state["velocity"], state["mass"]
    centre = m @ x / m.sum() if about is None else about
    frame = m @ v / m.sum() if about is None else np.zeros(2)
    arm, own = x - centre, v - frame
    return m @ v, float(m @ (arm[:, 0] * own[:, 1] - arm[:, 1] * own[:, 0]))


def spinning(particles: float, *overrides: str) -> Outcome:
    """Radial and hoop stress of every particle in the last of ten turns against the closed form."""
    run = Running("elastic-spin", f"particles={particles:g}", *overrides)
    R, spin, ratio = run.constant("radius"), run.constant("spin"), 0.3
    _, start = _momenta(run.state(), np.zeros(2))
    turn = 2 * np.pi / spin
    times = turn * (TURNS - 1 + np.arange(1, 21) / 20)
    states = [run.of_body(state, "disc") for state in run.sampled(times)]
    measured = np.mean([_polar(state) for state in states], axis=0)
    r = np.mean([np.linalg.norm(state["position"], axis=1) for state in states], axis=0)
    scale = 1000 * (spin * R) ** 2 / (8 * (1 - ratio))
    exact = scale * np.column_stack(
        [(3 - 2 * ratio) * (1 - (r / R) ** 2), 3 - 2 * ratio - (1 + 2 * ratio) * (r / R) ** 2]
    )
    middle, order = r.argmin(), np.argsort(r)
    _, end = _momenta(states[-1], np.zeros(2))
    return Outcome(
        {
            CENTRE: Value(float(measured[middle].mean()), float(exact[middle].mean())),
            WORST: Value(float(np.abs(measured - exact).max() / exact[middle].mean())),
            ANGULAR: Value(abs(end / start - 1)),
        },
        [
            Curve("radial,", r[order] / R, measured[order, 0]),
            Curve("hoop,", r[order] / R, measured[order, 1]),
        ],
        [
            Curve("radial, exact", r[order] / R, exact[order, 0]),
            Curve("hoop, exact", r[order] / R, exact[order, 1]),
        ],
    )


def _polar(state: State) -> np.ndarray:
    """Radial and hoop stress (n, 2); in the very middle, where there is no radius, of x and y."""
    x, stress = state["position"], state["stress"]
    r = np.linalg.norm(x, axis=1)
    n = np.where((r > 1e-6)[:, None], x / np.maximum(r, 1e-6)[:, None], [1.0, 0.0])
    t = np.stack([-n[:, 1], n[:, 0]], axis=1)
    return np.stack([np.einsum("ni,nij,nj->n", a, stress[:, :2, :2], a) for a in (n, t)], axis=1)


TURNED = Case(
    name="elastic-discs-turned",
    title="Elastic discs meet head-on, however their particles lie",
    across="d/dp",
    resolutions=(10, 20, 40),
    run=ways_to_lie,
    criteria=(
        *(
            Criterion(f"{quantity}, {speed:g} m/s", bands, reason, unit)
            for speed in SPEEDS
            for quantity, bands, reason, unit in (
                (RESTITUTION, (within(0.01),), "1 % of finite elements", ""),
                (TIME, (within(0.03), within(0.02), within(0.02)), "2 % at 20 across", "s"),
                (FORCE, (within(0.08), within(0.03), within(0.03)), "3 % at 20 across", "N/m"),
            )
        ),
        Criterion(
            SPREAD,
            (at_most(0.015), at_most(0.0055), at_most(0.0055)),
            "0.5 % at 20 across; a sample of time is 0.26 %",
        ),
        Criterion(MOMENTUM, (small(1e-12),), "equal and opposite forces"),
    ),
    axes=("time (s)", "force (N/m)"),
    controls=(
        Control("half as stiff again", f"{TIME}, 1 m/s", lambda n: ways_to_lie(n, "young=1.5e7")),
    ),
)
OBLIQUE = Case(
    name="elastic-oblique",
    title="Elastic discs meet off their line of centres",
    across="d/dp",
    resolutions=(10, 20, 40),
    run=oblique,
    criteria=(
        Criterion(
            SMOOTH,
            (at_most(0.02), at_most(0.005), at_most(0.005)),
            "0.5 % of the normal impulse at 20 across, as it is and mirrored",
        ),
        Criterion(ROUGH, (within(0.05), within(0.03), within(0.03)), "they slide: the coefficient"),
        Criterion(MOMENTUM, (small(1e-12),), "equal and opposite forces"),
        Criterion(ANGULAR, (small(1e-12),), "with one line of action"),
    ),
    axes=("", ""),
    controls=(Control("a friction of 0.02", SMOOTH, lambda n: oblique(n, "friction=0.02")),),
)
SPIN = Case(
    name="elastic-spin",
    title="An elastic disc spins ten times",
    across="d/dp",
    resolutions=(10, 20, 40),
    run=spinning,
    criteria=(
        Criterion(CENTRE, (within(0.05), within(0.02), within(0.02)), "closed form", "Pa"),
        Criterion(
            WORST,
            (at_most(0.1), at_most(0.05), at_most(0.03)),
            "of all particles, over that in the middle: of first order at the surface",
        ),
        Criterion(ANGULAR, (small(1e-11),), "nothing turns it"),
    ),
    axes=("r / R", "stress (Pa)"),
    controls=(Control("nu = 0", CENTRE, lambda n: spinning(n, "poisson=0")),),
)
CASES = (TURNED, OBLIQUE, SPIN)
