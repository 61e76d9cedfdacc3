"""Surfaces around known bodies of particles."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from doseki.errors import UserError
from doseki.export.surface.fraction import weight
from doseki.export.surface.values import interpolated

from .clouds import KERNEL, ball, cloud_of, lattice, surface

MAP = np.array([2_600_000.25, 1_200_000.5, 430.125])


def as_mesh(found):
    return trimesh.Trimesh(found.points, found.faces, process=False)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("kernel", ["wendland_c2", "wendland_c6"])
def test_a_kernel_integrates_to_one(kernel, dim):
    share = (np.arange(4000) + 0.5) / 4000
    ring = {2: 2 * np.pi * share, 3: 4 * np.pi * share**2}[dim]
    assert np.sum(ring * weight(kernel, share, dim)) / 4000 == pytest.approx(1, abs=1e-6)


def box_errors(dp, level=0.5):
    found = surface(lattice([0, 0, 0], [1, 0.8, 0.6], dp), dp, level=level)
    return found.volume / 0.48 - 1, found.area / 3.76 - 1


def test_area_and_volume_of_a_box_converge():
    """Edges are rounded over the reach of the kernel: area is lost to first order."""
    errors = np.abs([box_errors(dp) for dp in (0.1, 0.05, 0.025)])
    volume, area = errors.T
    assert volume[-1] < 0.006
    assert area[-1] < 0.05
    for error in (volume, area):
        assert np.all(error[1:] < 0.6 * error[:-1])


def test_another_level_is_another_volume():
    volume, _ = box_errors(0.05, level=0.1)
    assert volume > 0.15


@pytest.mark.parametrize("dim", [2, 3])
def test_a_ball_has_its_volume(dim):
    found = surface(ball(1 / 12, dim), 1 / 12)
    assert found.volume == pytest.approx({2: np.pi, 3: 4 * np.pi / 3}[dim], rel=0.015)
    assert found.area == pytest.approx({2: 2 * np.pi, 3: 4 * np.pi}[dim], rel=0.03)


def test_a_surface_is_closed_and_faces_outwards():
    """Over several blocks of the grid, with a hole inside that faces into itself."""
    points = ball(1 / 12)
    hollow = points[(points**2).sum(axis=1) > 0.45**2]
    mesh = as_mesh(surface(hollow, 1 / 12))
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    parts = sorted(mesh.split(only_watertight=False), key=lambda part: part.volume)
    assert [np.sign(part.volume) for part in parts] == [-1, 1]


@pytest.mark.parametrize("dim", [2, 3])
def test_turned_and_shifted_it_is_the_same(dim):
    points, dp = ball(1 / 10, dim), 1 / 10
    whole = surface(points, dp)
    turn = Rotation.from_rotvec([0.3, -0.5, 0.7]).as_matrix() if dim == 3 else np.eye(2)
    moved = surface(points @ turn.T + MAP[:dim], dp)
    assert moved.volume == pytest.approx(whole.volume, rel=0.005)
    assert moved.area == pytest.approx(whole.area, rel=0.01)
    middle = 0.5 * (moved.points.min(axis=0) + moved.points.max(axis=0))
    assert middle == pytest.approx(MAP[:dim], abs=0.05 * dp)


def test_whole_cells_of_shift_change_nothing():
    """Of the map's size too: places are in double precision."""
    dp = 1 / 16
    points = lattice([0, 0, 0], [0.5, 0.5, 0.5], dp)
    here, there = surface(points, dp), surface(points + 2.0**21, dp)
    assert there.points - 2.0**21 == pytest.approx(here.points, abs=1e-7)
    assert there.area == pytest.approx(here.area, rel=1e-6)
    assert there.volume == pytest.approx(here.volume, rel=1e-6)


