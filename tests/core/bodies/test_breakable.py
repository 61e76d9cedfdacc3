"""Bodies that are rigid until something strikes them so that they may break."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_scene
from doseki.solver.build import build_simulation, empty_simulation
from doseki.solver.restoring import check_state

STRENGTH, YOUNG, DENSITY, RATIO = 1e6, 1e8, 1000.0, 0.2
P_WAVE = np.sqrt(YOUNG * (1 - RATIO) / ((1 + RATIO) * (1 - 2 * RATIO)) / DENSITY)  # m/s
MEETS = 2 * STRENGTH / (DENSITY * P_WAVE)  # m/s, at which two such bodies may crack, Eq. (139a)
TOP = """
schema = 1
dim = {dim}
dp = {dp}
scheme = "resolved"
speed_max = 10
time_max = 1
time_out = 1
gravity = {gravity}

[material.chalk]
law = "solid"
rho0 = 1000
young_modulus = 1e8
poisson_ratio = 0.2
friction = 0.3
fracture = "cohesive"
tensile_strength = 1e6
fracture_energy = 100
"""
BALL = """
[body.{name}]
shape = "{shape}"
material = "chalk"
kinematics = "{kinematics}"
centre = {centre}
radius = 0.05
velocity = {velocity}
spin = {spin}
"""


def ball(name: str, dim: int, kinematics: str, centre, velocity, spin: float = 0.0) -> str:
    """A table of a ball; `centre` and `velocity` are in its plane of motion, as is `spin`."""
    flat = [0.0] * (dim - 2)
    return BALL.format(
        name=name,
        shape="disc" if dim == 2 else "sphere",
        kinematics=kinematics,
        centre=[*map(float, centre), *flat],
        velocity=[*map(float, velocity), *flat],
        spin=float(spin) if dim == 2 else [0.0, 0.0, float(spin)],
    )


def pair(dim: int, kinematics: str, speed: float, turn: float = 0.0, spin: float = 0.0) -> str:
    """Two balls that meet off their centres with this speed; all is turned, radians."""
    c, s = np.cos(turn), np.sin(turn)
    matrix = np.array([[c, -s], [s, c]])
    tables = ""
    for name, side in (("a", -1), ("b", 1)):
        centre, velocity = matrix @ [side * 0.0505, side * 0.008], matrix @ [-side * speed / 2, 0]
        tables += ball(name, dim, kinematics, centre, velocity, spin)
    return tables


@pytest.fixture
def build(tmp_path: Path):
    """Makes a started simulation of tables; `make.again` makes an empty one like the last."""

    def make(tables: str, dim: int = 2, gravity=None, dp: float | None = None) -> Any:
        dp = dp or {2: 0.01, 3: 0.0125}[dim]
        text = TOP.format(dim=dim, dp=dp, gravity=gravity or [0.0] * dim) + tables
        path = tmp_path / "case.toml"
        path.write_text(text, encoding="utf-8")
        simulation, names = build_simulation(load_scenario(str(path)))
        make.again = lambda: empty_simulation(load_scenario(str(path)), names)
        return simulation

    return make


def run(simulation, time: float) -> None:
    simulation.advance(limit=time, pause=time, max_steps=100_000)


def deformable(simulation) -> int:
    """How many bodies are deformable now."""
    return len(simulation.fragments()["mass"])


def sums(simulation) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, momentum and angular momentum: rigid bodies have the inertia of their particles."""
    state = simulation.state()
    m = state["mass"]
    pad = ((0, 0), (0, 3 - state["position"].shape[1]))
    x, v = np.pad(state["position"], pad), np.pad(state["velocity"], pad)
    return float(m.sum()), m @ v, m @ np.cross(x, v)


def energy(simulation) -> float:
    """Of motion and strain, and what cracks, dampers and the change of bodies took."""
    totals = simulation.totals()
    held = totals["kinetic_energy"] + totals["elastic_energy"]
    return held + totals["fracture_work"] + totals["damping_work"] + totals["parting_work"]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("turn", [0.0, 0.7])
