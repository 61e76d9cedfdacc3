"""Parts of a body that broke under water have their uplift."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doseki.solver.build import empty_simulation
from doseki.validate import cases
from doseki.validate.running import Running

SIDE = 0.1  # m, of the block
WEAK = (
    "body.block.kinematics=breakable", "body.block.damping=0.3", "material.stone.fracture=cohesive",
    "material.stone.young_modulus=1e9", "material.stone.poisson_ratio=0.2",
    "material.stone.tensile_strength=1e6", "material.stone.fracture_energy=1000",
)  # fmt: skip
# What strikes the block makes it deformable, and breaks nothing of it.
PEBBLE = """
[body.pebble]
shape = { d2 = "disc", d3 = "sphere" }
material = "ground"
centre = { d2 = ["= place", "= 1.135*side"], d3 = ["= place", "= width/2", "= 1.135*side"] }
radius = "= 0.12*side"
velocity = { d2 = [0, -3], d3 = [0, 0, -3] }

[contact]
speed = 4
"""
AT_REST = 0.3, 0.5  # s


def upper(x):
    return x[:, -1] > SIDE / 2


def above_a_slant(x):
    """The crack is a staircase of points, of one up for two along."""
    return x[:, -1] > 0.3 * SIDE + 0.5 * (x[:, 0] - SIDE)


def above_teeth(x):
    """Two spacings high."""
    return x[:, -1] > SIDE / 2 + SIDE / 8 * (np.floor(8 * x[:, 0] / SIDE) % 2)


def right(x):
    return x[:, 0] > 1.5 * SIDE


def broken(folder, label, **given) -> tuple[Running, float]:
    """A block on its bed under water that has just come apart, and the mass that it had."""
    path = Path(cases.__file__).parent / "grains/block-under-water.toml"
    (folder / "pebble.toml").write_text(path.read_text(encoding="utf-8") + PEBBLE, encoding="utf-8")
    values = [f"{key}={value}" for key, value in ({"across": 16, "time_max": 1} | given).items()]
    run = Running(str(folder / "pebble.toml"), *WEAK, *values)
    run.advance(0.0008)
    state, core = run.simulation.state(), getattr(run.simulation, "_core", run.simulation)
    grains = run.grains()
    (block,) = np.flatnonzero(grains["body"] == run.body_names.index("block"))
    own = state["position"][state["grain"] == block]
    core.cut_bodies(np.ascontiguousarray(label(own), np.int32))
    return run, grains["mass"][block]


def uplift_of_parts(folder, label, **given) -> np.ndarray:
    """Of the two halves of a block, over Archimedes', in the mean."""
    run, whole = broken(folder, label, **given)
    found = [uplift(run, time, whole) for time in np.linspace(*AT_REST, 11)]
    assert {len(each) for each in found} == {2}
    return np.mean(found, axis=0)


def uplift(run: Running, time: float, whole: float) -> np.ndarray:
    """Of the parts that have a fifth of the mass of the `whole` block or more."""
    run.advance(time)
    grains, gravity = run.grains(), np.asarray(run.scenario.gravity)
    large = (grains["mass"] > 0.2 * whole) & ~grains["removed"]
    large &= grains["body"] == run.body_names.index("block")
    displaced = grains["mass"][large] / 2  # the block is twice as dense as water
    return -(grains["flow_force"][large] @ gravity) / (displaced * (gravity @ gravity))


@pytest.mark.parametrize(
    ("label", "given"),
    [
        (upper, {}),
        (upper, {"tilt": 20}),
        (above_a_slant, {}),
        (above_a_slant, {"tilt": 20}),
        (above_a_slant, {"tilt": 20, "across": 24}),
        (above_teeth, {}),
        (upper, {"dim": 3, "across": 8}),
    ],
)
def test_they_have_their_uplift(tmp_path, label, given):
    """They have slid by a part of a spacing, so that the faces of the crack do not fit."""
    found = uplift_of_parts(tmp_path, label, **given)
    np.testing.assert_allclose(found, 1.0, atol=0.3)


def test_parts_side_by_side_have_most_of_it(tmp_path):
    """They have no edges beside the crack, which (182) goes by."""
    assert uplift_of_parts(tmp_path, right).min() > 0.85


def test_without_films_they_have_not(tmp_path):
    """The control."""
    assert abs(uplift_of_parts(tmp_path, upper, uplift="false") - 1.0).max() > 1.0


def test_a_restored_run_goes_on_with_the_same_bits(tmp_path):
    run, _ = broken(tmp_path, above_a_slant)
    run.advance(0.2)
    other = empty_simulation(run.scenario, run.body_names)
    assert other.restore(run.simulation.checkpoint())
    ends = []
    for simulation in (run.simulation, other):
        simulation.advance(limit=0.21, pause=0.21, max_steps=10**6)
        ends.append(simulation.state())
    assert ends[0].keys() == ends[1].keys()
    for key, values in ends[0].items():
        np.testing.assert_array_equal(values, ends[1][key], err_msg=key)
