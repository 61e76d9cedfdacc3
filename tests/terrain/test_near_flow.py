"""Which wall particles of a terrain there are: those that fluid feels, and hardly any others."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from doseki.scenario.load import load_scenario
from doseki.scene.ground import ground_of
from doseki.solver.build import empty_simulation

from .scenes import fluid, grid, profile, simulation_of, step, text

LAYERS, SUPPORT = 3, 2.78  # in spacings, of the resolved scheme
FARTHEST = SUPPORT * 1.2 + 0.5 + 1.5  # what moves until the next look, slack, and one group
RELEASE = """
[body.slide]
shape = "release"
material = "water"
{place}
thickness = {thickness}
"""
PLACES = {2: "between = [0.5, 1.5]", 3: "polygon = [[1, 1.5], [2, 1.5], [2, 2.5], [1, 2.5]]"}
FALLING = """
[body.block]
shape = "box"
material = "water"
min = [1.0, {low}]
max = [1.4, {high}]
"""


def scene(folder, dim, thickness=0.3, dp=0.1):
    """A slide on a bumpy slope."""
    if dim == 2:
        profile(folder / "terrain.csv", lambda x: np.maximum(2 - 0.6 * x, 0) + 0.03 * np.sin(5 * x))
    else:
        grid(folder / "terrain.asc", lambda x, y: 3 - 0.5 * x + 0.1 * np.sin(2 * y))
    path = folder / "case.toml"
    more = RELEASE.format(place=PLACES[dim], thickness=thickness)
    path.write_text(text(dim, dp=dp, speed=6.0, more=more))
    return path


def whole_bed(path, settings=()):
    """Every wall particle that the ground could have, (n, dim)."""
    scenario = load_scenario(path, settings)
    bed, ground, dp = scenario.bed, ground_of(scenario.bed), scenario.dp
    side = (16 if scenario.dim == 2 else 8) * dp
    first = bed.origin - side
    counts = np.ceil((bed.extent[1] + side - first) / side).astype(int)
    found = []
    for index in np.ndindex(*counts):
        for layer in range(LAYERS):
            depth = (layer + 0.5) * dp
            place, _ = ground.tile((first + side * np.array(index)).tolist(), side, dp, -depth)
            found.append(ground.above(place, np.full(len(place), -depth)))
    return np.concatenate(found)


def gaps(state, names, bed, dp):
    """Distances, in spacings, from the flow: of particles that there are, and of those missing."""
    wall = state["body"] == names.index("terrain")
    flow = cKDTree(state["position"][fluid(state)])
    near = flow.query(bed)[0] / dp
    there = cKDTree(state["position"][wall]).query(bed)[0] < 1e-9
    assert wall.sum() == there.sum()
    return near[there], near[~there]


@pytest.mark.parametrize("dim", [2, 3])
def test_all_that_fluid_feels_is_there_and_little_else(tmp_path, dim):
    path = scene(tmp_path, dim)
    bed = whole_bed(path)
    simulation, names = simulation_of(path)
    for _ in range(25):
        step(simulation, 6)
        there, missing = gaps(simulation.state(), names, bed, 0.1)
        assert missing.min() > SUPPORT
        assert there.max() < FARTHEST


def test_what_falls_side_by_side_finds_a_bed(tmp_path):
    """Its lists do not wear out on the way."""
    profile(tmp_path / "terrain.csv", lambda x: 0 * x)
    path = tmp_path / "case.toml"
    path.write_text(text(2, dp=0.05, speed=6.0, more=FALLING.format(low=1.0, high=1.4)))
    bed = whole_bed(path)
    simulation, names = simulation_of(path)
    assert (simulation.state()["body"] != names.index("terrain")).all()
    while simulation.state()["position"][:, 1].min() > 0.05:
        step(simulation, 1)
        state = simulation.state()
        if (state["body"] == names.index("terrain")).any():
            assert gaps(state, names, bed, 0.05)[1].min() > SUPPORT
        else:
            assert state["position"][:, 1].min() > (SUPPORT - 0.5) * 0.05


def test_a_drop_holds_few_wall_particles(tmp_path):
    grid(tmp_path / "terrain.asc", lambda x, y: 0 * x)
    path = tmp_path / "case.toml"
    drop = "polygon = [[2, 2], [2.1, 2], [2.1, 2.1], [2, 2.1]]"
    path.write_text(text(3, dp=0.1, more=RELEASE.format(place=drop, thickness=0.1)))
    simulation, names = simulation_of(path)
    state = simulation.state()
    assert fluid(state).sum() == 1
    felt = 4 / 3 * np.pi * SUPPORT**3 / 2
    assert felt < (state["body"] == names.index("terrain")).sum() < 5 * felt


def test_what_trembles_makes_and_drops_nothing(tmp_path):
    """Water at rest in a hollow keeps its wall particles."""
    profile(tmp_path / "terrain.csv", lambda x: 0.1 * (x - 3) ** 2)
    path = tmp_path / "case.toml"
    lake = FALLING.replace("[1.0, {low}]", "[2.0, 0.0]").replace("[1.4, {high}]", "[4.0, 0.1]")
    path.write_text(text(2, dp=0.02, speed=2.0, more=lake))
    simulation, _ = simulation_of(path)
    step(simulation, 300)
    last = int(simulation.state()["id"].max())
    step(simulation, 300)
    added = int(simulation.state()["id"].max()) - last
    assert added < 0.05 * len(simulation)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_run_that_is_restored_adds_the_same_particles(tmp_path, dim):
    path = scene(tmp_path, dim)
    simulation, names = simulation_of(path)
    step(simulation, 60)
    other = empty_simulation(load_scenario(path), names)
    assert other.restore(simulation.checkpoint())
    for each in (simulation, other):
        step(each, 120)
    a, b = simulation.state(), other.state()
    assert all(np.array_equal(a[key], b[key]) for key in a)
