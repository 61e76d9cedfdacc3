"""What the resolved scheme conserves, and what it must not notice."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from ..flows import DROP, FILM, advance

G = 9.8
WALLS = pytest.mark.parametrize("wall", ["no_slip", "free_slip", "rough"])


def gravity_of(dim):
    """Gravity on a slope of 20 degrees, and straight down."""
    slope = np.zeros(dim)
    slope[0], slope[-1] = -G * np.sin(np.radians(20)), -G * np.cos(np.radians(20))
    return slope


def down(dim):
    """The setting of a scenario's gravity along the last axis."""
    return f"gravity={[0] * (dim - 1) + [-G]}"


def forces(simulation, gravity):
    """Sums of m a - m g of the fluid and of the forces on walls, and the size of what is summed."""
    state, acceleration = simulation.state(), simulation.rates()["acceleration"]
    free, mass = state["motion"] == 0, state["mass"][:, None]
    of_fluid = (mass * (acceleration - gravity))[free]
    return of_fluid.sum(axis=0), state["force"][~free].sum(axis=0), np.abs(of_fluid).sum()


@WALLS
@pytest.mark.parametrize("steps", [0, 30])
def test_what_the_fluid_loses_the_walls_get(core, flows, dim, wall, steps):
    """Every pair is balanced, what shifting makes neighbours exchange as well."""
    settings = [f"body.bed.wall={wall}", "body.bed.ks=0.01"]
    film = advance(flows(FILM.format(dim=dim), *settings), steps)
    fluid, walls, size = forces(film, gravity_of(dim))
    assert np.abs(walls).max() > 1e-4 * size
    np.testing.assert_allclose(fluid + walls, 0, atol=1e-14 * size)


def test_a_drop_that_flies_past_takes_the_same_steps(core, flows, dim):
    """Only how fast neighbours come nearer counts; 8 m/s are 0.4 of the sound speed."""
    swirl = ["= -0.5*y", "= 0.5*x"] + [0] * (dim - 2)
    flight = ["= 8 - 0.5*y", "= 0.5*x"] + [0] * (dim - 2)
    drops = [
        advance(flows(DROP.format(dim=dim), f"body.drop.velocity={velocity}"), 10)
        for velocity in (swirl, flight)
    ]
    assert drops[1].timestep == pytest.approx(drops[0].timestep, rel=1e-6)


@WALLS
def test_water_at_rest_and_walls_are_in_balance_at_any_depth(core, flows, wall):
    settings = [f"body.bed.wall={wall}", "body.bed.ks=0.01", "body.film.velocity=[0, 0]"]
    settings += ["body.film.max=[0.2, 0.15]", "body.film.pressure== 3000*(0.15 - y)"]
    fluid, walls, size = forces(flows(FILM.format(dim=2), *settings), gravity_of(2))
    assert np.abs(walls).max() > 1e-4 * size
    np.testing.assert_allclose(fluid + walls, 0, atol=1e-14 * size)


def test_the_friction_of_a_rough_bed_depends_on_its_roughness(core, flows, dim):
    drag = []
    for ks in (0.001, 0.01):
        settings = ["body.bed.wall=rough", f"body.bed.ks={ks}", "body.film.jitter=0"]
        settings += [f"body.film.velocity={[-1.0] + [0.0] * (dim - 1)}"]
        drag.append(forces(flows(FILM.format(dim=dim), *settings), gravity_of(dim))[1][0])
    assert drag[1] < drag[0] < 0


def test_momentum_of_a_small_drop_is_conserved(core, flows, dim):
    """All of it is near the surface, so that nothing acts that belongs inside a flow."""
    velocity = ["= -3*y + 5*x", *[0.1] * (dim - 2), "= 3*x"]
    settings = [f"body.drop.velocity={velocity}", "body.drop.radius=0.025", "body.drop.jitter=0.2"]
    drop = flows(DROP.format(dim=dim), *settings)
    before, mass = np.array(drop.totals()["momentum"]), drop.totals()["mass"]
    advance(drop, 20)
    fluid, _, size = forces(drop, 0.0)
    assert size > 0.5 * mass  # there are forces
    np.testing.assert_allclose(fluid, 0, atol=1e-14 * size)
    np.testing.assert_allclose(drop.totals()["momentum"], before, rtol=0, atol=1e-13 * mass)


