"""Total-Lagrangian elastic bodies: exact for affine motion, and what they conserve."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.materials import ELASTIC_DEFAULTS

from .conftest import RUBBER, energy, lattice

BOXES = [(9, 6), (5, 4, 4)]
DP = 0.01
WAVE = np.sqrt((1e6 * 0.3 / (1.3 * 0.4) + 1e6 / 1.3) / 1000.0)  # c_P of the rubber, m/s


@pytest.fixture(params=BOXES, ids=["2d", "3d"])
def box(request):
    """Points of a box."""
    return lattice(request.param, DP)


def disordered(box, random):
    """The box with its points out of order by a fifth of a spacing."""
    return box + 0.2 * DP * random.uniform(-1, 1, box.shape)


@pytest.fixture
def random():
    """The same random numbers in every run."""
    return np.random.default_rng(7)


def spinning(position, rate):
    """Velocities of a rigid turn about the origin, in the plane of the first two axes."""
    velocity = np.zeros_like(position)
    velocity[:, 0], velocity[:, 1] = -rate * position[:, 1], rate * position[:, 0]
    return velocity


def angular_momentum(state):
    """About the origin, in the plane of the first two axes."""
    x, v = state["position"], state["velocity"]
    return float(state["mass"] @ (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]))


def test_affine_velocity_gives_its_deformation(elastic, box, random):
    """The corrected gradient is exact for it, also at surfaces of points out of order."""
    position = disordered(box, random)
    rate = random.normal(size=(box.shape[1], box.shape[1]))
    bodies = elastic((position, position @ rate.T), spacing=DP)
    assert np.allclose(bodies.state()["deformation"], np.eye(box.shape[1]), atol=1e-13)
    dt = 1e-6
    bodies.advance(dt)
    # Position Verlet takes the last deformation half-way through the step.
    change = (bodies.state()["deformation"] - np.eye(box.shape[1])) / (0.5 * dt)
    np.testing.assert_allclose(change, np.broadcast_to(rate, change.shape), rtol=0, atol=1e-6)


def test_nothing_moves_a_body_at_rest(elastic, box, random):
    bodies = elastic((disordered(box, random), np.zeros_like(box)), spacing=DP)
    bodies.advance(100 * bodies.timestep)
    state = bodies.state()
    assert np.abs(state["velocity"]).max() < 1e-12
    assert np.abs(state["stress"]).max() < 1e-5  # Pa, of 1e6


def test_free_flight_keeps_momentum_and_energy(elastic, box, random):
    """Momenta to rounding, energy to the order of the steps, without damping."""
    velocity = spinning(box, 5.0) + 0.05 * random.normal(size=box.shape) + 0.3
    bodies = elastic((box, velocity), spacing=DP, damping=0.0, hourglass=0.0)
    before = bodies.state()
    for _ in range(10):
        bodies.advance(100 * bodies.timestep)
    after = bodies.state()
    momentum = before["mass"] @ before["velocity"]
    np.testing.assert_allclose(after["mass"] @ after["velocity"], momentum, rtol=1e-12)
    assert angular_momentum(after) == pytest.approx(angular_momentum(before), rel=1e-10)
    assert after["strain_energy"] > 1e-3 * energy(after)  # else nothing was tested
    assert energy(after) == pytest.approx(energy(before), rel=0.01)


def test_springs_keep_momentum_too(elastic, box, random):
    velocity = spinning(box, 5.0) + 0.05 * random.normal(size=box.shape)
    bodies = elastic((box, velocity), spacing=DP, damping=0.0)
    before = bodies.state()
    bodies.advance(300 * bodies.timestep)
    after = bodies.state()
    scale = np.abs(before["mass"] @ np.abs(before["velocity"]))
    change = after["mass"] @ after["velocity"] - before["mass"] @ before["velocity"]
    assert (np.abs(change) < 1e-12 * scale).all()
    assert angular_momentum(after) == pytest.approx(angular_momentum(before), rel=1e-10)


def test_a_damper_of_points_with_few_bonds_has_no_torque(elastic, random):
    """Four bonds leave misfits along one line, about which the damper's frame does not turn.

    It was by such points that bodies lost angular momentum when they broke up.
    """
    turns = np.radians([0, 120, 240])
    ring = np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=1) / np.sqrt(3)
    rest = 0.9 * DP * np.vstack([ring, [[0, 0, np.sqrt(2 / 3)], [0, 0, -np.sqrt(2 / 3)]]])
    strain, velocity = 0.01 * DP * random.normal(size=rest.shape), random.normal(size=rest.shape)
    bodies = elastic((rest + strain, velocity), spacing=DP, displacement=strain, damping=0.2)
    momenta = []
    for _ in range(5):
        state = bodies.state()
        each = state["mass"][:, None] * np.cross(state["position"], state["velocity"])
        momenta.append(each.sum(axis=0))
        bodies.advance(20 * bodies.timestep)
    assert bodies.state()["damping_work"] > 1e-3 * energy(state)
    scale = np.linalg.norm(each, axis=1).sum()
    np.testing.assert_allclose(momenta, momenta[:1] * 5, rtol=0, atol=1e-13 * scale)


def test_springs_hold_what_stress_does_not_see(elastic, random):
    """A checkerboard of displacements has no deformation gradient inside: only springs move it."""
    box = lattice((12, 12), DP)
    index = np.rint(box / DP + 5.5).astype(int)
    pattern = np.where(index.sum(1) % 2, 1.0, -1.0)[:, None] * np.array([1.0, 0.0])
    middle = (np.abs(box) < 3 * DP).all(1)
    still = []
    for hourglass in (0.0, 0.2):
        bodies = elastic((box, 1e-3 * pattern), spacing=DP, damping=0.0, hourglass=hourglass)
        bodies.advance(1e-5)
        still.append(np.abs(bodies.state()["acceleration"][middle]).max())
    assert still[0] < 1e-3 * still[1]


def test_damping_only_takes_energy(elastic, box, random):
    velocity = 0.1 * random.normal(size=box.shape)
    left = []
    for damping in (0.0, 0.02, 0.1):
        bodies = elastic((box, velocity), spacing=DP, damping=damping, hourglass=0.0)
        bodies.advance(200 * DP / WAVE)
        left.append(energy(bodies.state()))
    assert left[0] > left[1] > left[2] > 0


def test_stress_strictly_inside_one_body(elastic):
    """Two bodies in each other's place do not feel one another."""
    box = lattice((6, 6), DP)
    pull = np.array([0.1, 0.0])
    bodies = elastic((box, 0 * box + pull), (box, 0 * box - pull), spacing=DP)
    bodies.advance(0.05)
    state = bodies.state()
    np.testing.assert_allclose(state["position"][: len(box)], box + 0.05 * pull, atol=1e-12)
    np.testing.assert_allclose(state["position"][len(box) :], box - 0.05 * pull, atol=1e-12)