@pytest.mark.parametrize(("share", "struck"), [(0.93, 0), (1.07, 2)])
def test_an_impact_above_the_strength_makes_both_deformable(build, dim, turn, share, struck):
    """By the speed along the line of centres; whichever way all is turned."""
    along = np.cos(np.arcsin(0.16 / 1.01))  # of the velocity: they meet off their centres
    simulation = build(pair(dim, "breakable", share * MEETS / along, turn), dim)
    assert deformable(simulation) == 0
    run(simulation, 0.0006)
    assert deformable(simulation) == struck


@pytest.mark.parametrize("dim", [2, 3])
def test_what_stays_rigid_would_not_have_cracked(build, dim):
    """The control: the same impact among deformable bodies opens no crack."""
    simulation = build(pair(dim, "elastic", 0.95 * MEETS), dim)
    run(simulation, 0.002)
    assert simulation.totals()["elastic_energy"] > 0
    assert simulation.totals()["fracture_work"] == 0
    simulation = build(pair(dim, "elastic", 4 * MEETS), dim)
    run(simulation, 0.002)
    assert simulation.totals()["fracture_work"] > 0


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("spin", [0.0, 40.0])
@pytest.mark.parametrize("share", [1.2, 3.0])
def test_mass_and_momenta_are_kept_through_the_change(build, dim, spin, share):
    simulation = build(pair(dim, "breakable", share * MEETS, 0.3, spin), dim)
    mass, momentum, turning = sums(simulation)
    start, scale = energy(simulation), mass * MEETS
    changed = False
    for time in np.linspace(0.0001, 0.0012, 12):
        run(simulation, time)
        changed |= deformable(simulation) > 0
        if simulation.totals()["dust_grains"]:
            break  # grains have an inertia of their own
        now = sums(simulation)
        assert now[0] == pytest.approx(mass, rel=1e-13)
        np.testing.assert_allclose(now[1], momentum, rtol=0, atol=1e-12 * scale)
        np.testing.assert_allclose(now[2], turning, rtol=0, atol=1e-12 * scale)
        assert energy(simulation) <= start * (1 + 3e-3)  # the error of steps, Eq. (129)
    assert changed


@pytest.mark.parametrize("turn", [0.0, 0.7])
@pytest.mark.parametrize("share", [1.2, 4.0])
def test_stiff_bodies_gain_nothing_from_the_step_in_which_they_meet(build, turn, share):
    """What is made deformable in a long step of rigid bodies goes on in short ones of its own."""
    stiff = TOP[TOP.index("[material") :].replace("chalk", "rock").replace("1e8", "1e10")
    left, taken = {}, {}
    for kinematics in ("breakable", "elastic"):
        tables = pair(2, kinematics, 0.1 * share * MEETS, turn).replace("chalk", "rock") + stiff
        simulation = build(tables)
        start = energy(simulation)
        run(simulation, 0.0045 / share)
        left[kinematics] = energy(simulation) / start
        taken[kinematics] = simulation.totals()["contact_work"] / start
    assert -0.02 < taken["breakable"] < 0
    assert taken["breakable"] == pytest.approx(taken["elastic"], abs=2e-3)
    assert left["breakable"] == pytest.approx(left["elastic"], abs=2e-3)


def test_a_body_struck_in_space_breaks_though_its_own_surface_is_touched_late(build):
    """Layers of balls lie within the ball that is rigid; stiff bodies are still long before."""
    stiff = TOP[TOP.index("[material") :].replace("chalk", "rock").replace("1e8", "1e10")
    found = {}
    for kinematics in ("breakable", "elastic"):
        tables = pair(3, kinematics, 0.4 * MEETS, 0.7).replace("chalk", "rock") + stiff
        simulation = build(tables, 3)
        start = energy(simulation)
        run(simulation, 0.003)
        totals = simulation.totals()
        found[kinematics] = [
            share / start
            for share in (energy(simulation), totals["contact_work"], totals["fracture_work"])
        ]
    assert found["breakable"][2] > 0.001
    np.testing.assert_allclose(found["breakable"], found["elastic"], rtol=0, atol=5e-3)