def test_a_drop_falls_with_g_and_keeps_its_shape(core, flows, dim):
    drop = flows(DROP.format(dim=dim), down(dim))
    before, time = drop.state()["position"], {2: 0.15, 3: 0.05}[dim]
    drop.advance(limit=time, pause=time, max_steps=10**6)
    state = drop.state()
    x, v = state["position"], state["velocity"]
    fall = np.zeros(dim)
    fall[-1] = -0.5 * G * time**2
    np.testing.assert_allclose(x.mean(axis=0) - before.mean(axis=0), fall, atol=1e-12)
    np.testing.assert_allclose(v.mean(axis=0), 2 * fall / time, atol=1e-12)
    assert np.abs(x - before - fall).max() < 0.25 * 0.01
    assert np.abs(v - 2 * fall / time).max() < 0.01


def moving_drop(flows, dim, speed):
    """A turning, stretched drop on its way. Viscosity limits its steps, whatever its speed."""
    along = "z" if dim == 3 else "y"
    velocity = [f"= {speed} - 4*{along} + 2*x", *["= -2*y"] * (dim - 2), f"= {2 * speed} + 4*x"]
    settings = [
        f"body.drop.velocity={velocity}",
        "material.water.nu=0.5",
        "material.water.law=fluid",
    ]
    return flows(DROP.format(dim=dim), *settings)


def test_nothing_depends_on_the_speed_of_the_frame(core, flows, dim):
    speed = 8.0
    still, moving = (moving_drop(flows, dim, u) for u in (0.0, speed))
    frame = np.array([speed] + [0.0] * (dim - 2) + [2 * speed])
    for steps in (0, 30):
        ours, theirs = (advance(drop, steps) for drop in (still, moving))
        assert theirs.time == pytest.approx(ours.time, rel=1e-9)
        one, other = ours.state(), theirs.state()
        x = other["position"] - frame * ours.time
        np.testing.assert_allclose(x, one["position"], atol=1e-12)
        np.testing.assert_allclose(other["velocity"] - frame, one["velocity"], atol=1e-9)
        np.testing.assert_allclose(other["density"], one["density"], rtol=1e-10)
        a, b = (drop.rates()["acceleration"] for drop in (ours, theirs))
        np.testing.assert_allclose(b, a, atol=1e-9 * np.abs(a).max())


@WALLS
def test_a_bed_that_goes_with_the_water_is_a_bed_at_rest(core, flows, wall):
    """Forces depend on velocities relative to the wall."""
    settings = [f"body.bed.wall={wall}", "body.bed.ks=0.01"]
    velocity = 'body.film.velocity=["= {} + sin(60*x)", "= 0.3*cos(90*x)"]'
    still = flows(FILM.format(dim=2), *settings, velocity.format(0))
    belt = "[body.bed.motion]\nvelocity = [2.5, 0]\nstop = 1\n"
    moving = flows(FILM.format(dim=2) + belt, *settings, velocity.format(2.5))
    for name in ("acceleration", "density_rate"):
        expected = still.rates()[name]
        scale = np.abs(expected).max()
        np.testing.assert_allclose(moving.rates()[name], expected, atol=1e-11 * scale)
    np.testing.assert_allclose(moving.state()["force"], still.state()["force"], atol=1e-9)


PAINT = """
[material.paint]
based_on = "water"
rheology = "casson"
yield_stress = 50
casson_viscosity = 1
regularisation = 10
viscosity_max = 5
"""


def swirled(flows, velocity, text):
    """(positions, velocities) of a drop that swirls, 20 steps after the start."""
    drop = flows(text, f"body.drop.velocity={velocity}", "body.drop.radius=0.055")
    state = advance(drop, 20).state()
    return state["position"], state["velocity"]


def test_a_drop_that_yields_does_not_notice_a_quarter_turn(core, flows):
    water = DROP.format(dim=2)
    paint = water.replace('"water"', '"paint"') + PAINT
    x, v = swirled(flows, ["= 0.4*sin(40*y)", "= 0.2*sin(60*x)"], paint)
    x_turned, v_turned = swirled(flows, ["= -0.2*sin(60*y)", "= -0.4*sin(40*x)"], paint)
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    away, same = cKDTree(x_turned).query(x @ turn.T)
    assert away.max() < 1e-12
    np.testing.assert_allclose(v_turned[same], v @ turn.T, atol=1e-11)
    _, without = swirled(flows, ["= 0.4*sin(40*y)", "= 0.2*sin(60*x)"], water)
    assert np.abs(without - v).max() > 1e-3


