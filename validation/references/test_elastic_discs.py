"""The finite elements of two discs that meet: an energy, its forces, a contact that keeps it."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.validate.reference import read_columns

from . import elastic_discs
from .elastic_discs import DENSITY, RADIUS, Solid, extrapolated, half_disc, impact

COARSE, FOCUS = 12, 0.6  # rings, of the mesh


@pytest.fixture
def solid():
    """A coarse half disc and its places at rest (2, N)."""
    nodes, triangles = half_disc(COARSE, FOCUS)
    return Solid(nodes, triangles), nodes.T


def turned(places, angle):
    """Places turned about the origin."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]]) @ places


def test_half_a_disc(solid):
    body, rest = solid
    assert body.area.min() > 0
    assert body.mass.sum() == pytest.approx(DENSITY * np.pi * RADIUS**2 / 2, rel=0.01)
    assert rest[0].max() == pytest.approx(0, abs=1e-12)
    assert rest[1].min() == pytest.approx(0, abs=1e-12)


def test_affine_places_have_their_gradient(solid):
    body, rest = solid
    F = np.array([[1.1, 0.2], [-0.3, 0.9]])
    found = np.array(body.gradient(F @ rest + 7.0))
    assert np.abs(found - F[:, :, None]).max() < 1e-9


def test_a_turned_disc_is_at_rest(solid):
    body, rest = solid
    assert np.abs(body.force(turned(rest, 0.7))).max() < 1e-7 * elastic_discs.YOUNG * RADIUS


def test_forces_are_the_gradient_of_the_energy_and_turn_with_the_disc(solid):
    body, rest = solid
    rng = np.random.default_rng(3)
    places = rest * 1.05 + 1e-4 * rng.standard_normal(rest.shape)
    ahead = rng.standard_normal(rest.shape)
    step = 1e-7
    gain = (body.energy(places + step * ahead) - body.energy(places - step * ahead)) / (2 * step)
    assert -np.sum(body.force(places) * ahead) == pytest.approx(gain, rel=1e-6)
    assert body.force(turned(places, 0.7)) == pytest.approx(
        turned(body.force(places), 0.7), abs=1e-6 * np.abs(body.force(places)).max()
    )


def test_the_contact_takes_no_energy_and_gives_the_whole_impulse():
    run = impact(COARSE, FOCUS, 1.0)
    mass = 2 * Solid(*half_disc(COARSE, FOCUS)).mass.sum()
    impulse = run.force.sum() * (run.times[1] - run.times[0])
    assert abs(run.energy_gain) < 3e-4
    assert impulse == pytest.approx(mass * 0.5 * (1 + run.restitution), rel=1e-9)
    assert run.force.min() >= 0


@pytest.mark.parametrize("row", read_columns("elastic-discs.csv").T, ids=lambda row: f"{row[0]:g}")
def test_a_coarse_run_is_near_the_table(row):
    speed, restitution, _, time, _, force, _ = row
    run = impact(COARSE, FOCUS, speed)
    assert run.restitution == pytest.approx(restitution, abs=0.003)
    assert run.contact_time == pytest.approx(time, rel=0.02)
    assert run.greatest_force == pytest.approx(force, rel=0.01)


def test_the_limit_of_a_straight_line():
    sizes = (0.1, 0.05, 0.025)
    limit, doubt = extrapolated(sizes, [2 + 3 * size for size in sizes])
    assert limit == pytest.approx(2)
    assert doubt == pytest.approx(3 * sizes[-1])
