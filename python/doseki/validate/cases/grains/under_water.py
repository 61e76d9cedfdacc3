"""A block on a bed under water: its uplift, the depth at which it floats, its friction."""

from __future__ import annotations

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, within
from ...running import Running

UPLIFT, FLOATS, FRICTION = "uplift", "depth at which it floats", "friction on a tilted bed"
ON_TERRAIN, FALLEN = "uplift on a terrain", "uplift after a fall"
TANK, TERRAIN, BALL = "block-under-water", "block-on-terrain", "ball-under-water"  # scenarios
UPLIFT_IN = {TANK: UPLIFT, TERRAIN: ON_TERRAIN}
WATER, STONE = 1000.0, 2000.0  # kg/m3
SIDE = 0.1  # m, of the block
SUBMERGED, SHALLOW = 1.5, 0.75  # depth of the water over the side of the block: whole rows at 16
NO_FILM = "uplift=false"
SHIFTS = 0.0, 0.25, 0.5  # of a ball against the lattice of the water, spacings
DEEP = 2.0  # depth of the water over the diameter of a ball, or the side of a block that falls
FALL = 0.3  # height over the side of a block
SLOPE, COEFFICIENT = 25.0, 0.3  # degrees; the block slides
PLACES = 1.3 * SIDE, 1.5 * SIDE, 1.7 * SIDE  # of its middle at the start, m
SETTLED, SAMPLES = 0.5, 60  # share of a run after which the film has its pressure


def block(across: float, *overrides: str) -> Outcome:
    """The forces of water on a block that stands in it, and of the bed on one that slides."""
    deep, shallow = lifted(across, SUBMERGED, *overrides), lifted(across, SHALLOW, *overrides)
    values = {
        UPLIFT: deep.values[UPLIFT],
        # Water of this depth carries what that of the second one weighs.
        FLOATS: Value(SHALLOW, SHALLOW * shallow.values[UPLIFT].number),
        FRICTION: Value(sliding(across, *overrides), 1.0),
        **lifted(across, SUBMERGED, *overrides, name=TERRAIN).values,
        **fallen(across, *overrides).values,
    }
    times = deep.curves[0].x
    archimedes = Curve("Archimedes", times, np.ones(len(times)))
    return Outcome(values, [*deep.curves, *shallow.curves], [archimedes])


def lifted(across: float, depth: float, *overrides: str, name: str = TANK) -> Outcome:
    """The late uplift in water of one depth, in the scenario of this name."""
    times, upward = standing(across, depth, *overrides, name=name)
    curve = Curve(f"{depth:g} deep", times, upward)
    return Outcome({UPLIFT_IN[name]: Value(late(times, upward), 1.0)}, [curve])


def fallen(across: float, *overrides: str) -> Outcome:
    """The late uplift of a block that has caught particles between itself and the bed."""
    given = f"fall={FALL * SIDE:g}", "time_max=1.0"
    return Outcome({FALLEN: lifted(across, DEEP, *given, *overrides).values[UPLIFT]})


def ball(across: float, *overrides: str) -> Outcome:
    """The late uplift of a disc (3-D: a sphere), the mean over places on the lattice."""
    curves = []
    for shift in SHIFTS:
        found = standing(across, DEEP, f"shift={shift:g}", *overrides, name=BALL)
        curves.append(Curve(f"{shift:g} spacings aside", *found))
    mean = float(np.mean([late(curve.x, curve.y) for curve in curves]))
    return Outcome({UPLIFT: Value(mean, 1.0)}, curves)


def late(times: np.ndarray, upward: np.ndarray) -> float:
    """The mean once the film has its pressure."""
    return float(upward[times > SETTLED * times[-1]].mean())


def rubbed(across: float, *overrides: str) -> Outcome:
    """The friction alone."""
    return Outcome({FRICTION: Value(sliding(across, *overrides), 1.0)})


def standing(
    across: float, depth: float, *overrides: str, name: str = TANK
) -> tuple[np.ndarray, np.ndarray]:
    """Times, and the upward force of the water over the weight of what the block displaces."""
    given = f"across={across:g}", f"side={SIDE:g}", f"depth={depth * SIDE:g}"
    run = Running(name, *given, *overrides)
    gravity = np.asarray(run.scenario.gravity)
    displaced = WATER * volume(name, run.scenario.dim) * min(depth, 1.0)
    times = np.linspace(0, run.scenario.time_max, SAMPLES + 1)[1:]
    force = np.array([flow_force(run, time) for time in times])
    return times, -(force @ gravity) / (displaced * float(gravity @ gravity))


