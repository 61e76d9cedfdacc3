"""What cracks, damping and motion of a body that breaks have adds up to what it had; 2-D."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.materials import ELASTIC_DEFAULTS

from .breaking import GRANITE, LEDGER, ROCK, Bar, bodies_of, pieces
from .conftest import lattice

FLAWS = {"fracture": "grady_kipp", "weibull_k": 5e34, "weibull_m": 8.5}
SPEED = 4.0  # m/s, of either end


def flying(core, angle: float = 0.0, **material):
    """A notched bar without clamps, whose ends fly apart; it breaks in the middle."""
    bar = Bar(core, across=8, rows_cut=1)
    turn = np.radians(angle)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    none = np.zeros(len(bar.points), bool)
    spacing = bar.width / 8
    table = GRANITE | {"poisson_ratio": 0.0} | material
    bodies = bodies_of(core, bar.points @ matrix.T, spacing, none, **table)
    along = np.zeros_like(bar.points)
    along[:, 0] = 2 * SPEED * bar.points[:, 0] / bar.length
    bodies.set_velocity(np.ascontiguousarray(along @ matrix.T))
    return bodies


def rows(bodies, count=40, time=1e-6):
    """Each part of the energy over time (count + 1, parts), J/m."""
    found = [[bodies.state()[key] for key in LEDGER]]
    for _ in range(count):
        bodies.advance(time)
        found.append([bodies.state()[key] for key in LEDGER])
    return np.array(found)


def gap(parts, *left_out):
    """How far the sum goes from that of the start, over it."""
    kept = [k for k, name in enumerate(LEDGER) if name not in left_out]
    total = parts[:, kept].sum(axis=1)
    return np.abs(total - total[0]).max() / parts[0].sum()


@pytest.mark.parametrize("angle", [0.0, 30.0])
def test_energy_closes_while_a_notched_bar_breaks(core, angle):
    parts = rows(flying(core, angle))
    assert parts[-1][LEDGER.index("fracture_work")] > 0.1 * parts[0].sum()
    assert gap(parts) < 0.01
    for name in ("fracture_work", "damping_work", "strain_energy"):
        assert gap(parts, name) > 0.02, name


def test_energy_closes_with_flaws(core):
    parts = rows(flying(core, **FLAWS, flaw_seed=3))
    assert parts[-1][LEDGER.index("fracture_work")] > 0.01 * parts[0].sum()
    assert gap(parts) < 0.01


def test_looking_at_the_energy_changes_nothing(core):
    """Sums are of the places of now, in records of their own."""
    looked, not_looked = flying(core), flying(core)
    for _ in range(20):
        looked.advance(1e-6)
        looked.state()
        not_looked.advance(1e-6)
    for key in ("position", "velocity", "deformation"):
        assert np.array_equal(looked.state()[key], not_looked.state()[key]), key


def flawed(core, *after):
    """A bar with flaws, pulled until some bonds are broken: which ones, as pairs of its points.

    `after` are points of bodies that are added after it.
    """
    spacing, points = 0.0025, lattice((20, 8), 0.0025)
    table = ELASTIC_DEFAULTS | ROCK | FLAWS | {"poisson_ratio": 0.0}
    bodies = core.ElasticBodies2()
    for cloud in (points, *after):
        velocity = np.zeros_like(cloud)
        if cloud is points:
            velocity[:, 0] = 4.0 * cloud[:, 0] / 0.025
        bodies.add(
            table | {"spacing": spacing, "flaw_seed": 5},
            rest=cloud, position=cloud, velocity=velocity,
            clamped=np.zeros(len(cloud), np.uint8),
        )  # fmt: skip
    bodies.start()
    bodies.advance(1.5e-5)
    bonds = bodies.bonds()
    gone = bonds["intactness"] <= 0
    pairs = np.sort(np.stack([bonds["a"][gone], bonds["b"][gone]], axis=1), axis=1)
    return {tuple(pair) for pair in pairs.tolist()}


def test_flaws_do_not_depend_on_the_order_of_storage(core):
    """A body that is added later changes how points are sorted, and no flaw."""
    alone = flawed(core)
    assert len(alone) > 5
    tall = lattice((8, 60), 0.0025) + np.array([0.5, 0.3])
    assert flawed(core, tall) == alone


def spinning(core, across: int, stress: float, columns: int = 0, angle: float = 0.0):
    """A rod of granite, 10 by 2 cm, that spins with this stress in its middle over its strength.

    It is stretched as far as it is in equilibrium, without a notch: nothing says where it breaks
    but the stress, which is even in its middle.
    """
    spacing, turn = 0.02 / across, np.radians(angle)
    columns = columns or 2 * round(0.05 / spacing)
    points, length = lattice((columns, across), spacing), columns * spacing
    table = ELASTIC_DEFAULTS | ROCK | GRANITE | {"poisson_ratio": 0.0, "spacing": spacing}
    density, young = table["rho0"], table["young_modulus"]
    spin = np.sqrt(8 * stress * table["tensile_strength"] / density) / length
    x = points[:, 0]
    stretched = points + np.outer(
        density * spin**2 / (2 * young) * (0.25 * length**2 * x - x**3 / 3), [1.0, 0.0]
    )
    velocity = spin * np.stack([-stretched[:, 1], stretched[:, 0]], axis=1)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    bodies = core.ElasticBodies2()
    rest, position, velocity = (
        np.ascontiguousarray(array @ matrix.T) for array in (points, stretched, velocity)
    )
    bodies.add(
        table, rest=rest, position=position, velocity=velocity,
        clamped=np.zeros(len(points), np.uint8),
    )  # fmt: skip
    bodies.start()
    return bodies


@pytest.mark.parametrize(
    ("across", "stress", "angle"), [(8, 1.005, 0), (8, 1.02, 0), (12, 1.005, 0), (8, 1.005, 30)]
)
def test_a_fast_crack_takes_its_fracture_energy(core, across, stress, angle):
    """Also after it is through, while its sides go apart at some m/s: nothing holds them then."""
    rod = spinning(core, across, stress, angle=angle)
    start = sum(rod.state()[key] for key in LEDGER)
    rod.advance(4e-4)
    state = rod.state()
    assert pieces(rod)[0] == len(state["mass"]) // 2
    assert state["fracture_work"] / (0.02 * GRANITE["fracture_energy"]) == pytest.approx(
        1, abs=0.06
    )
    lost = start - sum(state[key] for key in LEDGER if key != "fracture_work")
    assert lost == pytest.approx(state["fracture_work"], rel=1e-3)


def test_two_cracks_share_a_section(core):
    """An odd number of columns has two planes in its middle: one crack takes half of each."""
    rod = spinning(core, 12, 1.005, columns=61)
    rod.advance(4e-4)
    taken = rod.state()["fracture_work"] / (0.02 * GRANITE["fracture_energy"])
    assert 1.0 < taken < 1.2
