"""Viscous fluids on rough walls: they stick to them as to any other; water feels the roughness."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ..flows import advance, assert_same_bits

G, ANGLE, DEPTH, DENSITY = 9.81, math.radians(15), 0.2, 1800
# A layer of four rows on a bed that is periodic all around.
LAYER = """\
dim = {dim}
scheme = "resolved"
speed_max = 2
dp = 0.05
time_max = 10
time_out = 1
gravity = {{ d2 = ["= s", "= -n"], d3 = ["= s*cos(b)", "= s*sin(b)", "= -n"] }}
periodic = {{ d2 = ["x"], d3 = ["x", "y"] }}
domain_min = {{ d2 = [0, -0.15], d3 = [0, 0, -0.15] }}
domain_max = {{ d2 = [0.6, 1], d3 = [0.4, 0.4, 1] }}

[parameters]
b = {{ value = "= radians(40)", help = "3-D: which way is down the slope, in plan" }}
s = "= 9.81*sin(radians(15))"
n = "= 9.81*cos(radians(15))"

[material.fluid]
based_on = "water"
rho0 = 1800
{rheology}

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
wall = "rough"
ks = 0.02
normal = {{ d2 = [0, 1], d3 = [0, 0, 1] }}
min = {{ d2 = [0, -0.15], d3 = [0, 0, -0.15] }}
max = {{ d2 = [0.6, 0], d3 = [0.4, 0.4, 0] }}

[body.layer]
shape = "box"
material = "fluid"
min = {{ d2 = [0, 0], d3 = [0, 0, 0] }}
max = {{ d2 = [0.6, 0.2], d3 = [0.4, 0.4, 0.2] }}
pressure = {{ d2 = "= 1800*n*(0.2 - y)", d3 = "= 1800*n*(0.2 - z)" }}
"""
OIL = "nu = 0.5"
WATER = "nu = 1e-6"
MUD = """\
rheology = "herschel_bulkley"
yield_stress = 1100
consistency = 10
flow_index = 1
regularisation = 100
viscosity_max = 20000
"""


def mean_velocity(simulation):
    state = simulation.state()
    return state["velocity"][state["motion"] == 0].mean(axis=0)


def down(dim):
    """Unit vector down the slope."""
    return np.array(
        [1, 0] if dim == 2 else [math.cos(math.radians(40)), math.sin(math.radians(40)), 0]
    )


def test_oil_sticks_to_a_rough_wall_as_to_a_smooth_one(core, flows, dim):
    rough, smooth = (
        flows(LAYER.format(dim=dim, rheology=OIL), f"body.bed.wall={wall}")
        for wall in ("rough", "no_slip")
    )
    advance(rough, 40), advance(smooth, 40)
    assert mean_velocity(rough) @ down(dim) > 0
    assert_same_bits(rough.state(), smooth.state())


def test_mud_below_its_yield_stress_rests_on_a_rough_bed(core, flows, dim):
    """rho g h sin = 914 of 1100 Pa: it creeps as its largest viscosity lets it."""
    creep = DENSITY * G * math.sin(ANGLE) * DEPTH**2 / (3 * 20000)
    simulation = flows(LAYER.format(dim=dim, rheology=MUD))
    simulation.advance(limit=0.2, pause=0.2, max_steps=10**9)
    speed = mean_velocity(simulation) @ down(dim)
    assert 0.5 * creep < speed < 1.5 * creep
    assert speed < 0.02 * G * math.sin(ANGLE) * 0.2  # of what slides without friction


@pytest.mark.parametrize("turbulence", ["none", "mixing_length"])
def test_fast_water_has_the_friction_of_the_roughness(core, flows, turbulence):
    """The force on the bed is that of Eq. (39), with the viscosity of water or without any."""
    drags = []
    for rheology in (WATER, "nu = 1e-9"):
        simulation = flows(
            LAYER.format(dim=2, rheology=rheology),
            f"turbulence={turbulence}", "body.layer.velocity=[1, 0]",
        )  # fmt: skip
        before = mean_velocity(simulation)[0]
        advance(simulation, 20)
        time = simulation.time
        drags.append(before + G * math.sin(ANGLE) * time - mean_velocity(simulation)[0])
    assert drags[0] == pytest.approx(drags[1], rel=1e-3)
    # u = 1 m/s half a spacing above the bed.
    stress = DENSITY * (0.4 / math.log(1 + 30 * 0.025 / 0.02)) ** 2
    assert drags[1] == pytest.approx(stress * time / (DENSITY * DEPTH), rel=0.35)
