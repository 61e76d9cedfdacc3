"""Runs to report on: on a map, with bodies, in the plane."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image
from tests.synthetic_runs import BODIES, MATERIALS, SCENARIO, history_row, make_plain_state

from doseki.record.writer import Recorder

CORNER = np.array([460000.0, 5200000.0, 1500.0])  # m, on a map
WATER = '\n[material.water]\nlaw = "fluid"\nrho0 = 1000.0\n'
BODY = '\n[body.grain]\nshape = "{shape}"\nkinematics = "{kinematics}"\n'


def block(sizes, start=(0.0, 0.0, 0.0)):
    """Particles on a lattice of 0.1 m, `sizes` of them along each axis."""
    axes = np.meshgrid(*map(np.arange, sizes), indexing="ij")
    return 0.1 * (np.stack(axes, axis=-1).reshape(-1, len(sizes)) + 0.5) + start[: len(sizes)]


def map_state(time):
    """Water that moves 1 m/s along x over a bed, and a cube that turns about z."""
    water = block((8, 6, 5)) + np.array([time, 0.0, 0.0])
    bed = block((30, 6, 2), (0.0, 0.0, -0.2))
    cube = block((3, 3, 3), (-0.15, -0.15, -0.15))
    angle = time
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    centre = np.array([2.5, 0.3, 0.2])
    position = np.concatenate([water, bed, cube @ turn.T + centre]) + CORNER
    kind = np.repeat([0, 2, 1], [len(water), len(bed), len(cube)])
    velocity = np.zeros_like(position)
    velocity[: len(water), 0] = np.linspace(0.5, 1.5, len(water))
    state = make_plain_state(position, velocity, kind)
    state["density"] = np.array([1000.0, 2600.0, 2600.0])[kind]
    state["mass"] = 0.001 * state["density"]
    state["pressure"] = 9810.0 * (0.5 - (position[:, 2] - CORNER[2]))
    state["grain"] = np.where(kind == 1, 0, -1)
    return state, grain_table(centre + CORNER, angle)


def grain_table(centre, angle):
    """One body at `centre`, turned by `angle` about z."""
    dim = len(centre)
    return {
        "position": np.array([centre]),
        "velocity": np.zeros((1, dim)),
        "spin": np.array([[0.0, 0.0, 1.0]]),
        "orientation": np.array([[np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)]]),
        "diameter": np.array([0.3 * np.sqrt(3)]),
        "mass": np.array([70.0]),
        "contacts": np.array([0], np.int32),
        "overlap": np.zeros(1),
        "removed": np.array([0], np.int32),
        "parent": np.array([-1], np.int32),
        "born": np.zeros(1),
        "body": np.array([1], np.int32),
    }


def give_figure(folder):
    """A small picture among the figures of a run, so that none are drawn."""
    (folder / "figures").mkdir()
    Image.new("RGB", (40, 30), "navy").save(folder / "figures" / "overview.png")


@pytest.fixture
def drawn_flow(flow_folder):
    """The folder of the run of flow_state, whose figures are there."""
    give_figure(flow_folder)
    return flow_folder


@pytest.fixture
def map_run(tmp_path):
    """The folder of a 3-D run on a map: five snapshots, water, a bed, a cube."""
    return record_map(tmp_path / "map", "box")


def record_map(path, shape, frames=5, kinematics="rigid"):
    """Write that run, with a body of some shape that may be deformable."""
    text = SCENARIO.format(dim=3, zeros="0.0, ").replace("[-1.0", "[0.0")
    recorder = Recorder(
        path, text + WATER + BODY.format(shape=shape, kinematics=kinematics), MATERIALS, BODIES, 3
    )
    for k in range(frames):
        state, grains = map_state(0.25 * k)
        recorder.snapshot(state, time=0.25 * k, step=k, dt=0.1, grains=grains)
        recorder.history(history_row(0.25 * k))
    recorder.close({"status": "done", "warnings": ["the <b>bed</b> is thin"]} | history_row(1.0))
    give_figure(path)
    return path
