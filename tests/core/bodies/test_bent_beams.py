"""A notched beam of concrete bears the load that is published for its cohesive crack; 2-D."""

from __future__ import annotations

import numpy as np
import pytest

from .bent_beam import CONCRETE, Beam, published_peak

# Where the lattice lies decides how deep the notch is, to half a spacing, and by which of some
# bonds the crack begins: single beams scatter, so that the mean of some is compared.
LATTICES = [(angle, shift) for angle in (10, 20, 30) for shift in ((0.0, 0.0), (0.33, 0.6))]


def peaks(core, across, **material):
    """Highest load of beams on each lattice, over the published one."""
    beams = [Beam(core, across, angle, shift, **material).bend() for angle, shift in LATTICES]
    assert all(beam.loads[-1] < 0.95 * beam.peak for beam in beams)  # all went through it
    return np.array([beam.peak / beam.published for beam in beams])


@pytest.mark.full
@pytest.mark.parametrize("across", [16, 24])
def test_a_notched_beam_bears_the_published_load(core, across):
    found = peaks(core, across)
    assert found.mean() == pytest.approx(1.0, abs=0.10)
    assert found.std(ddof=1) < 0.08


@pytest.mark.full
def test_less_energy_of_the_crack_is_less_load(core):
    """Half of it: what is published for that, and outside the band of the whole."""
    half = {"fracture_energy": 0.5 * CONCRETE["fracture_energy"]}
    found = peaks(core, 16, **half).mean()
    assert found == pytest.approx(1.0, abs=0.10)
    beam = Beam(core, 16)
    args = (beam.depth, beam.span, beam.notch)
    whole = published_peak(*args, **CONCRETE)
    assert found * published_peak(*args, **CONCRETE | half) < 0.9 * whole


@pytest.fixture
def peak(core):
    """Of a beam of 12 points across."""
    return lambda slowness=46.0, **beam: Beam(core, 12, **beam).bend(slowness).peak


def test_a_turned_or_mirrored_beam_bears_the_same(peak):
    built = peak()
    assert peak(turned=37.0) == pytest.approx(built, rel=0.01)
    assert peak(mirrored=True) == pytest.approx(built, rel=0.01)


def test_how_slowly_a_beam_is_bent_does_not_matter(peak):
    assert peak(slowness=92.0) == pytest.approx(peak(), rel=0.03)


def test_without_a_notch_a_beam_bears_more(peak):
    assert peak(notch=0.0) > 1.5 * peak()
