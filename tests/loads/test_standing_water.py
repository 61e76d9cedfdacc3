"""Water that stands around bodies: the static part of its force."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from doseki.driver.gauges import build_gauges
from doseki.record.particles import FIXED, FREE
from doseki.scenario.gauges.loads import profiles as looks
from doseki.scenario.gauges.loads.standing_water import standing_water, surface_of
from doseki.scenario.gauges.near import MIN_VOID, REACH, Column, kernel
from doseki.solver.build import build_simulation

from .scenes import scenario_of

G = 9.81
DOWN = "[0, -9.81]"
# A body within a tank of still water.
POOL = """\
dim = {dim}
dp = 0.02
time_max = 1
time_out = 1
scheme = "resolved"
speed_max = 3
gravity = {{ d2 = {gravity}, d3 = [0, 0, -9.81] }}

[body.tank]
shape = "tank"
material = "aluminium"
min = {{ d2 = [0, 0], d3 = [0, 0, 0] }}
max = {{ d2 = [0.8, 0.8], d3 = [0.6, 0.6, 0.6] }}

[body.stone]
material = "basalt"
fixed = true
{stone}

[body.water]
shape = "box"
material = "water"
min = {{ d2 = [0, 0], d3 = [0, 0, 0] }}
max = {{ d2 = [0.8, {level}], d3 = [0.6, 0.6, {level}] }}

