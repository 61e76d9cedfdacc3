"""A film of water on a bed of fixed particles runs as the scheme lets it, far too slowly."""

from __future__ import annotations

import numpy as np
import pytest

from ..cases import Case

G_ALONG = 9.8 * np.sin(np.radians(20))
EFFECTIVE_VISCOSITY = 2.0e-3  # m2/s: with it u = g sin(20) d^2/(3 nu) fits both depths


def speed(first, last, *overrides):
    """Mean speed of the water between two times, m/s."""
    case = Case("film", *overrides)
    speeds = []
    for t in np.linspace(first, last, 41):
        case.advance(t)
        speeds.append(-case.mean("velocity", "film")[0])
    return np.mean(speeds)


@pytest.mark.validate
@pytest.mark.parametrize(
    ("depth", "low", "high"), [(0.02, 0.18, 0.30), (0.04, 0.80, 1.05)], ids=["20mm", "40mm"]
)
def test_speed_of_the_film(depth, low, high, report):
    """From 1 to 3 s, averaged over four initial displacements since the flow is chaotic."""
    speeds = [speed(1, 3, f"depth={depth}", f"body.film.random_seed={k}") for k in range(1, 5)]
    found = np.mean(speeds)
    spread = f"{low} to {high}; here {min(speeds):.3f} to {max(speeds):.3f}"
    report(f"speed at {1e3 * depth:.0f} mm", found, spread, "m/s")
    report("nu of the Nusselt film", G_ALONG * depth**2 / (3 * found), EFFECTIVE_VISCOSITY, "m2/s")
    assert low < found < high


@pytest.mark.validate
def test_speed_without_the_switch(report):
    """Unswitched artificial viscosity makes the film nearly stand."""
    found = speed(1, 1.5, "depth=0.02", "balsara=false")
    report("speed at 20 mm, no Balsara switch", found, "0.005 to 0.010", "m/s")
    assert 0.005 < found < 0.010


def test_an_ordered_film_slides_without_friction(report):
    """Rows of a perfect lattice keep their distance from the bed: no pair of them approaches for
    long, and for a while the film accelerates as on ice.
    """
    case = Case("film", "jitter=0", "depth=0.02")
    case.advance(0.1)
    acceleration = -case.mean("velocity", "film")[0] / 0.1
    report("acceleration", acceleration, G_ALONG, "m/s2")
    assert acceleration == pytest.approx(G_ALONG, rel=0.05)
