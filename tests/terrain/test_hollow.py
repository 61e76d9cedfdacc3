"""What slides in a round hollow: the bed turns it and takes no energy."""

from __future__ import annotations

import math

import numpy as np
import pytest

from .scenes import fluid, profile, simulation_of, text

RADIUS, SPIN, TURN = 2.0, 1.0, 1.2  # m, rad/s, rad
# Water that lies in the left part of a round hollow and goes along it; there is no gravity.
LAYER = """
[body.layer]
shape = "box"
material = "water"
min = [{low}, {foot}]
max = [{high}, {top}]
where = "= (x - {centre})**2 + (y - {middle})**2 - {inner}**2"
velocity = ["= {way}*({middle} - y)", "= {way}*(x - {centre})"]
"""


def bed(x):
    """A hollow of 2 m, and its tangents beyond 60 degrees."""
    edge = RADIUS * math.sin(math.radians(60))
    inside = np.clip(x, -edge, edge)
    beyond = np.abs(x) - np.abs(inside)
    return RADIUS - np.sqrt(RADIUS**2 - inside**2) + beyond * math.tan(math.radians(60))


def kept(folder, sign=1, shift=(0.0, 0.0), wall="free_slip", more=""):
    """Kinetic energy after a turn of 1.2 rad over that of the start, 4 particles deep."""
    x0, y0 = shift
    profile(folder / "terrain.csv", bed, -3.0, 3.0, 0.025, shift)
    left, right = sorted((-sign * 1.25, -sign * 0.65))
    layer = LAYER.format(
        low=left + x0, high=right + x0, foot=y0, top=y0 + 1.0, centre=x0, middle=y0 + RADIUS,
        inner=RADIUS - 0.1, way=sign * SPIN,
    )  # fmt: skip
    path = folder / "case.toml"
    words = text(2, dp=0.025, speed=3.0, wall=wall, more=more + layer)
    path.write_text(words.replace("gravity = [0, -9.81]", "gravity = [0, 0]"))
    simulation, _ = simulation_of(path)
    energies, angles = [], []
    for time in (0.01, 0.01 + TURN / SPIN):
        simulation.advance(limit=time, pause=time, max_steps=10**6)
        state = simulation.state()
        x, y = (state["position"][fluid(state)] - [x0, y0 + RADIUS]).T
        angles.append(np.arctan2(sign * x, -y).mean())
        energies.append(simulation.totals()["kinetic_energy"])
    # Without a bed it would go straight on and keep its energy, too.
    assert angles[1] - angles[0] == pytest.approx(TURN, rel=0.05)
    return energies[1] / energies[0]


@pytest.mark.parametrize(("sign", "shift"), [(1, (0, 0)), (-1, (0, 0)), (1, (460800.0, 2048.0))])
def test_a_hollow_takes_no_energy(tmp_path, sign, shift):
    """Within 2 %, from either side and far from zero."""
    assert kept(tmp_path, sign, shift) == pytest.approx(1.0, abs=0.02)


def test_friction_in_a_hollow_takes_what_the_closed_form_says(tmp_path):
    """The control: dv/ds = -mu v/R presses and brakes, exp(-2 mu angle), outside the band."""
    exact = math.exp(-2 * 0.02 * TURN)
    found = kept(tmp_path, wall="voellmy", more="mu = 0.02\n")
    assert found < 0.98
    assert found == pytest.approx(exact, abs=0.02)
