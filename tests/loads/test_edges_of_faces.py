"""Panels at edges of faces read the pressure of water at rest, as those away from edges do."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.solver.build import build_simulation

from .scenes import DAM, DAM_3D, run_of, scenario_of

G, H = 9810.0, 0.4
# The dam stands on the floor, and does not reach into it.
STANDING = ("body.dam.min=['= depth', 0]", "body.floor.max=['= depth + 12*dp', 0]")
PANELS = """
[gauge.{name}]
kind = "panels"
bodies = ["dam"]
origin = {origin}
edges = {edges}
panels = {panels}
direction = {direction}
interval = 0.02
"""
# In a tank that stands upright, a box under water; it turns about its lower left corner.
BOX = """
[body.right]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
normal = [-1, 0]
min = ["= 2*depth + 12*dp", "= -4*dp"]
max = ["= 2*depth + 16*dp", "= height"]
"""


def grid_on_dam(name, low, count, wide, angle=0.0):
    """Panels of the face of DAM from `low` above its foot, m, turned about the foot of the tank."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    along, up = np.array([c, s]), np.array([-s, c])
    origin, edge = H * along + low * up, count * wide * up
    return PANELS.format(name=name, origin=origin.tolist(), edges=[edge.tolist()],
                         panels=[count], direction=(-along).tolist())  # fmt: skip


def shares(run, name, height):
    """What each panel reads of the pressure in its middle, at `height` (panels,), m."""
    record = run.gauges[name]
    count = len(height)
    read = record["flow_pressure"].reshape(-1, count)
    return read[len(read) // 2 :].mean(axis=0) / (G * (H - height))


@pytest.mark.parametrize("angle", [0.0, 25.0])
@pytest.mark.parametrize("more", [(), STANDING])
def test_the_foot_of_a_dam(tmp_path, angle, more):
    """Panels of one, two and four spacings, and half a spacing off the foot; within 2 %."""
    dp = H / 20
    grids = {"one": (0, 18, 1), "two": (0, 9, 2), "four": (0, 4, 4), "off": (0.5, 8, 2)}
    text = DAM + "".join(
        grid_on_dam(name, low * dp, count, wide * dp, angle)
        for name, (low, count, wide) in grids.items()
    )
    run = run_of(tmp_path, text, "particles=20", f"angle={angle}", "time_max=0.2", *more)
    for name, (low, count, wide) in grids.items():
        height = (low + wide * (np.arange(count) + 0.5)) * dp
        np.testing.assert_allclose(shares(run, name, height), 1, atol=0.02, err_msg=name)


def test_wall_particles_at_the_foot_bear_less(tmp_path):
    """The control: what presses on those of the first row is not the pressure at their height."""
    scenario = scenario_of(tmp_path, DAM, "particles=20")
    simulation, _ = build_simulation(scenario)
    simulation.advance(limit=0.05, pause=0.05, max_steps=10_000)
    state, dp = simulation.state(), scenario.dp
    place = state["position"]
    of_dam = (place[:, 0] > H) & (place[:, 0] < H + 4 * dp)

    def share(low):
        row = of_dam & (place[:, 1] > low) & (place[:, 1] < low + dp)
        return state["force"][row, 0].sum() / (G * (H - low - dp / 2) * dp)

    assert share(0) < 0.85
    assert share(4 * dp) == pytest.approx(1, abs=0.02)


@pytest.mark.parametrize("tilt", [0.0, 25.0])
def test_edges_under_water(tmp_path, tilt):
    """Of a box that stands askew to the particles: three faces, within 3 %."""
    dp = H / 40
    c, s = np.cos(np.radians(tilt)), np.sin(np.radians(tilt))
    corner, along, up = np.array([H, 8 * dp]), np.array([c, s]), np.array([-s, c])
    faces = {
        "left": (corner, up, 8, -along),
        "bottom": (corner, along, 6, -up),
        "top": (corner + 16 * dp * up, along, 6, up),
    }
    text = DAM[: DAM.index("[gauge.dam]")] + BOX
    for name, (origin, edge, count, normal) in faces.items():
        edges = [(2 * dp * count * edge).tolist()]
        text += PANELS.format(name=name, origin=origin.tolist(), edges=edges, panels=[count],
                              direction=normal.tolist())  # fmt: skip
    keys = (
        "body.dam.min=['= depth', '= 8*dp']",
        "body.dam.max=['= depth + 12*dp', '= 24*dp']",
        f"body.dam.rotate={tilt}",
        "body.dam.pivot=['= depth', '= 8*dp']",
        "body.floor.max=['= 2*depth + 12*dp', 0]",
        "body.water.max=['= 2*depth + 12*dp', '= depth']",
        "time_max=0.4",
    )
    run = run_of(tmp_path, text, *keys)
    for name, (origin, edge, count, _) in faces.items():
        height = origin[1] + 2 * dp * (np.arange(count) + 0.5) * edge[1]
        np.testing.assert_allclose(shares(run, name, height), 1, atol=0.03, err_msg=name)


@pytest.mark.minutes
def test_foot_and_banks_in_three_dimensions(tmp_path):
    """At the floor, at both banks and in the corners; within 2 %."""
    text = DAM_3D + PANELS.format(
        name="fine", origin=[0.6, 0, 0], edges=[[0, 0.4, 0], [0, 0, 0.32]], panels=[5, 4],
        direction=[-1, 0, 0],
    )  # fmt: skip
    run = run_of(tmp_path, text, "time_max=0.1")
    height = np.repeat(0.08 * (np.arange(4) + 0.5), 5)
    np.testing.assert_allclose(shares(run, "fine", height), 1, atol=0.02)
