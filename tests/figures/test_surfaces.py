"""Shaded surfaces: what is nearer hides what is farther, and water only covers it."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.figures.space.surfaces import NOTHING, Balls, Camera, nearest_balls, render

RED, BLUE = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
ALONG_Y = Camera.looking(np.array([0.0, 1.0, 0.0]))
EXTENT = (-1.0, 1.0, -1.0, 1.0)


def balls(*each):
    """Balls (y, colour, clear) of radius 0.5 on the line of sight."""
    y, colour, clear = zip(*each, strict=True)
    n = len(y)
    position = np.stack([np.zeros(n), np.array(y, float), np.zeros(n)], axis=1)
    return Balls(position, np.full(n, 0.5), np.array(colour), np.zeros(n, bool), np.array(clear))


def middle(*each):
    return render(balls(*each), ALONG_Y, EXTENT, 101)[50, 50] / 255


def test_cameras_have_axes_at_right_angles():
    for away in ([0, 1, 0], [0, 0, -1], [0.4, 0.8, -0.5], [-3, 1, -1]):
        camera = Camera.looking(np.array(away, float))
        axes = np.stack([camera.right, camera.up, -camera.away])
        np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(axes) == pytest.approx(1)
    plan = Camera.looking(np.array([0.0, 0.0, -1.0]))
    np.testing.assert_allclose(plan.project(np.array([[1.0, 2.0, 3.0]])), [[1, 2]])


def test_each_pixel_shows_the_nearest_ball():
    points = np.array([[5.5, 5.5], [5.5, 5.5], [0.5, 0.5], [20.0, 20.0]])
    shown, depth = nearest_balls(
        points, np.array([3.0, 9.0, 1.0, 0.0]), np.array([2, 4, 0.1, 3]), (10, 10)
    )
    assert shown[5, 5] == 0
    assert depth[5, 5] == pytest.approx(3 - 2)
    assert shown[5, 9] == 1
    assert depth[5, 9] == pytest.approx(9)
    assert shown[0, 0] == 2  # a pixel at least
    assert shown[9, 9] == NOTHING
    assert (shown == 3).sum() == 0


def test_solids_hide_and_water_covers():
    alone = middle((0, RED, False))
    assert alone[0] > 0.5
    assert alone[1] == alone[2] == 0
    assert np.array_equal(middle((0, RED, False), (2, BLUE, True)), alone)  # before the water
    through = middle((0, RED, False), (-2, BLUE, True))
    assert 0.2 < through[0] < alone[0]
    assert through[2] > 0.2
    water = middle((0, BLUE, True))
    assert 0.1 < water[0] < 0.5  # the white behind it


def test_surfaces_are_shaded_by_their_slope():
    picture = render(balls((0, RED, False)), ALONG_Y, EXTENT, 101)[..., 0].astype(int)
    above, below = picture[35, 45], picture[65, 55]
    assert above > picture[50, 50] > below  # the light comes from the upper left


def test_a_plane_of_many_balls_is_even():
    x, z = (a.ravel() for a in np.meshgrid(np.arange(-2, 2, 0.1), np.arange(-2, 2, 0.1)))
    n = len(x)
    position = np.stack([x, np.zeros(n), z], axis=1)
    plane = Balls(
        position, np.full(n, 0.062), np.full((n, 3), 0.5), np.ones(n, bool), np.zeros(n, bool)
    )
    smooth = render(plane, ALONG_Y, EXTENT, 200)[30:-30, 30:-30, 0]
    rough = Balls(position, plane.radius, plane.colour, np.zeros(n, bool), plane.clear)
    bumpy = render(rough, ALONG_Y, EXTENT, 200)[30:-30, 30:-30, 0]
    assert np.ptp(smooth) < 12 < np.ptp(bumpy)


def test_faces_are_smooth_up_to_their_edges():
    """A plane of balls, and a step of it towards the viewer: neither has dark bands."""
    at = np.arange(-1.2, 1.21, 0.1)
    x, z = (grid.ravel() for grid in np.meshgrid(at, at))
    y = np.where(x < 0.0, 0.0, -1.0)
    n = len(x)
    plane = Balls(
        np.stack([x, y, z], axis=1), np.full(n, 0.05), np.ones((n, 3)), np.ones(n, bool),
        np.zeros(n, bool),
    )  # fmt: skip
    picture = render(plane, ALONG_Y, EXTENT, 200)[100, :, 0].astype(int)
    edge = int(np.argmax(np.abs(np.diff(picture))))
    near = np.r_[picture[edge - 30 : edge - 3], picture[edge + 5 : edge + 30]]
    assert np.ptp(near) < 0.1 * near.max()
