"""Two liquids of different density or viscosity."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.record.particles import FREE
from doseki.validate.running import Running

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


def started(folder, text):
    """A run of this scenario."""
    path = folder / "case.toml"
    path.write_text(text)
    return Running(str(path))


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


LAYER = """
[body.{name}]
shape = "box"
material = "{material}"
min = {low}
max = {high}
{more}
"""
DEPTH, LENGTH, PULL, NU = 0.05, 0.1, 0.05, (0.01, 0.001)  # m, m, m/s2, m2/s


def layers(folder, axis, thick_below):
    """Two layers between plates, driven along an axis, after the start."""
    dp, across = DEPTH / 10, 1 - axis
    low, high = np.full(2, -0.2), np.full(2, 0.3)
    low[axis], high[axis] = 0, LENGTH
    gravity = [PULL * float(a == axis) for a in range(2)]
    text = TOP.format(dim=2, dp=dp, gravity=gravity, speed=0.3)
    text += (
        f'periodic = ["{"xy"[axis]}"]\ndomain_min = {low.tolist()}\ndomain_max = {high.tolist()}\n'
    )
    for name, nu in zip(("thick", "thin"), NU, strict=True):
        text += LIQUID.format(name=name, rho=1000, nu=nu)

    def layer(name, material, bottom, top, more):
        ends = np.array([[0.0, 0.0], [LENGTH, LENGTH]])
        ends[:, across] = bottom, top
        low, high = ends.tolist()
        return LAYER.format(name=name, material=material, low=low, high=high, more=more)

    def normal(sign):
        return f"fixed = true\nnormal = {[sign * (a == across) for a in range(2)]}"

    first, second = ("thick", "thin") if thick_below else ("thin", "thick")
    text += layer("below", "aluminium", -4 * dp, 0.0, normal(1))
    text += layer("above", "aluminium", 2 * DEPTH, 2 * DEPTH + 4 * dp, normal(-1))
    text += layer("first", first, 0.0, DEPTH, "jitter = 0.1\npressure = 20")
    text += layer("second", second, DEPTH, 2 * DEPTH, "jitter = 0.1\npressure = 20")
    return started(folder, text)


def exact(y):
    """Speed of two parabolas with one stress and one speed where they meet; thick below, m/s."""
    thick, thin = NU
    rise = PULL / 2 * np.array([1 / thick, -1 / thin]).sum() * DEPTH**2
    a, b = np.linalg.solve([[DEPTH, -DEPTH], [thick, thin]], [rise, 2 * PULL * DEPTH])
    z = 2 * DEPTH - y
    return np.where(y < DEPTH, a * y - PULL / 2 / thick * y**2, b * z - PULL / 2 / thin * z**2)


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
