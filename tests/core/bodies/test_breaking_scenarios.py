"""Bodies that break, in scenarios: what is refused, warned about, and kept in a checkpoint."""

from __future__ import annotations

import re

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_scene
from doseki.solver.build import build_simulation, empty_simulation

CLAY = """
schema = 1
dim = 2
dp = 0.02
scheme = "resolved"
speed_max = 5
time_max = 1
time_out = 1
gravity = [0, 0]

[material.clay]
law = "solid"
rho0 = 1000
speedsound = 50
young_modulus = 1e6
poisson_ratio = 0.3
fracture = "cohesive"
tensile_strength = 2e4
fracture_energy = 16
"""
DISCS = "".join(
    f"""
[body.{name}]
shape = "disc"
material = "clay"
kinematics = "elastic"
centre = [{x}, 0]
radius = 0.1
velocity = [{speed}, 0]
"""
    for name, x, speed in (("left", -0.101, 3.0), ("right", 0.101, -3.0))
)


@pytest.fixture
def load(tmp_path):
    def load(text=CLAY + DISCS, *overrides):
        path = tmp_path / "clay.toml"
        path.write_text(text, encoding="utf-8")
        return load_scenario(str(path), list(overrides))

    return load


def run_to(simulation, time):
    simulation.advance(limit=time, pause=time, max_steps=10**9)
    return simulation.state()


def test_cracks_go_on_from_a_checkpoint_with_the_same_bits(core, load):
    scenario = load()
    simulation, names = build_simulation(scenario)
    run_to(simulation, 0.012)
    saved = simulation.checkpoint()
    assert (saved["bond_state"] != saved["bond_state"][0]).any()
    assert saved["bond_work"] > 0
    other = empty_simulation(scenario, names)
    assert other.restore(saved)
    then, now = run_to(simulation, 0.013), run_to(other, 0.013)
    for key, values in then.items():
        assert np.array_equal(values, now[key]), key


FLAWS = (
    "material.clay.fracture=grady_kipp",
    "material.clay.weibull_k=1e12",
    "material.clay.weibull_m=5",
)


@pytest.mark.parametrize(
    ("before", "override"),
    [
        ((), "material.clay.tensile_strength=1.5e4"),
        ((), "material.clay.fracture_energy=12"),
        (FLAWS, "material.clay.weibull_k=1e13"),
        (FLAWS, "material.clay.weibull_m=6"),
        (FLAWS, "body.left.flaw_seed=2"),
    ],
)
def test_keys_of_fracture_change_a_run(core, load, before, override):
    clay = CLAY.split("fracture =")[0] if before else CLAY
    positions = []
    for overrides in (before, (*before, override)):
        simulation, _ = build_simulation(load(clay + DISCS, *overrides))
        positions.append(run_to(simulation, 0.006)["position"])
    assert not np.array_equal(*positions)


@pytest.mark.parametrize("value", [np.nan, -1.0, 2.0])
def test_bonds_of_a_checkpoint_are_looked_at(core, load, value):
    scenario = load()
    simulation, names = build_simulation(scenario)
    saved = dict(simulation.checkpoint())
    saved["bond_state"] = np.full_like(saved["bond_state"], value)
    with pytest.raises((ValueError, UserError), match="bond_state"):
        empty_simulation(scenario, names).restore(saved)


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("material.clay.tensile_strength=-1", "tensile_strength"),
        ("material.clay.fracture_energy=0", "fracture_energy"),
        ("material.clay.weibull_m=-2", "weibull_m"),
        ("material.clay.fracture=grady_kipp", 'for fracture = "cohesive"'),
        ("material.clay.fracture=brittle", "grady_kipp"),
        ("material.water.fracture=cohesive", "is for solids"),
        ("body.left.radius=0.07", "needs at least 8"),
        ("body.left.radius=0.0799", ": 7.99 particles across a body that breaks"),
        ("body.left.flaw_seed=3", "no random flaws"),
    ],
)
def test_what_cannot_break_so_is_refused(load, override, said):
    with pytest.raises(UserError, match=re.escape(said)):
        build_scene(load(CLAY + DISCS, override))


@pytest.mark.parametrize("radius", [0.0785, 0.0701, 0.07, 0.06])
def test_the_spacing_that_is_advised_would_do(load, radius):
    override = f"body.left.radius={radius}"
    with pytest.raises(UserError) as refused:
        build_scene(load(CLAY + DISCS, override))
    advised = re.search(r"dp = (\S+) would do", str(refused.value))[1]
    build_scene(load(CLAY + DISCS, override, f"dp={advised}"))


BALL = """
[body.left]
shape = "sphere"
material = "clay"
kinematics = "elastic"
centre = [0, 0, 0]
radius = 0.2
"""


def test_bodies_in_space_need_eight_particles_across_too(load):
    clay = CLAY.replace("dim = 2", "dim = 3").replace("[0, 0]", "[0, 0, 0]")
    simulation, _ = build_simulation(load(clay + BALL))
    assert len(simulation.fragments()["mass"]) == 1
    with pytest.raises(UserError, match="needs at least 8"):
        build_scene(load(clay + BALL, "body.left.radius=0.07"))
    simulation, _ = build_simulation(load(clay.split("fracture =")[0] + BALL))
    assert len(simulation.fragments()["mass"]) == 0


def test_cracks_that_points_do_not_resolve_are_a_warning(load):
    assert not any("f_t^2" in str(doubt) for doubt in build_scene(load()).warnings)
    doubts = build_scene(load(CLAY + DISCS, "material.clay.fracture_energy=1.6")).warnings
    assert any("left: dp = 0.02 m, but cracks" in str(doubt) for doubt in doubts)


@pytest.mark.parametrize("preset", ["basalt", "granite", "sandstone", "concrete"])
def test_rocks_that_break(load, preset):
    text = CLAY.split("[material.clay]")[0] + f'[material.clay]\npreset = "{preset}"\n' + DISCS
    material = load(text).materials["clay"]
    assert material.fracture == ("grady_kipp" if preset == "basalt" else "cohesive")


CHOICES = {
    "cohesive": "",
    "none": "",
    "grady_kipp": "weibull_k = 1e30\nweibull_m = 7\n",
}


@pytest.mark.parametrize("preset", ["basalt", "granite", "sandstone", "concrete"])
@pytest.mark.parametrize("fracture", CHOICES)
def test_how_a_rock_breaks_can_be_chosen(load, preset, fracture):
    head, given = CLAY.split("[material.clay]")[0], CHOICES[fracture]
    keys = f'[material.clay]\npreset = "{preset}"\nfracture = "{fracture}"\n'
    material = load(head + keys + given + DISCS).materials["clay"]
    assert material.fracture == fracture
    numbers = material.of_laws
    if fracture == "cohesive":
        assert 1e6 < numbers["tensile_strength"] < 2e7
        assert 4 < numbers["fracture_energy"] < 200
    if fracture == "grady_kipp":
        assert (numbers["weibull_k"], numbers["weibull_m"]) == (1e30, 7)
        if preset == "basalt":
            assert load(head + keys + DISCS).materials["clay"].of_laws["weibull_m"] == 8.5
            return
        with pytest.raises(UserError, match="needs weibull_k"):
            load(head + keys + DISCS)
