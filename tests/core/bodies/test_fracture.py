"""Bodies that break: strength, fracture energy, and the direction of the lattice."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from .breaking import GRANITE, Bar, Disc, pieces

OPENING = 2e-5  # m, at which a crack of the granite bears nothing
SPACE = {"dim": 3, "length": 0.03}  # of a bar that is as thick as wide
BRITTLE = GRANITE | {"fracture_energy": 10.0}  # opens over 5 mm, a tenth of the disc


def test_a_bar_breaks_at_its_strength(core):
    """Without a notch; one that does not break bears more."""
    bar = Bar(core, across=8, rows_cut=0).pull(1.2 * OPENING)
    assert bar.stress.max() == pytest.approx(GRANITE["tensile_strength"], rel=0.05)
    whole = Bar(core, across=8, rows_cut=0, fracture="none").pull(1.2 * OPENING)
    assert whole.stress.max() > 1.5 * GRANITE["tensile_strength"]


@pytest.mark.parametrize(
    "across",
    [8, pytest.param(12, marks=pytest.mark.minutes), pytest.param(16, marks=pytest.mark.minutes)],
)
def test_a_crack_takes_its_fracture_energy(core, across):
    """Whatever the spacing; pulled a third as far, it has not."""
    bar = Bar(core, across=across).pull(1.5 * OPENING)
    assert len(pieces(bar.bodies)) == 2
    assert bar.taken == pytest.approx(bar.fracture_energy, rel=0.05)
    assert bar.work_at(0.33) < 0.8 * bar.fracture_energy


def test_a_bar_in_space_breaks_at_its_strength(core):
    """Without a notch; one that does not break bears more."""
    bar = Bar(core, across=8, rows_cut=0, **SPACE).pull(1.2 * OPENING, slowness=40)
    assert bar.stress.max() == pytest.approx(GRANITE["tensile_strength"], rel=0.05)
    whole = Bar(core, across=8, rows_cut=0, fracture="none", **SPACE)
    assert whole.pull(1.2 * OPENING, slowness=40).stress.max() > 2 * GRANITE["tensile_strength"]


def test_how_a_bar_lies_in_space_does_not_matter(core):
    turn = Rotation.from_euler("xyz", [30, 40, 50], degrees=True).as_matrix()
    straight, turned = (
        Bar(core, across=8, turn=matrix, **SPACE).pull(1.5 * OPENING, slowness=20, rows=50)
        for matrix in (None, turn)
    )
    assert len(pieces(straight.bodies)) == 2
    assert pieces(turned.bodies) == pieces(straight.bodies)
    np.testing.assert_allclose(turned.stress, straight.stress, rtol=0, atol=1e-6 * 10e6)
    assert turned.taken == pytest.approx(straight.taken, rel=1e-6)


@pytest.mark.full
def test_a_crack_in_space_takes_its_fracture_energy(core):
    """Per area; pulled a third as far, it has not."""
    bar = Bar(core, across=8, **SPACE).pull(1.5 * OPENING)
    assert len(pieces(bar.bodies)) == 2
    assert bar.taken == pytest.approx(bar.fracture_energy, rel=0.05)
    assert bar.work_at(0.33) < 0.8 * bar.fracture_energy


STRENGTH = BRITTLE["tensile_strength"]


@pytest.mark.parametrize("across", [20, pytest.param(40, marks=pytest.mark.full)])
def test_a_disc_splits_at_its_tensile_strength(core, across):
    """Along the loaded diameter, at 2P/(pi d t), whatever the direction of its lattice."""
    found = []
    for angle in (0.0, 20.0, 45.0):
        disc = Disc(core, across, angle, **BRITTLE).press()
        assert disc.split > 0.8, angle
        assert disc.strength == pytest.approx(STRENGTH, rel=2 / across), angle
        assert disc.off_the_diameter < 0.05, angle
        found.append(disc.strength)
    assert np.ptp(found) < 0.05 * STRENGTH


def test_a_load_on_wide_arcs_splits_a_disc_later(core):
    """Pressure on 40 degrees leaves 0.84 of the tension in the middle (Hondros, 1959)."""
    disc = Disc(core, across=20, angle=0.0, arc=20.0, **BRITTLE).press(most=1.5)
    assert disc.split > 0.8
    assert disc.strength > 1.1 * STRENGTH


def test_a_disc_of_twice_the_strength_splits_at_twice_the_load(core):
    """The energy as well, by its square, so that cracks open over as long a part of the disc."""
    strong = BRITTLE | {
        "tensile_strength": 2 * STRENGTH, "fracture_energy": 4 * BRITTLE["fracture_energy"]
    }  # fmt: skip
    disc = Disc(core, across=20, angle=0.0, **strong).press()
    assert disc.strength == pytest.approx(2 * STRENGTH, rel=0.10)


@pytest.mark.full
@pytest.mark.parametrize("angle", [0.0, 20.0, 45.0])
def test_a_cylinder_splits_at_its_tensile_strength(core, angle):
    """The same in 3-D, four points thick."""
    cylinder = Disc(core, across=20, angle=angle, layers=4, **BRITTLE).press()
    assert cylinder.strength == pytest.approx(BRITTLE["tensile_strength"], rel=0.10)
    assert cylinder.off_the_diameter < 0.1


def test_flaws_decide_where_a_bar_breaks(core):
    """The same seed gives the same bits; others give other strengths."""
    flaws = {"fracture": "grady_kipp", "weibull_k": 5e34, "weibull_m": 8.5}
    bars = [
        Bar(core, across=8, rows_cut=0, **flaws, flaw_seed=seed).pull(1.2 * OPENING, slowness=20)
        for seed in (1, 1, 2)
    ]
    first, again, other = (bar.stress for bar in bars)
    assert np.array_equal(first, again)
    assert first.max() != pytest.approx(other.max(), rel=1e-3)
