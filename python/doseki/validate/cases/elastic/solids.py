"""Elastic bodies by themselves: plates and beams that swing, discs that meet or are squeezed."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ....solver.build import load_core
from ...case import Band, Case, Control, Criterion, Curve, Outcome, Value, at_most, small, within
from ...estimators import crossings
from ...reference import read_columns
from ...running import Running, State

PERIOD, LIMIT, LOSS, GAP = "period", "period, extrapolated", "loss in a period", "widest gap / dp"
PLATE_PERIOD = 0.2552  # s: plane-strain finite elements of nine nodes, held at the face
SWINGS = 20.5
FREQUENCY, LOWEST = "frequency", "lowest place of the tip"
RESTITUTION, TIME, FORCE, MOMENTUM = "restitution", "time of contact", "force", "momentum gained"
TENSION, PRESSURE = "tension in the middle", "pressure in the middle"
STRESS, NORM = "stress after a turn", "norm after a turn"
SAMPLE = 1e-5  # s, of the force between discs
DISC_SPEED = 1.0  # m/s, at which they meet


def tip_of(run: Running, body: str, end: tuple[float, float]) -> np.ndarray:
    """The particles of a body nearest to its free end."""
    position = run.of_body(run.state(), body)["position"]
    distance = np.linalg.norm(position - np.asarray(end), axis=1)
    return np.flatnonzero(distance < distance.min() + 1e-9)


def heights(run: Running, body: str, tip: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Mean height of these particles at times."""
    states = (run.of_body(state, body) for state in run.sampled(times))
    return np.array([state["position"][tip, 1].mean() for state in states])


def swing(
    particles: float, periods: float, *overrides: str
) -> tuple[np.ndarray, np.ndarray, Running]:
    """Times and heights of the tip of the plate."""
    run = Running("elastic-plate", f"particles={particles:g}", *overrides)
    tip = tip_of(run, "plate", (run.constant("length"), 0.0))
    times = np.linspace(0, periods * PLATE_PERIOD, round(100 * periods) + 1)[1:]
    return times, heights(run, "plate", tip, times), run


def period_of(times: np.ndarray, values: np.ndarray) -> float:
    """Of something that starts from zero, from its last crossing of zero."""
    zeros = crossings(times, values)
    return float(2 * zeros[-1] / len(zeros)) if len(zeros) else float("nan")


def plate(particles: float, *overrides: str) -> Outcome:
    """The plate, and its period extrapolated from half as many particles.

    A clamp holds the middles of particles, so that the free length is half a spacing too long.
    """
    times, tip, _ = swing(particles, 2.2, *overrides)
    coarse = period_of(*swing(particles / 2, 2.2, *overrides)[:2])
    period = period_of(times, tip)
    return Outcome(
        {
            PERIOD: Value(period, PLATE_PERIOD),
            LIMIT: Value(2 * period - coarse, PLATE_PERIOD),
            LOSS: Value(float(1 - tip[times > period].max() / tip[times <= period].max())),
        },
        [Curve("", times, tip)],
    )


def strong_swing(particles: float, *overrides: str) -> Outcome:
    """Twenty wide swings: whether the plate stays in one piece and keeps its amplitude."""
    times, tip, run = swing(particles, SWINGS, "speed=0.05", *overrides)
    period = period_of(times, tip)
    first, last = tip[times < period].max(), tip[times > times[-1] - period].max()
    return Outcome(
        {
            PERIOD: Value(period, PLATE_PERIOD),
            LOSS: Value(float(1 - (last / first) ** (1 / (SWINGS - 1)))),
            GAP: Value(widest_gap(run.state(), run.scenario.dp)),
        },
        [Curve("", times, tip)],
    )


def widest_gap(state: State, dp: float) -> float:
    """Greatest distance of a particle to the third nearest other one, in spacings."""
    x = state["position"]
    return float(cKDTree(x).query(x, k=4)[0].max() / dp)


def beam(particles: float, *overrides: str) -> Outcome:
    """CSM3: the first two times that the tip is lowest."""
    run = Running("elastic-beam", f"particles={particles:g}", *overrides)
    tip = tip_of(run, "beam", (0.6, 0.2))
    times = np.arange(1, 331) * 0.005
    sag = heights(run, "beam", tip, times) - 0.2
    low = [k for k in range(1, len(sag) - 1) if sag[k - 1] > sag[k] <= sag[k + 1]]
    first, second = (vertex(times[k - 1 : k + 2], sag[k - 1 : k + 2]) for k in low[:2])
    return Outcome(
        {
            FREQUENCY: Value(1 / (second[0] - first[0]), 1.0995),
            LOWEST: Value(first[1], -0.063607 - 0.065160),
        },
        [Curve("", times, sag)],
    )


