"""What a touch may do to a body, Eq. (139)."""

import numpy as np
import pytest


@pytest.mark.parametrize("dim", [2, 3])
def test_the_tension_to_expect(physics, dim):
    """A plane wave, Eq. (139a), and a ball between two forces, Eq. (139b): the larger of them."""
    zero, infinite = 0.0, np.inf
    speed, own, other, force, diameter = 3.0, 2e6, 6e6, 500.0, 0.1
    wave = physics.expected_tension([[speed], [own], [other], [zero], [diameter]])[dim - 2][0]
    assert wave == pytest.approx(speed * own * other / (own + other), rel=1e-12)
    stiff = physics.expected_tension([[speed], [own], [infinite], [zero], [diameter]])[dim - 2][0]
    assert stiff == pytest.approx(speed * own, rel=1e-12)
    pressed = physics.expected_tension([[zero], [own], [own], [force], [diameter]])[dim - 2][0]
    form = 2 / diameter if dim == 2 else 2.8 / diameter**2
    assert pressed == pytest.approx(form * force / np.pi, rel=1e-12)
    both = physics.expected_tension([[speed], [own], [other], [force], [diameter]])[dim - 2][0]
    assert both == max(wave, pressed)