def test_clamped_points_stay(elastic):
    box = lattice((12, 5), DP)
    clamped = box[:, 0] < -0.04
    bodies = elastic((box, np.ones_like(box), clamped), spacing=DP)
    bodies.set_gravity([0.0, -9.8])
    bodies.advance(0.01)
    moved = bodies.state()["position"] - box
    assert (moved[clamped] == 0).all()
    assert (np.abs(moved[~clamped]).max(1) > 1e-4).all()


def test_a_bar_under_tension_has_hooke_s_stretch(elastic):
    """Plane strain: strain_xx = sigma (1 - nu^2)/E away from the ends."""
    box, sigma = lattice((40, 8), DP), 1e3
    bodies = elastic((box, np.zeros_like(box)), spacing=DP, damping=0.2)
    force = np.zeros_like(box)
    force[:, 0] = (
        np.where(box[:, 0] > 0.19, 1.0, np.where(box[:, 0] < -0.19, -1.0, 0.0)) * sigma * DP
    )
    bodies.set_load(force)
    bodies.advance(3.0)
    state = bodies.state()
    inside = np.abs(box[:, 0]) < 0.1
    stretch = state["deformation"][inside, 0, 0].mean() - 1
    assert stretch == pytest.approx(sigma * (1 - 0.3**2) / 1e6, rel=0.01)


def test_forces_of_others_change_momentum(elastic, box):
    bodies = elastic((box, np.zeros_like(box)), spacing=DP)
    force = np.tile(np.arange(1.0, 1.0 + box.shape[1]), (len(box), 1))
    bodies.set_load(force)
    bodies.advance(1e-3)
    state = bodies.state()
    np.testing.assert_allclose(state["mass"] @ state["velocity"], 1e-3 * force.sum(0), rtol=1e-10)


def test_result_does_not_depend_on_threads(core, elastic):
    box = lattice((60, 60), DP)
    velocity = spinning(box, 3.0)
    results = []
    for threads in (1, 2):
        core.set_threads(threads)
        bodies = elastic((box, velocity), spacing=DP)
        bodies.advance(20 * bodies.timestep)
        results.append(bodies.state()["position"])
    assert (results[0] == results[1]).all()


def test_a_body_of_one_row_is_refused(core, elastic):
    with pytest.raises(core.PhysicsFailure, match="too thin"):
        elastic((lattice((9, 1), DP), np.zeros((9, 2))), spacing=DP)


def test_gravity_acts_from_the_start_and_not_on_the_stable_step(core, box):
    """The stable step follows from stiffness and damping alone."""
    dim = box.shape[1]
    material = ELASTIC_DEFAULTS | RUBBER | {"spacing": DP}
    steps = []
    for pull in (0.0, -1e6):
        g = [0.0] * (dim - 1) + [pull]
        bodies = getattr(core, f"ElasticBodies{dim}")()
        still, free = np.zeros_like(box), np.zeros(len(box), np.uint8)
        bodies.add(material, rest=box, position=box, velocity=still, clamped=free)
        bodies.set_gravity(g)
        bodies.start()
        steps.append(bodies.timestep)
        expected = np.broadcast_to(g, box.shape)
        np.testing.assert_allclose(bodies.state()["acceleration"], expected, atol=1e-6)
    assert steps[0] == steps[1]


def test_a_damper_does_not_see_rigid_motion(elastic, box, random):
    """A strained body that turns as a whole has the forces that it has without dampers."""
    strained = 0.1 * DP * random.normal(size=box.shape)
    position, felt = box + strained, []
    for turned in (position, box):  # what turns about the places at rest is not rigid
        forces = []
        for damping in (0.0, 0.5):
            points = (position, spinning(turned, 30.0) + 0.3)
            bodies = elastic(points, spacing=DP, displacement=strained, damping=damping)
            forces.append(bodies.state()["acceleration"])
        felt.append(np.abs(forces[1] - forces[0]).max() / np.abs(forces[0]).max())
    assert felt[0] < 1e-12
    assert felt[1] > 1e-4


def test_dampers_keep_angular_momentum(elastic, box, random):
    """And only take energy."""
    strained = 0.05 * DP * random.normal(size=box.shape)
    velocity = spinning(box, 30.0) + 2.0 * random.normal(size=box.shape)
    bodies = elastic(
        (box + strained, velocity), spacing=DP, displacement=strained, damping=0.1, hourglass=1.0
    )
    before = bodies.state()
    bodies.advance(100 * bodies.timestep)
    after = bodies.state()
    assert angular_momentum(after) == pytest.approx(angular_momentum(before), rel=1e-13)
    assert energy(after) < energy(before)
