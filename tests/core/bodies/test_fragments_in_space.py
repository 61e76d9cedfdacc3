"""Deformable bodies that come apart in 3-D, where their surfaces are layers of balls."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation, empty_simulation

from .blocks import listed

TOP = """
schema = 1
dim = 3
dp = 0.01
scheme = "resolved"
speed_max = 10
time_max = 1
time_out = 1
gravity = [0, 0, 0]

[material.chalk]
law = "solid"
rho0 = 1000
young_modulus = 1e8
poisson_ratio = 0.2
friction = 0.3
fracture = "cohesive"
tensile_strength = {strength}
fracture_energy = {energy}
"""
BALL = """
[body.{name}]
shape = "sphere"
material = "chalk"
kinematics = "elastic"
centre = {centre}
radius = 0.05
velocity = {velocity}
"""
FLOOR = """
[body.floor]
shape = "box"
material = "chalk"
fixed = true
min = {low}
max = {high}
"""
SQUEEZED = 'displacement = ["= -0.02 * x", "= -0.02 * y", "= -0.02 * z"]\n'
STRONG, WEAK = 1e7, 1.5e5  # Pa


@pytest.fixture
def build(tmp_path: Path):
    """Makes a simulation of these bodies; `build.again()` an empty one of the same scenario."""

    def make(*bodies: str, strength: float = WEAK, gravity=(0, 0, 0)):
        path = tmp_path / "case.toml"
        top = TOP.format(strength=strength, energy=2 * (strength / WEAK) ** 2).replace(
            "[0, 0, 0]", str(listed(gravity)), 1
        )
        path.write_text(top + "".join(bodies), encoding="utf-8")
        simulation, names = build_simulation(load_scenario(str(path)))
        make.again = lambda: empty_simulation(load_scenario(str(path)), names)
        return simulation

    return make


def ball(name: str = "a", centre=(0, 0, 0), velocity=(0, 0, 0), more: str = "") -> str:
    return BALL.format(name=name, centre=list(centre), velocity=list(velocity)) + more


def core_of(simulation):
    return getattr(simulation, "_core", simulation)


def cut(simulation, label) -> None:
    """By a label for each particle's position."""
    position = simulation.state()["position"]
    core_of(simulation).cut_bodies(np.ascontiguousarray(label(position), np.int32))


def steps(simulation, count: int) -> None:
    simulation.advance(limit=1.0, pause=1.0, max_steps=count)


def sums(simulation) -> dict[str, float | np.ndarray]:
    """Of the particles; each is a cube of its own in the moment of inertia of dust."""
    state, dust = simulation.state(), simulation.grains()
    x, v, m = (state[key] for key in ("position", "velocity", "mass"))
    spacing = (m.min() / 1000) ** (1 / 3)
    free = ~dust["fixed"]
    own = (dust["mass"][free, None] * dust["spin"][free]).sum(axis=0) * spacing**2 / 6
    return {"mass": m.sum(), "momentum": m @ v, "turning": m @ np.cross(x, v) + own}


def energy(simulation) -> float:
    """Of motion, strain, springs inside and contacts, J."""
    return sum(core_of(simulation).body_energy().values())


def halves(x):
    return x[:, 0] > 0.001


def rough(x):
    """A crack that is rough at the size of a particle."""
    return x[:, 0] > 0.001 + 0.01 * np.sin(150 * x[:, 1] + 100 * x[:, 2])


def strewn(x):
    """Many parts of all sizes, some of single points."""
    return np.floor(np.random.default_rng(3).uniform(0, 1.3, len(x))) + 2 * rough(x)


@pytest.mark.parametrize("label", [halves, rough, strewn])
def test_parts_at_rest_stay_at_rest(build, label):
    simulation = build(ball(), strength=STRONG)
    before = sums(simulation)
    cut(simulation, label)
    assert len(simulation.fragments()["mass"]) > 1
    assert (len(simulation.grains()["mass"]) > 10) == (label is strewn)
    steps(simulation, 5)
    assert sums(simulation)["mass"] == before["mass"]
    assert energy(simulation) < 1e-18


def test_parts_that_were_pressed_get_no_energy(build):
    """A ball that is compressed by 2 % comes apart: balls of its surfaces overlap in it."""
    simulation = build(ball(more=SQUEEZED), strength=STRONG)
    steps(simulation, 1)
    before = energy(simulation)
    cut(simulation, strewn)
    for _ in range(5):
        steps(simulation, 1)
        assert energy(simulation) < before
    assert simulation.totals()["kinetic_energy"] > 0.01 * before


def test_overlaps_that_were_there_before_press(build):
    """The control: balls of two bodies that reach 0.2 spacings into each other."""
    simulation = build(ball(), ball("b", (0.0996, 0, 0)), strength=STRONG)
    steps(simulation, 5)
    assert energy(simulation) > 1e-6


@pytest.mark.parametrize("label", [pytest.param(rough, marks=pytest.mark.full), strewn])
def test_mass_and_momenta_are_kept(build, label):
    """Through the cut to rounding, and in the steps after it."""
    moving = ball(velocity=(1, -0.5, 0.3), more="spin = [3, 5, -2]\n")
    simulation = build(moving, strength=STRONG)
    steps(simulation, 5)
    before = sums(simulation)
    cut(simulation, label)
    at_once = sums(simulation)
    steps(simulation, 5)
    for after in (at_once, sums(simulation)):
        assert after["mass"] == before["mass"]
        np.testing.assert_allclose(after["momentum"], before["momentum"], rtol=0, atol=1e-12)
        np.testing.assert_allclose(after["turning"], before["turning"], rtol=0, atol=1e-12)


