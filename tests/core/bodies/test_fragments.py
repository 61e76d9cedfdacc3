"""Deformable bodies that come apart: their parts are bodies with surfaces of their own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation, empty_simulation
from doseki.solver.restoring import check_state

from ...small_scenarios import CHALK

TOP = """
schema = 1
dim = 2
dp = 0.005
scheme = "resolved"
speed_max = 2
time_max = 1
time_out = 1
gravity = [0, 0]

[material.rubber]
law = "solid"
rho0 = 1000
speedsound = 90
young_modulus = 1e7
poisson_ratio = 0.3
fracture = "cohesive"
tensile_strength = 1e6
fracture_energy = 1e4
friction = {friction}
"""
DISC = """
[body.a]
shape = "disc"
material = "rubber"
kinematics = "elastic"
centre = [0, 0]
radius = 0.05
velocity = [{u}, {v}]
rotate = {angle}
"""
BAR = """
[body.a]
shape = "box"
material = "rubber"
kinematics = "elastic"
min = [-0.05, -0.02]
max = [0.05, 0.02]
velocity = [{u}, {v}]
"""


@pytest.fixture
def build(tmp_path: Path):
    """Makes a simulation of a body "a" that may break, but is strong."""

    def make(tables: str, friction: float = 0.0, u: float = 0.0, v: float = 0.0, angle: float = 0):
        path = tmp_path / "case.toml"
        text = TOP.format(friction=friction) + tables.format(u=u, v=v, angle=angle)
        path.write_text(text, encoding="utf-8")
        simulation, names = build_simulation(load_scenario(str(path)))
        make.again = lambda: empty_simulation(load_scenario(str(path)), names)
        return simulation

    return make


def cut(simulation, label) -> None:
    """By a label for each particle's position."""
    position = simulation.state()["position"]
    core = getattr(simulation, "_core", simulation)
    core.cut_bodies(np.ascontiguousarray(label(position), np.int32))


def steps(simulation, count: int) -> None:
    simulation.advance(limit=1.0, pause=1.0, max_steps=count)


def sums(simulation) -> dict[str, float | np.ndarray]:
    """Of the particles; each is a square of its own in the moment of inertia of dust."""
    state, dust = simulation.state(), simulation.grains()
    x, v, m = (state[key] for key in ("position", "velocity", "mass"))
    own = float(dust["spin"][:, 2] @ dust["mass"]) * m[0] / 1000 / 6
    return {
        "mass": m.sum(),
        "momentum": m @ v,
        "turning": float(m @ (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])) + own,
        "energy": simulation.totals()["kinetic_energy"],
    }


def halves(x):
    return x[:, 0] > 0.001


def quarters(x):
    return 2 * (x[:, 0] > 0.001) + (x[:, 1] > 0.003)


def jagged(x):
    """A crack that is rough at the size of a particle."""
    return x[:, 0] > 0.001 + 0.006 * np.sin(150 * x[:, 1])


def strewn(x):
    """Many parts of all sizes, some of single points."""
    return np.floor(np.random.default_rng(3).uniform(0, 1.1, len(x))) + 2 * jagged(x)


@pytest.mark.parametrize("label", [halves, quarters, jagged])
@pytest.mark.parametrize("body", [DISC, BAR])
def test_parts_at_rest_stay_at_rest(build, body, label):
    simulation = build(body)
    before = sums(simulation)
    cut(simulation, label)
    parts = simulation.fragments()
    assert len(parts["mass"]) == (4 if label is quarters else 2)
    steps(simulation, 100)
    after = sums(simulation)
    assert after["mass"] == before["mass"]
    assert after["energy"] < 1e-18


@pytest.mark.parametrize("label", [halves, jagged, strewn])
@pytest.mark.parametrize(("u", "v", "spin"), [(1.0, -0.5, 0.0), (0.3, 0.2, 5.0)])
def test_mass_and_momenta_are_kept(build, label, u, v, spin):
    """Through the cut to rounding, and in the 100 steps after it."""
    simulation = build(DISC + f"spin = {spin}\n", friction=0.3, u=u, v=v)
    steps(simulation, 20)
    before = sums(simulation)
    cut(simulation, label)
    at_once = sums(simulation)
    steps(simulation, 100)
    for after in (at_once, sums(simulation)):
        assert after["mass"] == before["mass"]
        np.testing.assert_allclose(after["momentum"], before["momentum"], rtol=0, atol=1e-12)
        assert after["turning"] == pytest.approx(before["turning"], abs=1e-12)
    assert at_once["energy"] <= before["energy"] * (1 + 1e-12)
    assert sums(simulation)["energy"] <= before["energy"] * (1 + 1e-6)


