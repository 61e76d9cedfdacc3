"""A slit dam from a file: it holds what is larger than the slit, all else goes through."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from doseki.scene.meshes.making import made_mesh

from ..flows import Flows

DP = 0.04
FLUME = """\
dim = 3
scheme = "resolved"
speed_max = 4
dp = 0.04
time_max = 3
time_out = 3
gravity = [3.36, 0, -9.22]

[contact]
law = "linear"
overlap = 0.02

[body.flume]
shape = "tank"
material = "basalt"
min = [0, 0, 0]
max = [1.6, 0.48, 0.56]
open = ["+z", "+x"]

[body.dam]
shape = "mesh"
material = "basalt"
file = "dam.stl"
enabled = {dam}

[body.large]
shape = "sphere"
material = "basalt"
radius = 0.1
centre = [0.6, 0.24, 0.1]
enabled = {boulders}

[body.small]
shape = "sphere"
material = "basalt"
radius = 0.05
centre = [0.75, 0.24, 0.05]
enabled = {boulders}

[body.water]
shape = "box"
material = "water"
min = [0, 0, 0]
max = [0.48, 0.48, 0.4]
enabled = {water}

[outflow.end]
min = [1.56, "-inf", "-inf"]
max = ["inf", "inf", "inf"]
"""


def pillar(low: float, high: float) -> trimesh.Trimesh:
    """With slanted faces up- and downstream."""
    ends = [(x, y, z) for x, z in ((0.8, -0.1), (0.9, 0.5), (1.04, 0.5), (1.1, -0.1))
            for y in (low, high)]  # fmt: skip
    return trimesh.convex.convex_hull(np.array(ends))


def run(folder: Path, time: float, **there: bool) -> Any:
    trimesh.util.concatenate([pillar(-0.1, 0.16), pillar(0.32, 0.58)]).export(folder / "dam.stl")
    switches = {"dam": True, "boulders": False, "water": False} | there
    text = FLUME.format(**{key: str(value).lower() for key, value in switches.items()})
    simulation = Flows(folder)(text)
    simulation.advance(limit=time, pause=time, max_steps=10**9)
    return simulation


def in_slit(water: np.ndarray) -> float:
    """Share of particles that is between the pillars."""
    return float((np.abs(water[:, 1] - 0.24) < 0.08).mean())


def grains(simulation: Any) -> list[tuple[float, bool]]:
    """Of the large and the small ball: how far it came along the flume, and whether it left."""
    table = simulation.grains()
    moves = ~np.asarray(table["fixed"])
    return list(zip(table["centre"][moves, 0].tolist(), table["removed"][moves], strict=True))


def test_large_boulders_are_held_and_small_ones_go_through(tmp_path):
    simulation = run(tmp_path, 1.8, boulders=True)
    (x, left), (_, small_left) = grains(simulation)
    assert not left
    # It lies against both pillars, where the slit of 0.16 m is as wide as its chord.
    assert 0.6 < x < 0.85
    assert small_left
    large = {key: np.asarray(v)[0] for key, v in simulation.grains().items() if np.ndim(v)}
    assert large["contacts"] >= 3, "the floor and the two pillars"
    assert np.linalg.norm(large["velocity"]) < 0.02


def test_without_the_dam_both_leave(tmp_path):
    assert [left for _, left in grains(run(tmp_path, 1.2, boulders=True, dam=False))] == [True] * 2


@pytest.mark.minutes
def test_water_goes_through_the_slit_and_not_through_the_pillars(tmp_path):
    simulation = run(tmp_path, 0.5, water=True)
    made = made_mesh(tmp_path / "dam.stl", 1.0, 0.0)
    state = simulation.state()
    water = state["position"][state["motion"] == 0]
    _, depth = made.shape.wall(water - made.middle, DP)
    # Water that hits a wall at 3 m/s gets between the first row of particles here and there, as it
    # does where the wall is a box; nothing goes on from there.
    assert depth.max() < 2 * DP
    assert (depth > 0.5 * DP).mean() < 0.01
    beyond = water[water[:, 0] > 1.12]
    assert len(beyond) > 20
    within = water[(water[:, 0] > 0.95) & (water[:, 0] < 1.0) & (water[:, 2] < 0.45)]
    assert len(within) > 5
    assert in_slit(within) > 0.85, "but for what is between the first rows"


@pytest.mark.minutes
def test_without_the_dam_water_goes_all_over_the_flume(tmp_path):
    """The control."""
    state = run(tmp_path, 0.5, water=True, dam=False).state()
    water = state["position"][state["motion"] == 0]
    assert in_slit(water[(water[:, 0] > 0.95) & (water[:, 0] < 1.0)]) < 0.5
