"""Voellmy's bed: Coulomb's friction of what lies on it, turbulent friction, and rest."""

from __future__ import annotations

import math

import numpy as np
import pytest

from doseki.errors import UserError

from ..flows import LAYER, advance, assert_same_bits, down_layer

G, ANGLE, MU, DEPTH, XI = 9.81, math.radians(25), 0.3, 0.2, 50.0
# Stiff grains.
GRAINS = """\
rheology = "mu_i"
mu_s = 3
mu_2 = 3.2
inertial_number = 0.279
grain_diameter = 1e-3
grain_density = 2500
viscosity_max = 1e4
"""
VOELLMY = """\
wall = "voellmy"
mu = 0.3"""


def slab_text(dim, wall=VOELLMY):
    """A layer of stiff grains."""
    return LAYER.format(dim=dim, angle=25, rho=1500, rheology=GRAINS, wall=wall)


def slab(flows, dim, *settings):
    """A started simulation."""
    return flows(slab_text(dim), *settings)


def at(simulation, time):
    """Mean velocity of the slab at a time, m/s."""
    simulation.advance(limit=time, pause=time, max_steps=10**9)
    state = simulation.state()
    return state["velocity"][state["motion"] == 0].mean(axis=0)


def gain(simulation, dim):
    """Acceleration down the slope, and the size of that across it, m/s2."""
    early = at(simulation, 0.1)
    change = (at(simulation, 0.4) - early) / 0.3
    along = change @ down_layer(dim)
    return along, np.linalg.norm(change - along * down_layer(dim))


@pytest.mark.parametrize("pore", [0, 0.5])
def test_acceleration(core, flows, dim, pore):
    """g (sin - (1 - lambda) mu cos), whichever way the slope runs over the lattice of the bed."""
    along, across = gain(slab(flows, dim, f"material.fluid.pore_pressure_ratio={pore}"), dim)
    exact = G * (math.sin(ANGLE) - (1 - pore) * MU * math.cos(ANGLE))
    assert along == pytest.approx(exact, rel=0.005)
    assert across < 0.005 * exact


def test_turbulent_friction_bounds_the_speed(core, flows):
    exact = math.sqrt(XI * DEPTH * (math.sin(ANGLE) - MU * math.cos(ANGLE)))
    velocity = at(slab(flows, 2, f"body.bed.turbulent_xi={XI}"), 4.0)
    assert velocity @ down_layer(2) == pytest.approx(exact, rel=0.03)


def test_nothing_creeps_below_the_angle_of_friction(core, flows, dim):
    """The lowest row stays where it is, but for half a spacing of stiff liquid between it and the
    bed; above it the slab creeps as such a liquid does.
    """
    stiff = 1e5 if dim == 2 else 1e4
    simulation = slab(flows, dim, "angle=15", f"material.fluid.viscosity_max={stiff:g}")
    places = []
    for time in (0.3, 1.3):
        at(simulation, time)
        state = simulation.state()
        low = (state["motion"] == 0) & (state["position"][:, -1] < 0.05)
        places.append(state["position"][low])
    assert len(places[0]) == (12 if dim == 2 else 64)
    assert np.abs((places[1] - places[0]) @ down_layer(dim)).max() < 0.05 * (5e-4 * 1e5 / stiff)


def test_a_slab_that_is_pushed_comes_to_rest_and_stays(core, flows):
    """On a bed that holds it: v/(mu g cos - g sin) later, and it does not come back."""
    simulation = slab(
        flows, 2, "angle=10", "material.fluid.viscosity_max=1e5", "body.layer.velocity=[-0.5, 0]"
    )
    stops = 0.5 / (G * (MU * math.cos(math.radians(10)) - math.sin(math.radians(10))))
    assert -at(simulation, 0.5 * stops)[0] == pytest.approx(0.25, rel=0.03)
    after = [at(simulation, time)[0] for time in np.linspace(stops, stops + 0.2, 21)]
    assert max(after) < 0.02  # the spring lets go
    assert abs(at(simulation, stops + 1)[0]) < 2e-3


def test_friction_turns_with_the_motion(core, flows):
    """Uphill and downhill, on a level bed: mirror images."""
    runs = [slab(flows, 2, "angle=0", f"body.layer.velocity=[{v}, 0]") for v in (1, -1)]
    right, left = (at(run, 0.1)[0] for run in runs)
    assert right == pytest.approx(1 - 0.1 * MU * G, rel=0.02)
    assert left == pytest.approx(-right, rel=1e-9)


def test_what_the_fluid_loses_the_bed_gets(core, flows, dim):
    simulation = advance(slab(flows, dim, "body.bed.turbulent_xi=50"), 60)
    state, acceleration = simulation.state(), simulation.rates()["acceleration"]
    gravity = G * math.sin(ANGLE) * down_layer(dim)
    gravity[-1] -= G * math.cos(ANGLE)
    free = state["motion"] == 0
    of_fluid = (state["mass"][:, None] * (acceleration - gravity))[free]
    balance = of_fluid.sum(axis=0) + state["force"][~free].sum(axis=0)
    np.testing.assert_allclose(balance, 0, atol=1e-13 * np.abs(of_fluid).sum())