def test_dust_is_single_grains(build):
    simulation = build(BAR)
    before = sums(simulation)
    cut(simulation, strewn)
    grains, parts = simulation.grains(), simulation.fragments()
    assert len(grains["mass"]) > 3
    assert not grains["fixed"].any()
    assert grains["mass"].sum() + parts["mass"].sum() == pytest.approx(before["mass"], rel=1e-13)
    steps(simulation, 100)
    assert sums(simulation)["energy"] < 1e-18


def test_an_outline_with_overlap_throws_parts_apart(build):
    """The control: parts whose surfaces reach 0.1 spacings into each other."""
    apart = """
[body.b]
shape = "box"
material = "rubber"
kinematics = "elastic"
min = [0.0495, -0.02]
max = [0.0995, 0.02]
"""
    simulation = build(BAR + apart)
    steps(simulation, 100)
    assert sums(simulation)["energy"] > 1e-6


def test_parts_meet_again_with_friction(build):
    """One half is pushed along the other: friction acts, and nothing is lost."""
    found = {}
    for friction in (0.0, 0.5):
        simulation = build(BAR + 'displacement = ["= -0.0005 * x / 0.05", 0]\n', friction=friction)
        cut(simulation, lambda x: x[:, 0] + 0.5 * x[:, 1] > 0.001)
        before = sums(simulation)
        steps(simulation, 400)
        after = sums(simulation)
        np.testing.assert_allclose(after["momentum"], before["momentum"], rtol=0, atol=1e-12)
        assert after["turning"] == pytest.approx(before["turning"], abs=1e-12)
        found[friction] = simulation.fragments()["velocity"]
    assert np.abs(found[0.0]).max() > 0.01
    sliding = {k: abs(v[0] - v[1])[1] for k, v in found.items()}
    assert sliding[0.5] < 0.8 * sliding[0.0]


def test_parts_say_where_they_come_from(build):
    simulation = build(BAR)
    steps(simulation, 10)
    born = simulation.time
    cut(simulation, halves)
    steps(simulation, 10)
    cut(simulation, lambda x: x[:, 0] > 0.026)
    parts = simulation.fragments()
    assert parts["number"].tolist() == [0, 1, 2]
    assert parts["parent"].tolist() == [-1, 0, 1 if parts["centre"][1, 0] > 0 else 0]
    assert parts["born"][0] == 0
    assert parts["born"][1] == pytest.approx(born)
    assert parts["born"][2] == pytest.approx(simulation.time)
    grain = simulation.state()["grain"]
    mass = simulation.state()["mass"]
    for k in range(3):
        assert mass[grain == k].sum() == pytest.approx(parts["mass"][k])


def same(one, other, names=("position", "velocity", "stress", "grain")) -> bool:
    """Whether two simulations are in the same state, bit for bit."""
    states, parts = (one.state(), other.state()), (one.fragments(), other.fragments())
    return all(np.array_equal(states[0][name], states[1][name]) for name in names) and all(
        np.array_equal(values, parts[1][key]) for key, values in parts[0].items()
    )


def broken(build):
    """Parts and dust that touch each other, and an empty simulation of the same scenario."""
    simulation = build(BAR + 'displacement = ["= -0.002 * x", 0]\nspin = 2.0\n', friction=0.3)
    steps(simulation, 20)
    cut(simulation, strewn)
    steps(simulation, 50)
    return simulation, build.again()


def test_a_restored_run_goes_on_with_the_same_bits(build):
    simulation, other = broken(build)
    saved = simulation.checkpoint()
    check_state(other, saved, 10, 10)
    assert other.restore(saved)
    for each in (simulation, other):
        steps(each, 50)
    assert same(simulation, other)