def test_a_squeezed_stiff_body_stays_deformable_under_its_load(build):
    """It hardly vibrates; rigid again, it would be without a load, over and over."""
    stiff = TOP[TOP.index("[material") :].replace("chalk", "rock").replace("1e8", "1e10")
    plate = """
[body.{name}]
shape = "box"
material = "rock"
fixed = true
min = [-0.04, {low}, -0.04]
max = [0.04, {high}, 0.04]
motion = {{ velocity = [0, {v}, 0] }}
"""
    tables = ball("a", 3, "breakable", [0, 0], [0, 0]).replace("chalk", "rock") + stiff
    tables += plate.format(name="below", low=-0.0805, high=-0.0502, v=0.15)
    tables += plate.format(name="above", low=0.0502, high=0.0805, v=-0.15)
    simulation = build(tables, 3)
    stored = []
    for time in (0.0036, 0.0048, 0.006):
        run(simulation, time)
        assert deformable(simulation) == 1
        stored.append(simulation.totals()["elastic_energy"])
    assert stored[2] > 2 * stored[1] > 4 * stored[0] > 0


def test_a_whole_body_is_rigid_again_when_it_is_still(build):
    """It flies on with its momenta; its vibration is damped, its elastic energy held."""
    simulation = build(pair(2, "breakable", 1.2 * MEETS, 0.0, 20.0) + "damping = 0.2\n")
    before = sums(simulation)
    run(simulation, 0.0006)
    assert deformable(simulation) == 2
    vibrating = simulation.totals()
    run(simulation, 0.02)
    assert deformable(simulation) == 0
    still = simulation.totals()
    assert still["damping_work"] > vibrating["damping_work"]
    after = sums(simulation)
    assert after[0] == pytest.approx(before[0], rel=1e-13)
    np.testing.assert_allclose(after[1], before[1], rtol=0, atol=1e-12 * before[0] * MEETS)
    np.testing.assert_allclose(after[2], before[2], rtol=0, atol=1e-12 * before[0] * MEETS)
    again = simulation.totals()
    run(simulation, 0.03)
    for key in ("kinetic_energy", "elastic_energy", "damping_work"):
        assert simulation.totals()[key] == pytest.approx(again[key], rel=1e-9, abs=1e-12), key


def test_a_squeezed_body_becomes_deformable_without_an_impact(build):
    """Between two slow plates, when 2F/(pi d) is its strength, Eq. (139b)."""
    plates = """
[body.{name}]
shape = "box"
material = "chalk"
fixed = true
min = [-0.03, {low}]
max = [0.03, {high}]
motion = {{ velocity = [0, {v}] }}
"""
    tables = ball("a", 2, "breakable", [0, 0], [0, 0])
    tables += plates.format(name="below", low=-0.0705, high=-0.0505, v=0.4)
    tables += plates.format(name="above", low=0.0505, high=0.0705, v=-0.4)
    simulation = build(tables)
    forces = []
    for time in np.arange(0.0004, 0.012, 0.0002):
        run(simulation, time)
        if deformable(simulation):
            break
        force = np.abs(simulation.grains()["contact_force"][:, 1])
        forces.append(float(np.sort(force)[-2:].mean()))
    assert deformable(simulation) == 1
    assert 0.4 * STRENGTH < 2 * forces[-1] / (np.pi * 0.1) < 1.02 * STRENGTH


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("at", [0.0003, 0.0012])
def test_a_restored_run_goes_on_with_the_same_bits(build, dim, at):
    """From before the impact, and from after it."""
    simulation = build(pair(dim, "breakable", 2 * MEETS, 0.2, 10.0), dim)
    run(simulation, at)
    saved = simulation.checkpoint()
    other = build.again()
    check_state(other, saved, 1, 2)
    assert other.restore(saved)
    for one in (simulation, other):
        one.advance(limit=0.0016, pause=0.0016, max_steps=100_000)
    assert deformable(simulation) >= 2
    for key in ("position", "velocity"):
        assert np.array_equal(simulation.state()[key], other.state()[key]), key
    assert simulation.totals() == other.totals()


