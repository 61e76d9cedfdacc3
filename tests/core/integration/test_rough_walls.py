"""Viscous fluids on rough walls: they stick to them as to any other; water feels the roughness."""

from __future__ import annotations

import math

import pytest

from ..flows import LAYER, advance, assert_same_bits, down_layer

G, ANGLE, DEPTH, DENSITY = 9.81, math.radians(15), 0.2, 1800
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


def layer(dim, rheology):
    """On a rough slope of 15 degrees."""
    wall = 'wall = "rough"\nks = 0.02'
    return LAYER.format(dim=dim, angle=15, rho=DENSITY, rheology=rheology, wall=wall)


def test_oil_sticks_to_a_rough_wall_as_to_a_smooth_one(core, flows, dim):
    rough, smooth = (
        flows(layer(dim, OIL), f"body.bed.wall={wall}") for wall in ("rough", "no_slip")
    )
    advance(rough, 40), advance(smooth, 40)
    assert mean_velocity(rough) @ down_layer(dim) > 0
    assert_same_bits(rough.state(), smooth.state())


def test_mud_below_its_yield_stress_rests_on_a_rough_bed(core, flows, dim):
    """rho g h sin = 914 of 1100 Pa: it creeps as its largest viscosity lets it."""
    creep = DENSITY * G * math.sin(ANGLE) * DEPTH**2 / (3 * 20000)
    simulation = flows(layer(dim, MUD))
    simulation.advance(limit=0.2, pause=0.2, max_steps=10**9)
    speed = mean_velocity(simulation) @ down_layer(dim)
    assert 0.5 * creep < speed < 1.5 * creep
    assert speed < 0.02 * G * math.sin(ANGLE) * 0.2  # of what slides without friction


@pytest.mark.parametrize("turbulence", ["none", "mixing_length"])
def test_fast_water_has_the_friction_of_the_roughness(core, flows, turbulence):
    """The force on the bed is that of Eq. (39), with the viscosity of water or without any."""
    drags = []
    for rheology in (WATER, "nu = 1e-9"):
        settings = f"turbulence={turbulence}", "body.layer.velocity=[-1, 0]"
        simulation = flows(layer(2, rheology), *settings)
        before = mean_velocity(simulation)
        advance(simulation, 20)
        time = simulation.time
        gained = (mean_velocity(simulation) - before) @ down_layer(2)
        drags.append(G * math.sin(ANGLE) * time - gained)
    assert drags[0] == pytest.approx(drags[1], rel=1e-3)
    # u = 1 m/s half a spacing above the bed.
    stress = DENSITY * (0.4 / math.log(1 + 30 * 0.025 / 0.02)) ** 2
    assert drags[1] == pytest.approx(stress * time / (DENSITY * DEPTH), rel=0.35)