@pytest.mark.parametrize(
    ("name", "spoil"),
    [
        ("surface_point", lambda v: v + 10**6),
        ("surface_key", lambda v: v[:-1]),
        ("surface_at_rest", lambda v: v + 10**6),
        ("cell_node", lambda v: v + 10**6),
        ("cell_count", lambda v: v + 1),
        ("elastic_gone", lambda v: v + 2),
        ("elastic_body", lambda v: v + 1000),
        ("elastic_stable_step", lambda v: -v),
        ("deformable_origin_number", lambda v: v * 0),
        ("deformable_origin_parent", lambda v: v + 100),
        ("deformable_group", lambda v: v + 100),
        ("body_numbers", lambda v: v + 1),
    ],
)
def test_a_spoilt_checkpoint_is_refused(build, name, spoil):
    simulation, other = broken(build)
    saved = dict(simulation.checkpoint())
    saved[name] = spoil(saved[name])

    def restore():
        check_state(other, saved, 10, 10)
        other.restore(saved)

    with pytest.raises(ValueError, match=r"checkpoint|not the state"):
        restore()


def test_turned_and_mirrored_bodies_break_alike(build):
    """Parts that are thrown against each other."""
    found = []
    for angle, mirror in ((0.0, 1), (90.0, 1), (0.0, -1)):
        simulation = build(DISC, friction=0.3, angle=angle)
        state = simulation.state()["position"]
        turn = np.radians(angle)
        back = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        x = state @ back * [1, mirror]
        label = (x[:, 0] > 0.001 + 0.3 * x[:, 1]).astype(int) + 2 * (x[:, 0] > 0.02)
        core = getattr(simulation, "_core", simulation)
        core.cut_bodies(np.ascontiguousarray(label, np.int32))
        parts = simulation.fragments()
        order = np.argsort(parts["mass"])
        centre = np.asarray(parts["centre"])[order] @ back * [1, mirror]
        found.append((np.asarray(parts["mass"])[order], centre))
    for mass, centre in found[1:]:
        np.testing.assert_allclose(mass, found[0][0], rtol=1e-12)
        np.testing.assert_allclose(centre, found[0][1], atol=1e-12)


PAIR = """
[body.a]
shape = "disc"
material = "chalk"
kinematics = "elastic"
centre = [-0.0505, 0.01]
radius = 0.05
velocity = [{speed}, 0]

[body.b]
shape = "disc"
material = "chalk"
kinematics = "elastic"
centre = [0.0505, -0.01]
radius = 0.05
velocity = [-{speed}, 0]
"""


@pytest.mark.parametrize("speed", [3.0, 10.0])
def test_discs_that_shatter_keep_their_momenta_and_lose_energy(build, speed):
    """Points that few bonds hold must not become stiffer than the step allows."""
    simulation = build(PAIR.replace("{speed}", str(speed)) + CHALK)
    before = energy = sums(simulation)
    for end in (0.001, 0.002, 0.003):
        simulation.advance(limit=end, pause=end, max_steps=10**9)
        after = sums(simulation)
        assert after["mass"] == pytest.approx(before["mass"], rel=1e-12)
        assert after["turning"] == pytest.approx(before["turning"], rel=1e-12)
        np.testing.assert_allclose(after["momentum"], before["momentum"], rtol=0, atol=1e-10)
        assert after["energy"] < energy["energy"]
        energy = after
    assert len(simulation.fragments()["mass"]) > 2


TRIANGLE = """
[body.strong]
shape = "polygon"
material = "{material}"
kinematics = "elastic"
vertices = [[0.1, 0], [0.18, 0], [0.14, 0.0692820323]]

[material.steel]
law = "solid"
rho0 = 1000
speedsound = 90
young_modulus = 1e7
poisson_ratio = 0.3
"""


@pytest.mark.parametrize(("material", "parents"), [("rubber", [-1, -1, 0]), ("steel", [-1, 0])])
def test_a_body_that_stays_whole_keeps_its_corners(build, material, parents):
    """Those of an equilateral triangle have few neighbours; another body parts."""
    simulation = build(BAR + TRIANGLE.replace("{material}", material))
    cut(simulation, lambda x: (x[:, 0] > 0.001) & (x[:, 0] < 0.08))
    assert simulation.fragments()["parent"].tolist() == parents
    assert len(simulation.grains()["mass"]) == 0


def test_dust_of_clamped_points_stays(build):
    """Three points in the corner of a bar, one of them clamped."""
    simulation = build(BAR + 'clamped = "= -0.0645 - x - y"\n', u=1.0)
    cut(simulation, lambda x: x.sum(axis=1) > -0.059)
    grains = simulation.grains()
    assert grains["fixed"].tolist() == [True]
    place = grains["centre"].copy()
    steps(simulation, 300)
    assert np.array_equal(simulation.grains()["centre"], place)
    assert simulation.fragments()["velocity"][0, 0] > 0.5