@pytest.mark.parametrize(("dim", "share"), [(2, 2.9), (3, 4.0)])
def test_a_cracked_body_that_is_rigid_again_is_restored(build, dim, share):
    """Saved while it is rigid, it strikes a wall like the one that was not saved."""
    flat = dim - 2
    wall = f"""
[body.wall]
shape = "box"
material = "chalk"
fixed = true
min = {[-0.4, -0.3, *[-0.2] * flat]}
max = {[-0.25, 0.3, *[0.2] * flat]}
"""
    damped = pair(dim, "breakable", share * MEETS).replace(
        "kinematics", "damping = 0.2\nkinematics"
    )
    simulation = build(damped + wall, dim)
    run(simulation, 0.002)
    assert deformable(simulation) == 2
    while deformable(simulation):
        run(simulation, simulation.time + 2e-4)
        assert simulation.time < 0.012
    cracked = simulation.totals()
    assert cracked["broken_bonds"] > 0
    assert cracked["parts"] == 0
    saved, end = simulation.checkpoint(), 0.03
    other = build.again()
    check_state(other, saved, 1, 3)
    assert other.restore(saved)
    for one in (simulation, other):
        one.advance(limit=end, pause=end, max_steps=100_000)
    assert simulation.totals()["damping_work"] > cracked["damping_work"]  # it was struck again
    for key in ("position", "velocity", "damage"):
        assert np.array_equal(simulation.state()[key], other.state()[key]), key
    assert simulation.totals() == other.totals()


def test_deformable_and_rigid_bodies_beside_breakable_ones(build):
    """Three kinds in a row: a strong blow goes through all, and what is made of them is right."""
    tables = ball("a", 2, "breakable", [-0.202, 0.004], [3 * MEETS, 0])
    tables += ball("b", 2, "rigid", [-0.101, 0], [0, 0])
    tables += ball("c", 2, "elastic", [0, 0], [0, 0])
    tables += ball("d", 2, "breakable", [0.101, 0], [0, 0])
    simulation = build(tables)
    mass, momentum, _ = sums(simulation)
    run(simulation, 0.0004)
    found = simulation.fragments()
    assert {0, 3} >= set(found["number"].tolist()) - {1, 2}
    run(simulation, 0.0016)
    now = sums(simulation)
    np.testing.assert_allclose(now[1], momentum, rtol=0, atol=1e-11 * mass * MEETS)
    assert simulation.grains()["number"].tolist().count(1) == 1


REFUSED = {
    "of what does not break": ('fracture = "cohesive"', 'fracture = "none"', "does not break"),
    "too few points": ("radius = 0.05", "radius = 0.03", 'or kinematics = "rigid"'),
    "clamped": ("spin = 0.0", "clamped = 1", 'only kinematics = "elastic" has it'),
    "negative strength": ("tensile_strength = 1e6", "tensile_strength = -1", "tensile_strength"),
    "another scheme": ('scheme = "resolved"', 'scheme = "ueta2022"', "only the scheme resolved"),
    "a fluid": ('law = "solid"', 'law = "fluid"\nspeedsound = 50', "fracture"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_makes_no_sense_is_refused(tmp_path, case):
    old, new, words = REFUSED[case]
    text = TOP.format(dim=2, dp=0.01, gravity=[0, 0]) + ball("a", 2, "breakable", [0, 0], [0, 0])
    assert old in text
    if "none" in new:
        text = text.replace("tensile_strength = 1e6\nfracture_energy = 100\n", "")
    path = tmp_path / "case.toml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(UserError, match=words):
        build_scene(load_scenario(str(path)))
