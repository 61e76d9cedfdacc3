"""The stress of a fluid is with that of its viscosity."""

from __future__ import annotations

import numpy as np
import pytest

from ..flows import Flows, advance

DEPTH, ROWS, VISCOSITY, PULL = 0.1, 20, 0.01, 1.0  # m, -, m2/s, m/s2
OIL = f"""
dim = 2
scheme = "resolved"
dp = {DEPTH / ROWS}
time_max = 1
time_out = 1
gravity = [{PULL}, -9.81]
speed_max = 2
periodic = ["x"]
domain_min = [0.0, -0.02]
domain_max = [0.1, 0.3]

[material.oil]
based_on = "water"
nu = {VISCOSITY}

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
wall = "no_slip"
normal = [0, 1]
min = [0, -0.02]
max = [0.1, 0]

[body.oil]
shape = "box"
material = "oil"
min = [0, 0]
max = [0.1, {DEPTH}]
pressure = "= 1000*9.81*({DEPTH} - y)"
velocity = ["= {PULL / VISCOSITY}*({DEPTH}*y - y*y/2)", 0]
"""


@pytest.fixture
def flows(tmp_path):
    return Flows(tmp_path)


def test_a_film_has_the_stress_of_what_it_bears(flows):
    """Along the slope, the weight above each height; across it, its pressure."""
    state = advance(flows(OIL), 20).state()
    y, oil = state["position"][:, 1], state["motion"] == 0
    inside = oil & (y > 0.2 * DEPTH) & (y < 0.8 * DEPTH)
    along = state["stress"][inside, 0, 1]
    np.testing.assert_allclose(along, 1000 * PULL * (DEPTH - y[inside]), rtol=0.05)
    np.testing.assert_array_equal(along, state["stress"][inside, 1, 0])
    mean = np.trace(state["stress"][inside], axis1=1, axis2=2) / 3
    np.testing.assert_allclose(mean, -state["pressure"][inside], atol=1e-9)
