"""Points of polygons and polyhedra that deform: inside, about their centre, none alone in a tip."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from doseki.scenario.load import load_scenario
from doseki.scene.shapes.making import polygon_shape
from doseki.solver.build import build_simulation

TEXT = """
schema = 1
dim = 2
dp = {dp}
scheme = "resolved"
speed_max = 15
time_max = 1
time_out = 1
gravity = [0, 0]

[material.rock]
preset = "sandstone"

[body.stone]
shape = "polygon"
material = "rock"
kinematics = "{kinematics}"
vertices = {vertices}
velocity = [3, 1]
spin = 40
"""
TIP = np.array([[0, 0], [0.1, 0], [0.02, 0.03]])


def polygons(count: int):
    """Convex hulls of seven random points in a square of 10 cm."""
    random = np.random.default_rng(1)
    for _ in range(count):
        points = random.uniform(-0.05, 0.05, (7, 2))
        yield points[ConvexHull(points).vertices].round(5)


def simulation_of(folder, vertices: np.ndarray, dp: float, kinematics: str = "breakable"):
    path = folder / "stone.toml"
    text = TEXT.format(dp=dp, kinematics=kinematics, vertices=vertices.tolist())
    path.write_text(text, encoding="utf-8")
    return build_simulation(load_scenario(str(path)))[0]


@pytest.mark.parametrize("dp", [0.004, 0.0025, 0.00125])
def test_any_polygon_may_break(tmp_path, dp):
    """Half of them had a point that lay outside by a part of dp, so that no cells could be made."""
    for vertices in polygons(12):
        simulation_of(tmp_path, vertices, dp)


@pytest.mark.parametrize("turn", [0, 33])
def test_points_lie_inside_and_about_the_centre(turn):
    angle = np.radians(turn)
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    for vertices in [*polygons(20), TIP]:
        shape, _ = polygon_shape(vertices @ rotation.T)
        points = shape.elastic_particles(0.002)
        assert points.depth.min() > 0.1 * 0.002
        np.testing.assert_allclose(points.position.mean(axis=0), 0, atol=1e-15)
        assert points.share.sum() == pytest.approx(1)
        assert len(points.share) * 0.002**2 == pytest.approx(shape.measure, rel=0.03)


@pytest.mark.parametrize("kinematics", ["breakable", "elastic"])
def test_a_polygon_in_free_flight_keeps_its_momentum(tmp_path, kinematics):
    simulation = simulation_of(tmp_path, next(polygons(1)), 0.004, kinematics)

    def momentum():
        state = simulation.state()
        return state["mass"] @ state["velocity"]

    before = momentum()
    simulation.advance(limit=0.01, pause=0.01, max_steps=10**6)
    np.testing.assert_allclose(momentum(), before, rtol=0, atol=1e-12 * np.abs(before).max())


def test_a_sharp_corner_is_filled_as_far_as_points_hold(tmp_path):
    """Its tip of 17 degrees has points in a row, which tell no deformation."""
    shape, _ = polygon_shape(TIP)
    rigid, elastic = shape.particles(0.002), shape.elastic_particles(0.002)
    assert 0 < len(rigid.share) - len(elastic.share) < 0.03 * len(rigid.share)
    simulation = simulation_of(tmp_path, TIP, 0.002, "elastic")
    simulation.advance(limit=1e-4, pause=1e-4, max_steps=10**6)
    assert np.isfinite(simulation.state()["velocity"]).all()


@pytest.mark.parametrize("far", [0.0, 2.0**20])
def test_a_polygon_at_the_coordinates_of_a_map(far):
    """Its vertices are rounded there, and no more than that."""
    for vertices in polygons(5):
        shape, centre = polygon_shape(vertices + far)
        near, middle = polygon_shape(vertices)
        assert shape.measure == pytest.approx(near.measure, rel=1e-7)
        np.testing.assert_allclose(centre - far, middle, atol=1e-9)
        assert len(shape.elastic_particles(0.003).share) == len(near.elastic_particles(0.003).share)