def test_a_stiffened_gas_at_rest_carries_its_weight(core, flows):
    depth, c, gamma = 0.15, 10.0, 3.0
    settings = ["eos=stiffened_gas", f"material.water.gamma={gamma}", "speed_max=1", down(2)]
    settings += ["body.film.velocity=[0, 0]", f"body.film.max=[0.2, {depth}]"]
    settings += ["body.film.jitter=0", f"body.film.pressure== {1000 * G}*({depth} - y)"]
    state = advance(flows(FILM.format(dim=2), *settings), 300).state()
    water = state["motion"] == 0
    y, p = state["position"][water, 1], state["pressure"][water]
    law = 1000 * c**2 / gamma * ((state["density"][water] / 1000) ** gamma - 1)
    np.testing.assert_allclose(p[p > 0], law[p > 0], rtol=1e-10)
    np.testing.assert_allclose(p, 1000 * G * (depth - y), atol=0.03 * 1000 * G * depth)
    assert np.abs(state["velocity"][water]).max() < 0.02 * np.sqrt(G * depth)


SHEARED = """\
dim = 2
scheme = "resolved"
speed_max = 2
dp = 0.005
time_max = 1
time_out = 1
periodic = ["x", "y"]
domain_min = [0, 0]
domain_max = [0.2, 0.2]

[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.2, 0.2]
pressure = 2e4
"""


@pytest.mark.parametrize(
    ("waves", "time"), [((0, 1), 0.1), ((1, 1), 0.025)], ids=["along rows", "askew"]
)
def test_an_arrangement_under_pressure_resists_no_shear(core, flows, waves, time):
    """A slow shear wave in water under a twentieth of rho c^2 goes on as it would under none.

    Sums of p_i + p_j alone resist like an elastic solid, at any spacing: 0.69 and -0.04 are left.
    """
    k = 2 * np.pi / 0.2 * np.array(waves)
    along = np.array([k[1], -k[0]]) / np.linalg.norm(k)
    velocity = [f"= 2e-3*{a}*sin({k[0]}*x + {k[1]}*y)" for a in along]
    simulation = flows(SHEARED, f"body.water.velocity={velocity}")

    def amplitude():
        state = simulation.state()
        return 2 * np.mean((state["velocity"] @ along) * np.sin(state["position"] @ k))

    start = amplitude()
    simulation.advance(limit=time, pause=time, max_steps=10**6)
    assert amplitude() == pytest.approx(start, rel=0.05)


def test_water_elsewhere_changes_nothing(core, flows):
    """A film runs as it does without a second body of water far above it."""
    above = """
[body.above]
shape = "box"
material = "water"
min = [0, 0.6]
max = [0.2, 0.68]
"""
    settings = ["domain_max=[0.2, 1]", "skin=0.1"]
    alone = advance(flows(FILM.format(dim=2), *settings), 60)
    beside = advance(flows(FILM.format(dim=2) + above, *settings), 60)
    assert beside.time == pytest.approx(alone.time, rel=1e-12)
    one, other = alone.state(), beside.state()
    here = other["body"] <= one["body"].max()
    for key in ("velocity", "density"):
        np.testing.assert_allclose(other[key][here], one[key], rtol=1e-9, atol=1e-9)


def test_a_lone_particle_is_not_driven_along_a_wall(core, flows, dim):
    """The pressure gradient that it brings along is no force: walls would tell it its own."""
    low, high = ([0.1] * (dim - 1) + [at] for at in (0.0, 0.01))
    high[: dim - 1] = [0.11] * (dim - 1)
    settings = ["slope=0", f"gravity={[0.0] * dim}", "body.film.jitter=0", f"body.film.min={low}"]
    settings += [f"body.film.max={high}", f"body.film.velocity={[0.0] * dim}"]
    settings += ["body.bed.wall=free_slip", "cflnumber=0.4"]
    kept = flows(FILM.format(dim=dim), *settings).checkpoint()
    gradient = np.array(kept["pressure_gradient"])
    gradient.reshape(-1, dim)[:, 0] = 1e5
    film = flows.empty(FILM.format(dim=dim), *settings)
    assert film.restore(kept | {"pressure_gradient": gradient})
    state = advance(film, 40).state()
    lone = state["velocity"][state["motion"] == 0]
    assert lone.shape == (1, dim)
    # The first step takes what it brought; what it then told itself made 0.17 m/s in 2-D.
    assert np.abs(lone[:, 0]).max() < 0.01
