"""Bodies that lie on a terrain under water: their uplift, wherever they lie, and none of it dry."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from doseki.validate.cases.grains.under_water import SIDE, SUBMERGED, TERRAIN, WATER, standing

from .scenes import STONE, block_in_lake, fluid, grid, simulation_of, text

G = 9.81
CLOSE = 0.03
BOULDERS = """
[body.pond]
shape = "box"
material = "water"
min = [1.0, 1.0, 0.0]
max = [1.6, 3.0, 0.2]
[body.boulder]
shape = "box"
material = "stone"
min = [3.0, 1.5, 0.0]
max = [3.6, 2.1, 0.4]
"""


def late_uplift(*overrides, dim=2, across=10):
    """Upward force on a block on a flat terrain over the weight of what it displaces."""
    times, force = standing(
        across, SUBMERGED, f"dim={dim}", "time_max=0.4", *overrides, name=TERRAIN
    )
    return float(force[times > 0.1].mean())


def test_a_block_on_a_terrain_has_its_uplift():
    assert late_uplift() == pytest.approx(1, abs=CLOSE)


def test_without_water_between_faces_it_has_not():
    assert late_uplift("uplift=false") < -0.4


@pytest.mark.minutes
def test_the_same_in_3d(tmp_path):
    grid(tmp_path / "flat.asc", lambda x, y: 0 * x, size=(0.8, 0.8), shift=(-0.2, -0.2, 0))
    file = f'terrain.file="{tmp_path / "flat.asc"}"'
    assert late_uplift(file, "width=0.25", dim=3, across=8) == pytest.approx(1, abs=CLOSE)


def in_a_lake(folder, sign, shift=(0.0, 0.0)):
    """The force of water on a block on a slope over the weight of what it displaces, (2,)."""
    simulation, _ = simulation_of(block_in_lake(folder, sign, shift))
    forces = []
    for time in np.arange(0.2, 0.6, 0.01):
        simulation.advance(limit=time, pause=time, max_steps=10**9)
        grains = simulation.grains()
        forces.append(grains["flow_force"][~grains["fixed"]][0])
    return np.mean(forces, axis=0) / (WATER * SIDE**2 * G)


@pytest.mark.minutes
@pytest.mark.parametrize(("sign", "shift"), [(1, (0.0, 0.0)), (-1, (0.0, 0.0)), (1, (5e5, 1203.7))])
def test_a_block_on_a_slope_in_a_lake(tmp_path, sign, shift):
    """Uplift is vertical, whichever way the slope falls and wherever the map is."""
    along, up = in_a_lake(tmp_path, sign, shift)
    assert up == pytest.approx(1, abs=CLOSE)
    assert abs(along) < CLOSE


def test_walls_are_below_faces_and_a_dry_boulder_feels_nothing(tmp_path):
    """The film needs the ground below the whole body; where there is no water it does nothing."""
    grid(tmp_path / "terrain.asc", lambda x, y: 0 * x)
    path = tmp_path / "case.toml"
    path.write_text(text(3, dp=0.1, speed=2.0, more=STONE + BOULDERS))
    simulation, names = simulation_of(path)
    state = simulation.state()
    ground = state["position"][state["body"] == names.index("terrain")]
    boulder = state["position"][state["body"] == names.index("boulder")]
    face = boulder[boulder[:, 2] < 0.1]
    assert cKDTree(ground).query(face)[0].max() < 0.13, "a spacing, and what lattices differ by"
    assert not ((ground[:, 0] > 4.5) | (ground[:, 1] > 3.7)).any(), "and nowhere else"
    assert np.abs(state["position"][fluid(state)][:, 0] - 3.3).min() > 1.0
    simulation.advance(limit=0.05, pause=0.05, max_steps=10**9)
    grains = simulation.grains()
    assert not grains["flow_force"].any()
