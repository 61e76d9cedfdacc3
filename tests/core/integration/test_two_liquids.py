"""Two liquids of different density or viscosity."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.record.particles import FREE
from doseki.validate.cases.streams import layers as reference

from ..bodies.blocks import box, listed, started

TOP = """
schema = 1
dim = {dim}
scheme = "resolved"
dp = {dp}
time_max = 10
time_out = 10
gravity = {gravity}
speed_max = {speed}
"""
LIQUID = """
[material.{name}]
law = "fluid"
based_on = "water"
rho0 = {rho}
nu = {nu}
"""
DROP = """
[body.tank]
shape = "tank"
material = "aluminium"
wall = "free_slip"
min = {low}
max = {high}
open = []

[body.sea]
shape = "box"
material = "water"
min = {low}
max = {high}
where = "= {square} - 0.02"
pressure = "= 1000*({work}) + 8000"

[body.drop]
shape = "box"
material = "oil"
min = {low}
max = {high}
where = "= 0.02 - {square}"
pressure = "= 1000*({work}) + 8000"
"""


def drop(folder, rho, down, dp):
    """A drop of this density in the middle of a closed tank of water."""
    dim, axes = len(down), "xyz"[: len(down)]
    gravity = [9.8 * d for d in down]
    text = TOP.format(dim=dim, dp=dp, gravity=gravity, speed=4)
    text += LIQUID.format(name="oil", rho=rho, nu=1e-6)
    square = "(" + " + ".join(f"{x}*{x}" for x in axes) + ")"
    work = " + ".join(f"{g}*{x}" for g, x in zip(gravity, axes, strict=True))
    low, high = [-0.4] * dim, [0.4] * dim
    return started(folder, text + DROP.format(low=low, high=high, square=square, work=work))


@pytest.mark.parametrize("rho", [100, 20])
@pytest.mark.parametrize(
    ("down", "dp"), [([0, -1], 0.02), ([-1, 0], 0.02), ([0, 0, -1], 0.05), ([0, 1, 0], 0.05)]
)
def test_a_light_drop_in_water_does_not_shatter(tmp_path, rho, down, dp):
    """Sound that swings ever more would take a hundred times the energy that gravity gives."""
    run = drop(tmp_path, rho, down, dp)
    run.advance(0.05)
    totals = run.simulation.totals()
    assert totals["kinetic_energy"] > 0.1
    assert totals["av_dissipation"] < totals["kinetic_energy"]


def test_a_lighter_liquid_shortens_steps_and_one_nearly_as_heavy_does_not(tmp_path):
    """The bound of Eq. (41) is not below the default for a sixth of the density."""
    steps = {}
    for rho in (1000, 170, 40):
        run = drop(tmp_path, rho, [0, -1], 0.05)
        run.advance(0.04)
        steps[rho] = run.simulation.steps
    assert abs(steps[170] - steps[1000]) <= 1
    assert abs(steps[40] - 2 * steps[1000]) <= 2


DEPTH, LENGTH, PULL, NU = 0.05, 0.1, 0.05, (0.01, 0.001)  # m, m, m/s2, m2/s


def layers(folder, axis, thick_below):
    """Two layers between plates, driven along an axis, after the start."""
    dp, across = DEPTH / 10, 1 - axis
    low, high = np.full(2, -0.2), np.full(2, 0.3)
    low[axis], high[axis] = 0, LENGTH
    gravity = [PULL * float(a == axis) for a in range(2)]
    text = TOP.format(dim=2, dp=dp, gravity=gravity, speed=0.3)
    text += f'periodic = ["{"xy"[axis]}"]\n'
    text += f"domain_min = {listed(low)}\ndomain_max = {listed(high)}\n"
    for name, nu in zip(("thick", "thin"), NU, strict=True):
        text += LIQUID.format(name=name, rho=1000, nu=nu)

    def layer(name, material, bottom, top, **values):
        ends = np.array([[0.0, 0.0], [LENGTH, LENGTH]])
        ends[:, across] = bottom, top
        return box(name, *ends, material=f'"{material}"', **values)

    def plate(name, bottom, sign):
        normal = [sign * (a == across) for a in range(2)]
        return layer(name, "aluminium", bottom, bottom + 4 * dp, fixed=True, normal=normal)

    text += plate("below", -4 * dp, 1) + plate("above", 2 * DEPTH, -1)
    order = ("thick", "thin") if thick_below else ("thin", "thick")
    for k, material in enumerate(order):
        text += layer(material, material, k * DEPTH, (k + 1) * DEPTH, jitter=0.1, pressure=20)
    return started(folder, text)


def exact(y):
    """Speed at a height above the plate of the thick liquid, m/s."""
    unit = PULL * (2 * DEPTH) ** 2 / NU[0]
    return unit / (reference.PULL / reference.THICK) * reference.exact_speed(y / (2 * DEPTH))


@pytest.mark.parametrize(("axis", "thick_below"), [(0, True), (0, False), (1, True)])
def test_stress_is_the_same_on_both_sides_of_where_liquids_meet(tmp_path, axis, thick_below):
    """With the mean of the viscosities of a pair the speed is 7 % off."""
    run = layers(tmp_path, axis, thick_below)
    run.advance(4.0)
    state = run.simulation.state()
    free = state["motion"] == FREE
    y = state["position"][free, 1 - axis]
    speed, expected = state["velocity"][free, axis], exact(y if thick_below else 2 * DEPTH - y)
    assert np.linalg.norm(speed - expected) < 0.025 * np.linalg.norm(expected)
