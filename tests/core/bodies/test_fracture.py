"""Bodies that break: strength, fracture energy, and what cracks keep."""

from __future__ import annotations

import pytest

from .breaking import GRANITE, Bar, Disc, pieces

OPENING = 2 * 100.0 / 10e6  # m, at which a crack of it bears nothing
BRITTLE = GRANITE | {"fracture_energy": 10.0}  # opens over 5 mm, a tenth of the disc


def test_a_bar_breaks_at_its_strength(core):
    """Without a notch; one that does not break bears more."""
    strength = GRANITE["tensile_strength"]
    bar = Bar(core, across=8, notch=0.0).pull(1.2 * OPENING)
    assert bar.stress.max() == pytest.approx(strength, rel=0.02)
    whole = Bar(core, across=8, notch=0.0, fracture="none").pull(1.2 * OPENING)
    assert whole.stress.max() > 2 * strength


@pytest.mark.parametrize("across", [8, 12, 16])
def test_a_crack_takes_its_fracture_energy(core, across):
    """Whatever the spacing; pulled half as far, it has not."""
    bar = Bar(core, across=across).pull(2.5 * OPENING)
    assert len(pieces(bar.bodies)) == 2
    assert bar.taken == pytest.approx(bar.fracture_energy, rel=0.05)
    assert bar.work_at(0.5) < 0.9 * bar.fracture_energy


@pytest.mark.parametrize("angle", [0.0, 20.0, 45.0])
def test_a_disc_splits_at_its_tensile_strength(core, angle):
    """Along the loaded diameter, at 2P/(pi d t), whatever the direction of the lattice."""
    disc = Disc(core, across=20, angle=angle, **BRITTLE).press()
    assert disc.strength == pytest.approx(BRITTLE["tensile_strength"], rel=0.10)
    assert disc.off_the_diameter < 0.1