[gauge.stone]
kind = "load"
bodies = ["stone"]
about = {{ d2 = [0.4, 0.3], d3 = [0.3, 0.3, 0.24] }}
"""


def static_of(folder, dim, stone, level, gravity="[0, -9.81]"):
    """Static force and moment on the stone at the start."""
    text = POOL.format(dim=dim, stone=stone, level=level, gravity=gravity)
    scenario = scenario_of(folder, text)
    simulation, names = build_simulation(scenario)
    (reader,) = build_gauges(scenario, names)
    far = np.full(dim, np.inf)
    found = reader.gauge.static(simulation, reader.setting, (-far, far))
    return found[:dim], found[dim:]


@pytest.mark.parametrize("turned", [0, 20])
def test_a_box_under_water_has_its_uplift(tmp_path, turned):
    """In 2-D, the weight of the water whose place it takes; also where it is turned."""
    stone = (
        f'shape = "box"\nmin = [0.3, 0.2]\nmax = [0.5, 0.4]\nrotate = {turned}\npivot = [0.4, 0.3]'
    )
    force, moment = static_of(tmp_path, 2, stone, 0.7)
    uplift = 1000 * G * 0.2**2
    assert force[1] == pytest.approx(uplift, rel=0.03)
    assert abs(force[0]) < 0.03 * uplift
    assert abs(moment[0]) < 0.03 * uplift * 0.2


def test_a_cube_under_water_has_its_uplift(tmp_path):
    """And its edges and corners count in full: without them 7 % would be missing."""
    stone = 'shape = "box"\nmin = [0.2, 0.2, 0.14]\nmax = [0.4, 0.4, 0.34]'
    force, moment = static_of(tmp_path, 3, stone, 0.54)
    uplift = 1000 * G * 0.2**3
    assert force[2] == pytest.approx(uplift, rel=0.03)
    assert np.abs(force[:2]).max() < 0.03 * uplift
    assert np.abs(moment).max() < 0.03 * uplift * 0.2


def test_a_disc_under_water_has_its_uplift(tmp_path):
    """Its rows are shorter than its surface, by dp/2R: 8 % here."""
    force, _ = static_of(tmp_path, 2, 'shape = "disc"\ncentre = [0.4, 0.3]\nradius = 0.12', 0.7)
    uplift = 1000 * G * np.pi * 0.12**2
    assert force[1] == pytest.approx(uplift, rel=0.02)
    assert abs(force[0]) < 0.03 * uplift


def test_what_another_wall_covers_has_no_water(tmp_path):
    """A block touches the face of the stone, up to 0.3 m of its 0.4 m."""
    stone = 'shape = "box"\nmin = [0.4, 0]\nmax = [0.5, 0.4]\nnormal = [1, 0]\n'
    block = '[body.block]\nmaterial = "basalt"\nfixed = true\nshape = "box"\n'
    block += "normal = [0, 1]\nmin = [0.5, 0]\nmax = [0.8, 0.3]\n"
    level, low, top = 0.6, 0.3, 0.4
    force, _ = static_of(tmp_path, 2, stone + block, level)
    thrust = 0.5 * 1000 * G * ((level - low) ** 2 - (level - top) ** 2)
    assert force[0] == pytest.approx(-thrust, rel=0.01)
    assert abs(force[1]) < 1e-9 * thrust


ACROSS = 'shape = "box"\nmin = [0.4, 0, 0]\nmax = [0.6, 0.6, 0.5]\n'
ROCK = """
[body.rock]
material = "basalt"
shape = "box"
min = [0.28, 0.24, {bottom}]
max = [{face}, 0.36, 0.42]
"""


@pytest.mark.parametrize(("bottom", "gap"), [(0, 0), (0.1, 0), (0, 0.02)])
def test_a_rock_in_front_is_no_water(tmp_path, bottom, gap):
    """It leans on a dam and stands out of the water, to twice its depth."""
    level = 0.2
    alone, _ = static_of(tmp_path, 3, ACROSS, level)
    (tmp_path / "rock").mkdir()
    rock = ROCK.format(bottom=bottom, face=0.4 - gap)
    force, _ = static_of(tmp_path / "rock", 3, ACROSS + rock, level)
    assert alone[0] == pytest.approx(0.5 * 1000 * G * level**2 * 0.6, rel=0.03)
    assert force[0] == pytest.approx(alone[0], rel=0.03)


def test_rocks_on_dry_ground_are_none(tmp_path):
    """Some water is far below the place where they lean on the dam."""
    rock = ROCK.format(bottom=0.2, face=0.4)
    alone, _ = static_of(tmp_path, 3, ACROSS, 0.06)
    (tmp_path / "rock").mkdir()
    force, _ = static_of(tmp_path / "rock", 3, ACROSS + rock, 0.06)
    assert force[0] == pytest.approx(alone[0], rel=0.03)


def test_half_of_it_under_water(tmp_path):
    """Only what is below the level counts, and level water pushes no way."""
    stone = 'shape = "box"\nmin = [0.3, 0.1]\nmax = [0.5, 0.5]'
    force, _ = static_of(tmp_path, 2, stone, 0.3)
    uplift = 1000 * G * 0.2 * 0.2
    assert force[1] == pytest.approx(uplift, rel=0.06)
    assert abs(force[0]) < 0.02 * uplift


def test_without_water_or_gravity_there_is_none(tmp_path):
    stone = 'shape = "box"\nmin = [0.3, 0.4]\nmax = [0.5, 0.6]'
    force, moment = static_of(tmp_path, 2, stone, 0.2)
    assert not force.any()
    assert not moment.any()
    (tmp_path / "weightless").mkdir()
    force, _ = static_of(tmp_path / "weightless", 2, stone, 0.7, gravity="[0, 0]")
    assert not force.any()


class Moved:
    """A run whose particles all lie elsewhere."""

    def __init__(self, run, by):
        self.run, self.by = run, by

    def sample(self, low, high):
        state = self.run.sample(list(low - self.by), list(high - self.by))
        return {**state, "position": state["position"] + self.by}


@pytest.mark.parametrize("dim", [2, 3])
def test_it_does_not_matter_where_the_scene_lies(tmp_path, dim):
    stones = {
        2: 'shape = "box"\nmin = [0.3, 0.2]\nmax = [0.5, 0.5]\nrotate = 30\npivot = [0.4, 0.3]',
        3: 'shape = "box"\nmin = [0.2, 0.2, 0.14]\nmax = [0.4, 0.4, 0.34]',
    }
    text = POOL.format(dim=dim, stone=stones[dim], level=0.3, gravity="[0.5, -9.81]")
    scenario = scenario_of(tmp_path, text)
    simulation, names = build_simulation(scenario)
    setting, far = scenario.setting(names), np.full(dim, np.inf)

    def found(by):
        about = np.full(dim, 0.2) + by
        moved = Moved(simulation, by)
        return np.concatenate(standing_water(moved, setting, ["stone"], about, (-far, far)))

    expected = found(np.zeros(dim))
    assert np.abs(expected[:dim]).max() > 10
    random = np.random.default_rng(3)
    shifts = [*(0.01 * np.eye(dim)), *random.uniform(-1500, 1500, (6, dim))]
    for shift in shifts:
        scale = np.abs(expected).max()
        np.testing.assert_allclose(found(shift), expected, rtol=0, atol=1e-6 * scale)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_surface_is_closed_and_has_its_area(tmp_path, dim):
    """Faces, edges and corners of a box add up to nothing as vectors; their sizes to its faces."""
    stones = {
        2: 'shape = "box"\nmin = [0.3, 0.2]\nmax = [0.5, 0.4]',
        3: 'shape = "box"\nmin = [0.2, 0.2, 0.14]\nmax = [0.4, 0.4, 0.34]',
    }
    text = POOL.format(dim=dim, stone=stones[dim], level=0.54, gravity="[0, -9.81]")
    scenario = scenario_of(tmp_path, text)
    simulation, names = build_simulation(scenario)
    far = np.full(dim, np.inf)
    surface = surface_of(simulation, scenario.setting(names), ["stone"], (-far, far))
    np.testing.assert_allclose(surface.area.sum(axis=0), 0, atol=1e-12)
    sides = np.maximum(surface.area, 0).sum(axis=0)
    np.testing.assert_allclose(sides, 0.2 ** (dim - 1), rtol=1e-9)


def test_a_sphere_has_its_surface(tmp_path):
    text = POOL.format(
        dim=3, level=0.54, gravity="[0, -9.81]",
        stone='shape = "sphere"\ncentre = [0.3, 0.3, 0.24]\nradius = 0.14',
    )  # fmt: skip
    scenario = scenario_of(tmp_path, text)
    simulation, names = build_simulation(scenario)
    far = np.full(3, np.inf)
    surface = surface_of(simulation, scenario.setting(names), ["stone"], (-far, far))
    sizes = np.linalg.norm(surface.area, axis=1)
    assert sizes.sum() == pytest.approx(4 * np.pi * 0.14**2, rel=0.02)


LAYERS = """\
dim = 2
dp = 0.01
time_max = 1
time_out = 1
scheme = "resolved"
speed_max = 3
gravity = {gravity}
[material.oil]
based_on = "water"
rho0 = {oil}
[body.tank]
shape = "tank"
material = "aluminium"
min = [0, 0]
max = [0.6, 0.6]
[body.low]
shape = "box"
material = "water"
min = {low[0]}
max = {low[1]}
[body.high]
shape = "box"
material = "oil"
min = {high[0]}
max = {high[1]}
[gauge.side]
kind = "load"
bodies = ["tank.{side}"]
about = {about}
"""
# How heights above the floor and distances from a side lie in the tank, and what is that side.
WAYS = {
    "down": (lambda s, z: [s, z], [0, -G], "-x"),
    "up": (lambda s, z: [s, 0.6 - z], [0, G], "-x"),
    "left": (lambda s, z: [z, s], [-G, 0], "-y"),
    "right": (lambda s, z: [0.6 - z, s], [G, 0], "-y"),
}


def thrust_of_layers(folder, way, oil):
    """Of 0.2 m of a liquid over 0.2 m of water: thrust on a side, and its arm above the floor."""
    place, gravity, side = WAYS[way]
    corners = {
        name: np.sort([place(0, low), place(0.6, low + 0.2)], axis=0).tolist()
        for name, low in (("low", 0.0), ("high", 0.2))
    }
    about = place(0, 0)
    text = LAYERS.format(gravity=gravity, oil=oil, side=side, about=about, **corners)
    scenario = scenario_of(folder, text)
    simulation, names = build_simulation(scenario)
    (reader,) = build_gauges(scenario, names)
    far = np.full(2, np.inf)
    force = reader.gauge.static(simulation, reader.setting, (-far, far))
    thrust = float(np.abs(force[:2]).max())
    return thrust, abs(force[2]) / thrust


@pytest.mark.parametrize("way", WAYS)
def test_layers_press_with_what_lies_above_each_height(tmp_path, way):
    """The mean density of the column times the depth would be 19 % too much."""
    thrust, arm = thrust_of_layers(tmp_path, way, oil=500)
    upper, middle, lower = 500 * G * 0.2**2 / 2, 500 * G * 0.2**2, 1000 * G * 0.2**2 / 2
    total = upper + middle + lower
    assert thrust == pytest.approx(total, rel=0.005)
    expected = (upper * (0.2 + 0.2 / 3) + middle * 0.1 + lower * 0.2 / 3) / total
    assert arm == pytest.approx(expected, rel=0.01)


def test_layers_of_one_density_are_one_liquid(tmp_path):
    thrust, arm = thrust_of_layers(tmp_path, "down", oil=1000)
    assert thrust == pytest.approx(1000 * G * 0.4**2 / 2, rel=0.005)
    assert arm == pytest.approx(0.4 / 3, rel=0.01)


def test_where_nothing_is_near_no_surface_is_looked_at(tmp_path):
    """Water that is far below the stone: one look around it is all."""
    stone = 'shape = "box"\nmin = [0.3, 0.5]\nmax = [0.5, 0.6]'
    scenario = scenario_of(tmp_path, POOL.format(dim=2, stone=stone, level=0.1, gravity=DOWN))
    simulation, names = build_simulation(scenario)
    (reader,) = build_gauges(scenario, names)
    counted = Counted(simulation)
    box = np.array([0.28, 0.48]), np.array([0.52, 0.62])
    assert not reader.gauge.static(counted, reader.setting, box).any()
    assert counted.looks == 1


class Counted:
    """A run that counts the looks at it."""

    def __init__(self, run):
        self.run, self.looks = run, 0

    def sample(self, low, high):
        self.looks += 1
        return self.run.sample(low, high)


@pytest.mark.parametrize("dim", [2, 3])
def test_lines_are_looked_at_together_and_as_one_by_one(dim, monkeypatch):
    random, dp, lowest, n = np.random.default_rng(4), 0.1, 0.3, 400
    up = np.eye(dim)[-1]
    position = random.uniform(0, 1, (n, dim)) + 5e6 * (1 - up)
    around = {
        "position": position, "mass": np.full(n, 900.0 * dp**dim), "density": np.full(n, 1000.0),
        "motion": np.where(random.uniform(size=n) < 0.3, FIXED, FREE), "material": np.zeros(n, int),
    }  # fmt: skip
    plan = random.uniform(0, 1, (40, dim)) * (1 - up) + 5e6 * (1 - up)
    calls = []
    monkeypatch.setattr(looks, "kernel", lambda *given: (calls.append(1), kernel(*given))[1])
    setting = SimpleNamespace(dp=dp, dim=dim)
    found = looks.profiles(plan, around, setting, up, lowest)
    assert len(calls) == 2  # of walls, and of what flows
    for k, foot in enumerate(plan):
        away = position - foot
        near = np.linalg.norm(away - np.outer(away @ up, up), axis=1) < REACH * dp
        shares = []
        for chosen in (near & (around["motion"] == FIXED), near & (around["motion"] == FREE)):
            volume = np.full(chosen.sum(), 0.9 * dp**dim)
            column = Column(position[chosen], volume, foot + lowest * up, up)
            heights = found.height - lowest
            shares.append(np.array([column.filled(s, REACH * dp, dim) for s in heights]))
        filled = shares[1] / np.maximum(1 - shares[0], MIN_VOID)
        below = heights <= column.along.max() + REACH * dp
        assert found.wall[k, below] == pytest.approx(shares[0][below], abs=1e-6)
        assert found.filled[k] == pytest.approx(filled, abs=1e-6)
