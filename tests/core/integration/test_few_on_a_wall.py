"""A few particles of fluid slide along a wall without friction, Eq. (131): their own pressures must
not drive them along it.
"""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

G, SLOPE, START = 9.81, np.radians(6.0), 2.0  # m/s2, rad, m/s
SCENE = """
dim = 2
dp = 0.1
scheme = "resolved"
speed_max = 10
time_max = 3
time_out = 3
gravity = {gravity}
domain_min = {low}
domain_max = {high}

[material.debris]
based_on = "water"
rho0 = 1000
rheology = "mu_i"
mu_s = 1.0
mu_2 = 1.0
inertial_number = 0.3
grain_diameter = 0.01
grain_density = 2700
viscosity_max = 1000

[body.bed]
shape = "box"
min = {bed_low}
max = {bed_high}
material = "basalt"
fixed = true
wall = "free_slip"
normal = {normal}

[body.debris]
shape = "points"
material = "debris"
mass = 10
position = {places}
velocity = {velocity}
"""


def gains(folder, places, times, *, mirrored=False, upright=False):
    """What the middle of the particles gains in speed up to each time, over g sin(slope) t."""
    axes = np.array([[0, -1], [1, 0]] if upright else [[1, 0], [0, 1]])
    axes = axes @ np.diag([-1 if mirrored else 1, 1])

    def turned(*points):
        return np.array(points, float) @ axes.T

    def corners(*points):
        ends = turned(*points)
        return {"low": ends.min(0).tolist(), "high": ends.max(0).tolist()}

    bed = corners([-20, -0.4], [40, 0])
    text = SCENE.format(
        gravity=turned([G * np.sin(SLOPE), -G * np.cos(SLOPE)])[0].tolist(),
        bed_low=bed["low"],
        bed_high=bed["high"],
        normal=turned([0, 1])[0].tolist(),
        places=turned(*places).tolist(),
        velocity=turned([START, 0])[0].tolist(),
        **corners([-20, -1], [40, 3]),
    )
    path = folder / "few.toml"
    path.write_text(text)
    simulation = build_simulation(load_scenario(str(path)))[0]
    gained = []
    for time in times:
        simulation.advance(limit=time, pause=time, max_steps=10**9)
        velocity = simulation.state()["velocity"]
        moving = velocity[velocity.any(axis=1)]
        gained.append(((moving @ axes)[:, 0].mean() - START) / (G * np.sin(SLOPE) * time))
    return gained


@pytest.mark.parametrize("lag", [0.0, 0.02, 0.04, 0.06])
@pytest.mark.parametrize(
    "turn", [{}, {"mirrored": True}, {"upright": True}], ids=["", "mirrored", "upright"]
)
def test_a_pair_slides_as_one_particle_does(core, tmp_path, lag, turn):
    """The upper one lies behind. It was 4.4 times as fast where it lies straight above."""
    assert gains(tmp_path, [[0, 0.05], [-lag, 0.1]], [1.0], **turn) == pytest.approx([1], abs=1e-3)


@pytest.mark.parametrize("count", [3, 4, 6, 20])
def test_a_handful_is_not_driven_on(core, tmp_path, count):
    """What they gain while they find their places is all. Before, groups of four gained 1.5 times
    as much as they should and went on.
    """
    rng = np.random.default_rng(1)
    columns = int(np.ceil(np.sqrt(2 * count)))
    number = np.arange(count)
    places = np.c_[(number % columns) * 0.1, (number // columns) * 0.1 + 0.05]
    for _ in range(6):
        first, all_ = gains(tmp_path, places + rng.uniform(-0.03, 0.03, (count, 2)), [1.0, 3.0])
        assert (3 * all_ - first) / 2 == pytest.approx(1, abs=0.03)