def test_energy_is_accounted_for(core, flows):
    """Gravity's work is in motion, in compression, or dissipated: friction among it."""
    simulation = slab(flows, 2, "body.bed.turbulent_xi=50")
    first = simulation.totals()
    at(simulation, 1.0)
    last = simulation.totals()
    kept = sum(last[key] - first[key] for key in ("kinetic_energy", "bulk_energy"))
    work = last["gravity_work"] + last["scheme_work"] + last["wall_work"]
    assert last["av_dissipation"] > 0.3 * last["gravity_work"]
    assert kept + last["av_dissipation"] == pytest.approx(work, abs=0.01 * work)


@pytest.mark.parametrize("steps", [0, 1, 150])
def test_a_restored_run_goes_on_with_the_same_bits(core, flows, steps):
    """The stretch of the springs is part of its state."""
    text = slab_text(2)
    straight, again = advance(flows(text, "angle=15"), steps), flows.empty(text, "angle=15")
    checkpoint = straight.checkpoint()
    assert np.abs(checkpoint["bed_slip"]).max() > 0 or steps < 2
    assert again.restore(checkpoint)
    for simulation in (straight, again):
        advance(simulation, 100)
    assert_same_bits(straight.state(), again.state())
    assert_same_bits(straight.checkpoint(), again.checkpoint())


def test_a_run_without_such_a_bed_has_no_such_state(core, flows):
    rough = flows(slab_text(2, wall='wall = "rough"\nks = 0.01'))
    assert not {"bed_slip", "bed_load"} & set(rough.checkpoint())


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (["body.bed.wall=rough"], 'mu goes with wall = "voellmy"'),
        (["body.bed.ks=0.01"], 'ks goes with wall = "rough"'),
        (["body.bed.mu=-0.1"], "mu"),
        (["body.bed.turbulent_xi=0"], "turbulent_xi"),
        (["body.bed.turbulent_xi='50 m/s'"], "turbulent_xi"),
        (["material.fluid.pore_pressure_ratio=1"], "pore_pressure_ratio"),
    ],
)
def test_refusals(flows, settings, said):
    with pytest.raises(UserError, match=said):
        flows.scenario(slab_text(2), *settings)


def test_a_voellmy_wall_needs_mu(flows):
    with pytest.raises(UserError, match="a voellmy wall needs mu"):
        flows.scenario(slab_text(2, wall='wall = "voellmy"'))


def test_fluids_of_two_pore_pressure_ratios_are_refused(flows):
    other = slab_text(2) + (
        '\n[body.water]\nshape = "box"\nmaterial = "water"\nmin = [0, 0.3]\nmax = [0.1, 0.4]\n'
    )
    flows.scenario(other)
    with pytest.raises(UserError, match=r"fluid has 0\.5 and water has 0"):
        flows.scenario(other, "material.fluid.pore_pressure_ratio=0.5")


STONE = """
[body.stone]
shape = "box"
material = "basalt"
min = [0.2, 0]
max = [0.4, 0.2]
"""


def test_the_friction_of_a_stone_on_the_bed_is_that_of_contacts(core, flows):
    """The mean of its material's and the bed's, 0.5, whatever the bed does to what flows."""
    text = slab_text(2).replace('periodic = { d2 = ["x"], d3 = ["x", "y"] }', "")
    text = text[: text.index("[body.layer]")] + STONE
    text = text.replace("max = { d2 = [0.6, 0]", "max = { d2 = [2.6, 0]")
    text = text.replace("min = { d2 = [0, -0.15]", "min = { d2 = [-2, -0.15]")
    speeds = []
    for mu in (0, 0.9):
        simulation = flows(text, f"body.bed.mu={mu}", "angle=40")
        simulation.advance(limit=0.3, pause=0.3, max_steps=10**6)
        speeds.append(np.asarray(simulation.grains()["velocity"]).sum(axis=0))  # one moves
    angle = math.radians(40)
    exact = 0.3 * G * (math.sin(angle) - 0.5 * math.cos(angle))
    assert speeds[0] @ down_layer(2) == pytest.approx(exact, rel=0.01)
    np.testing.assert_array_equal(speeds[0], speeds[1])


def test_a_stone_that_is_carried_weighs_on_the_bed(core, flows):
    """All of it slides as one: the bed's friction is that of slab and stone together."""
    stone = STONE.replace('"box"', '"disc"').replace("min = [0.2, 0]\nmax = [0.4, 0.2]", "")
    text = slab_text(2).replace("[0.6, 0.2]", "[0.6, 0.5]").replace("(0.2 - y)", "(0.5 - y)")
    text += stone + "centre = [0.3, 0.275]\nradius = 0.13\n"
    simulation = flows(text, "speed_max=4", "material.fluid.viscosity_max=3e4")
    momentum = []
    for time in (0.1, 0.4):
        simulation.advance(limit=time, pause=time, max_steps=10**6)
        momentum.append(np.array(simulation.totals()["momentum"]))
    change = (momentum[1] - momentum[0]) @ down_layer(2) / 0.3 / simulation.totals()["mass"]
    exact = G * (math.sin(ANGLE) - MU * math.cos(ANGLE))
    assert change == pytest.approx(exact, rel=0.02)