def tank(dp, walls):
    """Water 0.5 m deep between walls and a floor, which are three spacings thick."""
    water = lattice([0, 0], [1, 0.5], dp)
    if not walls:
        return water, np.zeros(len(water), bool)
    thick = 3 * dp
    parts = (
        lattice([-thick, -thick], [1 + thick, 0], dp),
        lattice([-thick, 0], [0, 1], dp),
        lattice([1, 0], [1 + thick, 1], dp),
    )
    points = np.concatenate([water, *parts])
    return points, np.arange(len(points)) >= len(water)


def test_water_reaches_into_the_corners_of_its_tank():
    dp = 0.05
    held, free = (surface(*args) for args in ((p, dp, s) for p, s in (tank(dp, 1), tank(dp, 0))))
    assert held.volume == pytest.approx(0.5, rel=0.01)
    assert held.area == pytest.approx(3.0, rel=0.03)  # the corners of the floor are rounded
    corner = np.array([1.0, 0.5])
    nearest = [np.linalg.norm(each.points - corner, axis=1).min() for each in (held, free)]
    assert nearest[0] < 0.9 * nearest[1]
    assert abs(held.volume - 0.5) < 0.7 * abs(free.volume - 0.5)


def test_a_film_on_a_wall_is_seen():
    """One layer of particles; without its wall it is too thin."""
    dp = 0.05
    film = lattice([0, 0], [2, dp], dp)
    wall = lattice([-0.2, -0.2], [2.2, 0], dp)
    points = np.concatenate([film, wall])
    solid = np.arange(len(points)) >= len(film)
    assert surface(points, dp, solid).volume == pytest.approx(2 * dp, rel=0.15)
    assert surface(film, dp).volume < 0.8 * 2 * dp


def test_at_periodic_faces_it_is_cut():
    dp = 0.05
    points = lattice([0, 0, 0], [1, 0.4, 0.5], dp)
    found = surface(points, dp, periods=((1, 0.0, 0.4),))
    section = surface(lattice([0, 0], [1, 0.5], dp), dp)
    assert found.points[:, 1].min() == pytest.approx(0, abs=0.01 * dp)
    assert found.points[:, 1].max() == pytest.approx(0.4, abs=0.01 * dp)
    assert found.volume == pytest.approx(0.4 * section.volume, rel=0.01)
    assert as_mesh(found).is_watertight


def test_lines_are_closed_with_the_inside_on_their_left():
    points = ball(1 / 10, 2)
    found = surface(points[(points**2).sum(axis=1) > 0.5**2], 1 / 10)
    loops = found.loops()
    assert len(loops) == 2
    assert sum(len(loop) - 1 for loop in loops) == len(found.faces)
    assert all(loop[0] == loop[-1] for loop in loops)
    assert found.volume == pytest.approx(np.pi * (1 - 0.25), rel=0.02)


def test_fields_on_it_are_those_of_particles_nearby():
    dp = 0.1
    points = ball(dp)
    cloud = cloud_of(points, dp)
    places = surface(points, dp).points
    found = interpolated(places, cloud, {"one": np.ones(len(points)), "x": points}, KERNEL)
    assert found["one"] == pytest.approx(np.ones(len(places)))
    assert np.abs(found["x"] - places).max() < 1.5 * dp


@pytest.mark.parametrize("cell", [0.1, 3.0])
def test_cells_that_show_nothing_are_refused(cell):
    with pytest.raises(UserError, match=r"cells are to be from 0\.0232 to 0\.278 m"):
        surface(ball(0.1), 0.1, cell=cell)


def test_more_than_can_be_done_is_refused_with_a_cell_that_fits(monkeypatch):
    from doseki.export.surface import fraction

    monkeypatch.setattr(fraction, "MOST_WORK", 1e5)
    with pytest.raises(UserError, match=r"--cell \S+ fits"):
        surface(ball(0.1), 0.1)


def test_nothing_has_no_surface():
    found = surface(np.zeros((0, 3)), 0.1)
    assert (len(found.points), found.area, found.volume) == (0, 0.0, 0.0)


def test_without_scikit_image_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "skimage.measure", None)
    with pytest.raises(UserError, match=r"pip install 'doseki\[surface\]'"):
        surface(ball(0.2), 0.2)