def vertex(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Of the parabola through three points."""
    a, b, c = np.polyfit(x - x[1], y, 2)
    return float(x[1] - b / (2 * a)), float(c - b * b / (4 * a))


def finite_elements(speed: float) -> dict[str, tuple[float, float]]:
    """The impact of two discs by finite elements: each quantity, and how far it may be off."""
    row = {row[0]: row[1:] for row in read_columns("elastic-discs.csv").T}[speed]
    pairs = [(float(value), float(doubt)) for value, doubt in row.reshape(-1, 2)]
    return dict(zip((RESTITUTION, TIME, FORCE), pairs, strict=True))


def beside_elements(quantity: str, *tolerances: float) -> tuple[Band, ...]:
    """Bands about the finite elements, widened by their own uncertainty."""
    value, doubt = finite_elements(DISC_SPEED)[quantity]
    return tuple(within(tolerance + doubt / value) for tolerance in tolerances)


def discs(particles: float, *overrides: str) -> Outcome:
    """Two discs until they are apart: what their contact was like."""
    run = Running("elastic-discs", f"particles={particles:g}", *overrides)
    times = np.arange(0, 701) * SAMPLE
    momenta = np.array([momenta_of(run, state) for state in run.sampled(times)])
    along = momenta[:, 0, 0]
    force, middle = -np.diff(along) / SAMPLE, times[1:] - SAMPLE / 2
    smooth = np.convolve(force, np.ones(5) / 5, "same")
    touching = middle[force > 1e-6 * force.max()]
    expected = finite_elements(run.constant("speed"))
    return Outcome(
        {
            RESTITUTION: Value(float(-along[-1] / along[0]), expected[RESTITUTION][0]),
            TIME: Value(float(touching[-1] - touching[0]), expected[TIME][0]),
            FORCE: Value(float(smooth.max()), expected[FORCE][0]),
            MOMENTUM: Value(float(np.abs(momenta.sum(axis=1)).max() / along[0])),
        },
        [Curve("", middle, smooth)],
    )


def momenta_of(run: Running, state: State) -> list[np.ndarray]:
    """Of the two discs, kg/s."""
    bodies = (run.of_body(state, name) for name in ("left", "right"))
    return [body["mass"] @ body["velocity"] for body in bodies]


def squeezed(particles: float, *overrides: str) -> Outcome:
    """The stress in the middle of the disc against Hertz's field, within a fifth of the radius."""
    run = Running("brazilian-disc", f"particles={particles:g}", *overrides)
    R = run.constant("radius")
    rest = run.of_body(run.state(), "disc")["position"]
    state = run.of_body(run.advance(run.scenario.time_max), "disc")
    P = float(np.abs(np.asarray(run.simulation.grains()["contact_force"])[:, 0]).mean())
    middle = np.hypot(*rest.T) < 0.2 * R
    exact = hertz_field(rest[middle], R, P).mean(axis=0)
    row = np.abs(rest[:, 1]) < 0.3 * run.scenario.dp
    order = np.argsort(rest[row, 0])
    line = np.column_stack([np.linspace(-0.8 * R, 0.8 * R, 81), np.zeros(81)])
    return Outcome(
        {
            TENSION: Value(float(state["stress"][middle, 1, 1].mean()), float(exact[1])),
            PRESSURE: Value(float(-state["stress"][middle, 0, 0].mean()), float(-exact[0])),
        },
        [Curve("", rest[row][order, 0] / R, state["stress"][row][order, 1, 1] * np.pi * R / P)],
        [Curve("exact", line[:, 0] / R, hertz_field(line, R, P)[:, 1] * np.pi * R / P)],
    )


def hertz_field(position: np.ndarray, R: float, P: float) -> np.ndarray:
    """Stresses (n, 2), Pa, along and across the line of two opposite forces P on a disc.

    Timoshenko and Goodier, Theory of Elasticity, section 41.
    """
    x, y = position.T
    along = across = P / (np.pi * R)
    for ahead in (R - x, R + x):
        fourth = (ahead**2 + y**2) ** 2
        along = along - 2 * P / np.pi * ahead**3 / fourth
        across = across - 2 * P / np.pi * ahead * y**2 / fourth
    return np.column_stack([along, across])


def turned(steps: float, sense: float = 1.0) -> Outcome:
    """The stress rate of the scheme ueta2022 through a whole turn of S = diag(1, -1).

    As the scheme integrates: with the rate of the predicted stress at both ends of a step.
    """
    rate_of, dt = load_core().physics.two.elastic_stress_rate, 2 * np.pi / steps
    spin = [0.0, -sense, sense, 0.0]

    def rate(S: np.ndarray) -> np.ndarray:
        columns = [[value] for value in (*spin, *S, 1.0)]
        return np.array(rate_of(columns))[:, 0]

    S, history = np.array([1.0, -1.0, 0.0]), []
    for _ in range(round(steps)):
        first = rate(S)
        S = S + 0.5 * dt * (first + rate(S + dt * first))
        history.append(S)
    angle = 2 * np.pi * np.arange(1, round(steps) + 1) / steps
    exact = np.column_stack([np.cos(2 * angle), -np.cos(2 * angle), np.sin(2 * angle)])
    track = np.array(history)
    return Outcome(
        {
            STRESS: Value(float(np.abs(track - exact).max())),
            NORM: Value(float(np.hypot(S[0], S[2]) - 1)),
        },
        [Curve("", angle, track[:, 2])],
        [Curve("exact", angle, exact[:, 2])],
    )


def turned_back(steps: float) -> Outcome:
    """The turn the other way, compared with the right one."""
    wrong, right = turned(steps, -1.0), turned(steps)
    gap = float(np.abs(wrong.curves[0].y - right.reference[0].y).max())
    return Outcome({STRESS: Value(gap)})


PLATE = Case(
    name="elastic-plate",
    title="A clamped elastic plate swings",
    across="H/dp",
    resolutions=(10, 20, 40),
    run=plate,
    criteria=(
        Criterion(
            PERIOD,
            (within(0.03), within(0.015), within(0.015)),
            "1.5 % at 20 layers; thin-plate theory itself misses the finite elements by 0.5 %",
            "s",
        ),
        Criterion(
            LIMIT,
            (within(0.015), within(0.005), within(0.005)),
            "0.5 %: the clamp's half spacing is of first order and goes",
            "s",
        ),
        Criterion(LOSS, (small(0.02),), "2 %: free swings of an elastic body"),
    ),
    axes=("time (s)", "height of the tip (m)"),
    controls=(Control("nu = 0.3, 4 % slower", PERIOD, lambda n: plate(n, "poisson=0.3")),),
)
STRONG = Case(
    name="elastic-plate-wide",
    title="Twenty wide swings of a clamped plate",
    across="H/dp",
    resolutions=(5, 10, 20),
    run=strong_swing,
    criteria=(
        Criterion(
            PERIOD,
            (within(0.06), within(0.03), within(0.03)),
            "the clamp's half spacing, and bending",
        ),
        Criterion(LOSS, (small(0.02),), "2 % in a period"),
        Criterion(GAP, (at_most(1.7),), "no crack: at a corner it is 1.41, and strain is 10 %"),
    ),
    axes=("time (s)", "height of the tip (m)"),
    controls=(Control("a fifth softer", PERIOD, lambda n: strong_swing(n, "young=1.6e6")),),
)
BEAM = Case(
    name="elastic-beam",
    title="CSM3: an elastic beam behind a cylinder",
    across="H/dp",
    resolutions=(10, 20, 40),
    run=beam,
    criteria=(
        Criterion(
            FREQUENCY,
            (within(0.02), within(0.01), within(0.01)),
            "1 % of Turek and Hron's finite elements",
            "Hz",
            short="the clamp on the cylinder gives way by half a spacing",
        ),
        Criterion(
            LOWEST,
            (within(0.04), within(0.03), within(0.03)),
            "goes with the square of the period",
            "m",
        ),
    ),
    axes=("time (s)", "height of the tip (m)"),
    controls=(Control("a fifth softer", FREQUENCY, lambda n: beam(n, "shear=0.4e6")),),
)
DISCS = Case(
    name="elastic-discs",
    title="Two elastic discs meet head-on",
    across="d/dp",
    resolutions=(10, 20, 40),
    run=discs,
    criteria=(
        Criterion(
            RESTITUTION,
            beside_elements(RESTITUTION, 0.03, 0.02, 0.0102),
            "0.01 of finite elements that meet without a penalty: the rest goes into waves",
        ),
        Criterion(TIME, beside_elements(TIME, 0.1, 0.06, 0.03), "the same; 10 % at 10 across", "s"),
        Criterion(FORCE, beside_elements(FORCE, 0.1, 0.1, 0.05), "the same", "N/m"),
        Criterion(MOMENTUM, (small(1e-12),), "equal and opposite forces"),
    ),
    axes=("time (s)", "force (N/m)"),
    controls=(Control("half as stiff again", TIME, lambda n: discs(n, "young=1.5e7")),),
)
BRAZILIAN = Case(
    name="brazilian-disc",
    title="An elastic disc is squeezed between two plates",
    across="d/dp",
    resolutions=(20, 40, 80),
    run=squeezed,
    criteria=(
        Criterion(
            TENSION, (within(0.03),), "3 % of P/(pi R); others take 10 % with 15 to a radius", "Pa"
        ),
        Criterion(PRESSURE, (within(0.03),), "3 % of 3P/(pi R)", "Pa"),
    ),
    axes=("x / R", "tension pi R / P"),
    controls=(
        Control(
            "shut at once, it rings",
            TENSION,
            lambda n: squeezed(n, "body.disc.damping=0.02", "closing=0.0005"),
        ),
    ),
)
TURNED = Case(
    name="stress-rotation",
    title="The stress of a solid turns with it",
    across="steps to a turn",
    resolutions=(800, 1600, 3200),
    run=turned,
    criteria=(
        Criterion(
            STRESS,
            (small(1e-3),),
            "1e-3 after a turn, of S = diag(1, -1), and second order in the step",
            order=1.9,
        ),
        Criterion(NORM, (small(1e-3),), "a turn does no work"),
    ),
    axes=("angle", "S_xy"),
    controls=(Control("the velocity gradient transposed", STRESS, turned_back),),
)


CASES = (PLATE, STRONG, BEAM, DISCS, BRAZILIAN, TURNED)
