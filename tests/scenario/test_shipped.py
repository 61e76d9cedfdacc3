"""Every shipped scenario loads and builds, and holds what its description says."""

import numpy as np
import pytest
from tests.shipped import CASES, NAMES, PARTS

from doseki.record.particles import FIXED
from doseki.scenario.load import list_scenarios, load_scenario
from doseki.scene.build import build_bodies, build_scene
from doseki.scene.inflow_sections import build_inflows

# What a scenario is told, and its page of the gallery or its description explains.
EXPECTED = {
    "breaking-flume": "4 particles across its bodies",
    "elastic-gate": "3 particles across an elastic body",
    "flume-3d": "particles across its bodies",
    "flume-strip": "4 particles across its bodies",
}


def test_the_list():
    assert {"collision", "flume", "flume-strength", "dambreak"} <= set(NAMES)
    assert {"film", "hang", "shear-wave"} <= set(NAMES)
    assert all(title for _, title, _ in list_scenarios())


@pytest.mark.parametrize(("name", "dim"), CASES)
def test_loads_and_builds(name, dim):
    scenario = load_scenario(name, [f"dim={dim}", *PARTS.get(name, [])])
    scene = build_scene(scenario)
    particles = scene.particles
    build_inflows(scenario, scene.names)
    told = [str(warning) for warning in scene.warnings]
    assert [each for each in told if EXPECTED.get(name, "\n") not in each] == []
    assert particles.dim == dim
    assert len(np.unique(particles.id)) == len(particles)
    for values in (particles.position, particles.velocity, particles.smoothing_length):
        assert np.isfinite(values).all()


@pytest.mark.parametrize("name", NAMES)
def test_resolution_can_be_changed(name):
    part = PARTS.get(name, [])
    finer = f"dp={0.5 * load_scenario(name, part).dp}"
    particles, _ = build_bodies(load_scenario(name, [*part, finer, "time_out=0.5", "eta=1.3"]))
    assert len(particles) > 0


@pytest.mark.parametrize(("per_grain", "mass"), [(1, 0.2159845), (793, 793 * 2750 * 3.125e-4**2)])
def test_collision_in_2d(per_grain, mass):
    scenario = load_scenario("collision", [f"particles_per_grain={per_grain}"])
    particles, names = build_bodies(scenario)
    assert names == ["left", "right"]
    assert len(particles) == 2 * per_grain
    assert scenario.xi == pytest.approx(60 / 3116)
    for body, (centre, velocity) in enumerate([(-0.0125, 0), (0.0125, -6)]):
        mine = particles.body == body
        np.testing.assert_allclose(particles.position[mine].mean(axis=0), [centre, 0], atol=1e-15)
        np.testing.assert_array_equal(particles.velocity[mine, 0], velocity)
        assert particles.mass[mine].sum() == pytest.approx(mass, rel=1e-6)


def test_collision_in_3d():
    single, _ = build_bodies(load_scenario("collision", ["dim=3"]))
    np.testing.assert_allclose(single.mass, 2750 * np.pi / 6 * 1e-6)
    many, _ = build_bodies(load_scenario("collision", ["dim=3", "particles_per_grain=793"]))
    assert len(many) == 2 * 17071


@pytest.mark.parametrize("dim", [2, 3])
def test_flume_load_weighs_20_kg(dim):
    scenario = load_scenario("flume", [f"dim={dim}", "jitter=0"])
    particles, names = build_bodies(scenario)
    load = particles.body == names.index("load")
    total = 20 / 0.1 if dim == 2 else 20
    assert particles.mass[load].sum() == pytest.approx(total, rel=1e-3)
    x = particles.position[load]
    assert x[:, 0].min() == pytest.approx(3.5, abs=scenario.dp)
    assert x[:, 0].max() == pytest.approx(4.76, abs=1.5 * scenario.dp)
    assert x[:, -1].min() == pytest.approx(scenario.dp / 2)


@pytest.mark.parametrize("setting", ["board_drop=0", "board_drop=0.25"])
def test_flume_board_is_horizontal_and_joins_the_bed_or_lies_below(setting):
    scenario = load_scenario("flume", [setting])
    particles, names = build_bodies(scenario)
    board = particles.position[particles.body == names.index("board")]
    bed = particles.position[particles.body == names.index("bed")]
    dp, drop = scenario.dp, scenario.constants["drop"]
    assert drop == pytest.approx(float(setting.split("=")[1]), abs=dp / 2)
    height = -(board @ scenario.gravity) / np.linalg.norm(scenario.gravity)
    top = height > height.max() - 0.5 * dp
    np.testing.assert_allclose(height[top], -drop - dp / 2)
    length = scenario.constants["board_length"] + drop
    assert top.sum() == pytest.approx(length / dp, abs=1)
    if not drop:
        gap = np.linalg.norm(board[:, None] - bed[bed[:, 0] < 0.1], axis=-1).min()
        assert 0.9 * dp < gap < 1.3 * dp
    assert (particles.motion[particles.body == names.index("board")] == FIXED).all()
    # Nothing of the flume starts in an outflow.
    for outflow in scenario.outflow.values():
        inside = (particles.position > outflow.min) & (particles.position < outflow.max)
        assert not inside.all(axis=1).any()


def test_flume_strength_extends_flume():
    plain, strong = load_scenario("flume"), load_scenario("flume-strength", ["width=0.2"])
    assert (plain.strength, strong.strength) == (False, True)
    assert strong.constants["grains"] == pytest.approx(plain.constants["grains"] / 2, abs=1)
    assert strong.xi == plain.xi == 0.05


def test_shear_wave_starts_as_a_sine():
    scenario = load_scenario("shear-wave", ["amplitude=2"])
    particles, _ = build_bodies(scenario)
    assert len(particles) == 1600
    y = particles.position[:, 1]
    np.testing.assert_allclose(particles.velocity[:, 0], 2 * np.sin(2 * np.pi * y / 0.4))
    assert not particles.velocity[:, 1].any()