def test_balls_that_shatter_keep_their_momenta_and_lose_energy(build):
    """They meet off their line of centres."""
    pair = (ball("a", (-0.0505, 0.01, 0), (9, 0, 0)), ball("b", (0.0505, -0.01, 0), (-9, 0, 0)))
    simulation = build(*pair)
    before, first = sums(simulation), energy(simulation)
    least = first
    for end in np.linspace(2e-4, 1e-3, 9):
        simulation.advance(limit=end, pause=end, max_steps=10**9)
        assert energy(simulation) < 1.001 * least
        least = min(least, energy(simulation))
    after = sums(simulation)
    assert len(simulation.grains()["mass"]) > 20
    assert after["mass"] == pytest.approx(before["mass"], rel=1e-12)
    np.testing.assert_allclose(after["momentum"], before["momentum"], rtol=0, atol=1e-12)
    np.testing.assert_allclose(after["turning"], before["turning"], rtol=0, atol=1e-12)
    assert least < 0.9 * first


def drop(build, speed: float, axis: int = 2, strength: float = WEAK, sideways=(0, 0, 0)):
    """The largest mass and the energies of a ball that met a wall, along an axis."""
    down = np.eye(3)[axis]
    low, high = (0.1 * sign * np.ones(3) for sign in (-1, 1))
    low[axis], high[axis] = -0.03, 0.0
    wall = FLOOR.format(low=low.tolist(), high=high.tolist())
    velocity = np.roll(sideways, axis) - speed * down
    falling = ball(centre=(0.0505 * down).tolist(), velocity=velocity.tolist())
    simulation = build(falling, wall, strength=strength)
    energies = [energy(simulation)]
    for end in np.linspace(0, 2e-3, 21)[1:]:
        simulation.advance(limit=end, pause=end, max_steps=10**9)
        energies.append(energy(simulation))
    parts, grains = simulation.fragments()["mass"], simulation.grains()
    kept = parts.sum() + grains["mass"][~grains["fixed"]].sum()
    assert kept == pytest.approx(1000 * 4 / 3 * np.pi * 0.05**3, rel=1e-12)
    return parts.max(), np.array(energies)


def test_a_ball_that_meets_a_floor_faster_has_a_smaller_largest_part(build):
    """And its energy never grows.  Which part is the largest is chance: centimetres a second
    sideways move it by a half, so that only means are told apart.
    """
    largest = []
    for speed in (2.0, 4.0):
        masses = []
        for sideways in (0.0, 0.02, 0.04):
            mass, energies = drop(build, speed, sideways=(sideways, 0.7 * sideways, 0.0))
            assert energies.max() < (1 + 1e-9) * energies[0]
            assert energies[-1] < 0.9 * energies[0]
            masses.append(mass)
        largest.append(np.mean(masses))
    assert largest[0] > 1.1 * largest[1]


def test_a_ball_that_holds_keeps_its_energy(build):
    """The control: nearly all that it had."""
    mass, energies = drop(build, 4.0, strength=STRONG)
    assert mass == pytest.approx(0.5236, rel=1e-3)
    assert energies[-1] == pytest.approx(energies[0], rel=0.01)


@pytest.mark.full
def test_along_which_axis_a_ball_falls_does_not_matter(build):
    """It also moves sideways: bonds that strain alike in a straight fall end by rounding."""
    slant = (0.0, 0.3, 0.18)
    mass, energies = drop(build, 4.0, sideways=slant)
    assert mass < 0.5
    for axis in (0, 1):
        other, others = drop(build, 4.0, axis, sideways=slant)
        assert other == pytest.approx(mass, rel=0.02)
        np.testing.assert_allclose(others, energies, rtol=0, atol=0.002 * energies[0])


def test_a_restored_run_goes_on_with_the_same_bits(build):
    """Overlaps at rest among the rest."""
    simulation = build(ball(more="spin = [3, 5, -2]\n" + SQUEEZED), strength=STRONG)
    steps(simulation, 1)
    cut(simulation, strewn)
    steps(simulation, 2)
    saved = simulation.checkpoint()
    other = build.again()
    assert (saved["contact_springs"][:, 6] > 0).any()
    assert other.restore(saved)
    states = []
    for each in (simulation, other):
        steps(each, 2)
        states.append(each.state())
    for name in ("position", "velocity", "stress", "grain"):
        assert np.array_equal(states[0][name], states[1][name]), name


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("side", [0.1056, 0.1045, 0.095])
def test_a_block_at_rest_on_a_floor_stays_there_whatever_its_sides_are(build, axis, side):
    """Its balls reach to its faces: they began inside the floor where dp does not divide a side,
    and a block of granite flew to pieces; with balls that are too small it would fall.
    """
    across = [side, side, 0.1]
    low, high = np.zeros(3), np.roll(across, axis - 2)
    under = low - np.where(np.arange(3) == axis, 0.04, 0.02)
    over = np.where(np.arange(3) == axis, 0.0, high + 0.02)
    block = FLOOR.replace("floor", "block").replace("fixed = true", 'kinematics = "elastic"')
    block = block.format(low=low.tolist(), high=high.tolist())
    floor = FLOOR.format(low=under.tolist(), high=over.tolist())
    for weight in (0.0, 9.81):
        pull = listed(np.where(np.arange(3) == axis, -weight, 0.0))
        simulation = build(block, floor, gravity=pull)
        before = simulation.state()["position"].copy()
        simulation.advance(limit=0.004, pause=0.004, max_steps=10**6)
        totals = simulation.totals()
        assert totals["broken_bonds"] == 0
        assert np.abs(simulation.state()["position"] - before).max() < 0.1 * 0.5 * 9.81 * 0.004**2
        if weight == 0:
            assert abs(totals["contact_work"]) < 1e-12