def volume(name: str, dim: int) -> float:
    """Of the body in the scenario of this name, m3 (2-D: m2)."""
    return SIDE**dim * (np.pi / (4 if dim == 2 else 6) if name == BALL else 1.0)


def on_terrain_without_film(across: float) -> Outcome:
    """What water does that is not between faces."""
    return lifted(across, SUBMERGED, NO_FILM, name=TERRAIN)


def sliding(across: float, *overrides: str) -> float:
    """Friction of a block that slides under water, over that of its submerged weight.

    The mean over places on the lattice, which scatter by some per cent: sound goes to and fro.
    """
    return float(np.mean([rubbing(across, f"place={place:g}", *overrides) for place in PLACES]))


def rubbing(across: float, *overrides: str) -> float:
    """The friction from the motion: what momentum, weight and water leave for the contact."""
    tilted = f"tilt={SLOPE:g}", f"friction={COEFFICIENT:g}", f"density={STONE:g}"
    run = Running(TANK, f"across={across:g}", f"side={SIDE:g}", *tilted, *overrides)
    size, gravity = volume(TANK, run.scenario.dim), np.asarray(run.scenario.gravity)
    times = np.linspace(SETTLED * run.scenario.time_max, run.scenario.time_max, SAMPLES)
    run.advance(times[0])
    start = moving_body(run, "velocity")
    water = np.mean([flow_force(run, time) for time in times[1:]], axis=0)
    rate = STONE * size * (moving_body(run, "velocity") - start) / (times[-1] - times[0])
    contact = rate - STONE * size * gravity - water
    return float(-contact[0] / (COEFFICIENT * (WATER - STONE) * size * gravity[-1]))


def flow_force(run: Running, time: float) -> np.ndarray:
    """Force of the water on the block at `time`, N (2-D: N/m)."""
    run.advance(time)
    return moving_body(run, "flow_force")


def moving_body(run: Running, field: str) -> np.ndarray:
    """A field of the one body that moves."""
    grains = run.grains()
    return np.array(grains[field][~grains["fixed"]][0])


UNDER_WATER = Case(
    name="grains-under-water",
    title="A block on a bed under water",
    across="side/dp",
    resolutions=(16, 24, 32),
    run=block,
    criteria=(
        Criterion(UPLIFT, (within(0.03),), "Archimedes, though no particle fits under the block"),
        Criterion(FLOATS, (within(0.03),), "Archimedes: its draught, over the side", unit=""),
        Criterion(
            FRICTION,
            (within(0.03),),
            "that of its submerged weight; as it slides, water lifts it by some per cent",
        ),
        Criterion(
            FALLEN,
            (within(0.05),),
            "Archimedes: the particles that it has caught do not bear it; the water still swings",
        ),
        Criterion(ON_TERRAIN, (within(0.03),), "Archimedes again: its walls are made for the flow"),
    ),
    axes=("time (s)", "upward force / weight of water displaced"),
    controls=(
        Control("no water between faces", UPLIFT, lambda n: lifted(n, SUBMERGED, NO_FILM)),
        Control("no water between faces", FRICTION, lambda n: rubbed(n, NO_FILM)),
        Control("no water between faces", FALLEN, lambda n: fallen(n, NO_FILM)),
        Control("no water between faces", ON_TERRAIN, on_terrain_without_film),
    ),
)
BALL_UNDER_WATER = Case(
    name="ball-under-water",
    title="A ball on a bed under water",
    across="d/dp",
    resolutions=(4, 8, 16),
    run=ball,
    criteria=(Criterion(UPLIFT, (within(0.05),), "Archimedes: water sees all but where it lies"),),
    axes=("time (s)", "upward force / weight of water displaced"),
    controls=(Control("no water between faces", UPLIFT, lambda n: ball(n, NO_FILM)),),
)
CASES = UNDER_WATER, BALL_UNDER_WATER
