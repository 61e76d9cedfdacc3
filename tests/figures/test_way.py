"""Flows over a terrain, seen from in front of them and from beside their way."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from doseki.figures.kinds.panels import Panels
from doseki.figures.kinds.spatial import draw_spatial
from doseki.figures.movie import make_movie
from doseki.figures.nothing import NothingToDrawError
from doseki.figures.plot import figures
from doseki.figures.space.box import Space
from doseki.figures.space.ground import ground_behind, space_of
from doseki.figures.space.surfaces import Camera
from doseki.figures.space.way import Way, dots_beside, extent_beside
from doseki.geodata.grid import Raster
from doseki.geodata.raster import write_raster
from doseki.measure.moments import Moment, moments
from doseki.measure.views import View, whole_space
from doseki.record.reader import load

from ..synthetic_runs import make_plain_state

MIDDLE = np.array([460_050.0, 5_200_050.0])
ANGLES = [0, 37, 90, 215]  # degrees, of the way from the east


def towards(angle):
    return np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])


def slope(angle):
    """A channel in a slope of one in two."""
    grid = Raster(np.zeros((101, 101)), *(MIDDLE - 50.5), 1.0)
    x, y = grid.x[None, :] - MIDDLE[0], grid.y[:, None] - MIDDLE[1]
    along, across = np.tensordot(towards(angle), [x + 0 * y, y + 0 * x], 1), 0.0
    left = towards(angle + 90)
    across = left[0] * x + left[1] * y
    return grid.with_values(900 - 0.5 * along + 0.05 * across**2)


def dam_across(angle):
    """Particles of a dam 28 to 32 m down the channel, 20 m wide, 5 m in and 5 m above the bed."""
    axes = [np.arange(-a, a, 1.0) + 0.5 for a in (2, 10, 5)]
    along, across, up = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3).T
    plan = MIDDLE + np.outer(along + 30, towards(angle)) + np.outer(across, towards(angle + 90))
    return np.column_stack([plan, 885 + up])


@pytest.fixture
def slide(tmp_path, record_run):
    """A function that makes a run of a block that slides down the channel of that angle: by 40 m,
    or as far as `way` says, m, at a time.
    """

    def at(angle, dam=False, way=lambda time: 10 * time):
        def state(time):
            axes = [np.arange(-a, a, 1.0) + 0.5 for a in (6, 3, 1)]
            along, across, up = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3).T
            along = along - 20 + way(time)
            plan = MIDDLE + np.outer(along, towards(angle)) + np.outer(across, towards(angle + 90))
            position = np.column_stack([plan, 902 - 0.5 * along + up])
            kind = np.zeros(len(position), int)
            if dam:
                wall = dam_across(angle)
                position, kind = (
                    np.concatenate([position, wall]),
                    np.repeat([0, 2], [len(position), len(wall)]),
                )
            return make_plain_state(position, np.zeros_like(position), kind)

        folder = tmp_path / f"at_{angle}"
        recorder, _ = record_run(folder, dim=3, times=(0.0, 2.0, 4.0), state_at=state)
        recorder.close({"status": "done"})
        write_raster(folder / "terrain.asc", slope(angle))
        scenario = folder / "scenario.toml"
        text, count = re.subn(r"gravity = .*", "gravity = [0, 0, -9.81]", scenario.read_text())
        assert count == 1
        scenario.write_text(text)
        return load(folder)

    return at


@pytest.mark.parametrize("angle", ANGLES)
def test_the_way_is_that_of_the_flow_whatever_its_direction(slide, angle):
    run = slide(angle)
    way = Way.between(list(run))
    assert way.direction == pytest.approx(towards(angle), abs=1e-9)
    space = Space.around(list(run), whole_space(3), "terrain")
    clouds = [dots_beside(snapshot, way, space, None) for snapshot in run]
    for moved, cloud in zip((0, 20, 40), clouds, strict=True):
        assert len(cloud.index) == 144
        assert [cloud.points[:, 0].min(), cloud.points[:, 0].max()] == pytest.approx(
            [moved - 5.5, moved + 5.5], abs=1e-6
        )
    left, right, bottom, top = extent_beside(clouds)
    assert left < -5.5
    assert right > 45.5
    assert bottom < clouds[-1].points[:, 1].min()
    assert top > clouds[0].points[:, 1].max()


@pytest.mark.parametrize("angle", ANGLES)
def test_a_flow_arrives_whichever_way_it_goes(slide, angle):
    run = slide(angle, way=lambda time: min(20 * time, 40))
    with (run.directory / "scenario.toml").open("a") as file:
        file.write('[terrain]\nfile = "terrain.asc"\n')
    run = load(run.directory)
    found = {moment.index: moment.name for moment in moments(run, whole_space(3))}
    assert "arrival" in found[1]


def test_the_picture_from_in_front_of_a_flow_does_not_turn_with_it(slide):
    seen = []
    for angle in (0, 90):
        run = slide(angle)
        camera = Way.between(list(run)).looking_back()
        middle = camera.project(np.append(MIDDLE, 900.0)[None])[0]
        extent = (middle[0] - 6, middle[0] + 6, middle[1] - 12, middle[1] + 12)
        space = Space.around(list(run), whole_space(3), "terrain")
        seen.append(ground_behind(run, space, camera, extent, 40).depth)
    there = np.isfinite(seen[0]) & np.isfinite(seen[1])
    assert there.mean() > 0.9
    apart = seen[0][there] - seen[1][there]
    assert np.abs(apart - apart.mean()).max() < 2.0  # pixels; the ground is drawn by balls of three


def test_the_ground_is_lit_from_the_north_west(slide):
    run = slide(90)
    space = Space.around(list(run), whole_space(3), "terrain")
    extent = (MIDDLE[0] - 8, MIDDLE[0] + 8, MIDDLE[1] - 8, MIDDLE[1] + 8)
    colour = ground_behind(
        run, space, Camera.looking(np.array([0.0, 0.0, -1.0])), extent, 64
    ).colour
    west, east = colour[:, :20].mean(), colour[:, -20:].mean()
    assert east > west + 0.1  # the side that faces the west


def test_a_run_on_a_terrain_has_the_view_from_beside_its_way(slide):
    figure = dict(figures(slide(37)))["overview"]
    section = figure.axes[2]
    assert section.get_title(loc="left") == "from beside its way"
    assert section.get_xlabel() == "along the way (m)"
    bed = section.collections[0].get_paths()[0].vertices
    inside = (bed[:, 0] > -4) & (bed[:, 0] < 44) & (bed[:, 1] > section.get_ylim()[0] + 0.1)
    assert bed[inside, 1] == pytest.approx(910 - 0.5 * bed[inside, 0], abs=1.0)


@pytest.mark.parametrize("angle", [37, 90])
def test_the_dam_that_a_flow_meets_is_drawn_but_for_its_foot(slide, angle):
    run = slide(angle, dam=True)
    snapshot = run[-1]
    space = space_of(run, list(run), whole_space(3))
    fixed, height = snapshot["fixed"], snapshot["position"][:, 2]
    below = height < run.ground.sampled(*snapshot["position"][:, :2].T) - 0.2
    away = Way.between(list(run)).looking_back().away
    shown = space.shows(snapshot, snapshot["position"], away)
    assert shown[fixed & ~below & space.is_near(snapshot["position"])].all()
    assert not shown[fixed & below].any()
    assert shown[~fixed].all()


@pytest.mark.parametrize("angle", [37, 90])
def test_from_beside_there_is_ground_below_and_behind_a_dam(slide, angle):
    section = dict(figures(slide(angle, dam=True)))["overview"].axes[2]
    left, right = section.get_xlim()
    bed = section.collections[0].get_paths()[0].vertices
    top = bed[bed[:, 1] > section.get_ylim()[0] + 0.1]
    assert right > 50 + 1.5
    assert top[:, 0].min() < left + 1.2
    assert top[:, 0].max() > right - 1.2
    behind = top[:, 0] > 47
    assert top[behind, 1] == pytest.approx(910 - 0.5 * top[behind, 0], abs=1.2)


def test_the_way_of_one_moment_is_that_of_the_run(slide):
    run = slide(37)
    figure = draw_spatial(run, [Moment(1, "")], Panels(whole_space(3), ("material",)))
    assert figure.axes[2].get_title(loc="left") == "from beside its way"


def test_what_stays_where_it_is_has_no_way(slide):
    run = slide(0)
    assert Way.between([run[0], run[0]]) is None
    assert Way.between([]) is None


def test_a_window_that_nothing_reaches_is_no_picture(slide):
    run = slide(0)
    far = View(np.append(MIDDLE - 49, 0.0), np.append(MIDDLE - 40, 2000.0))
    way, space = Way.between(list(run)), Space.around(list(run), whole_space(3), "terrain")
    clouds = [dots_beside(snapshot, way, replace(space, view=far), None) for snapshot in run]
    with pytest.raises(NothingToDrawError, match="nothing to see"):
        extent_beside(clouds)


def test_a_movie_of_a_run_on_a_terrain_has_its_ground(slide, tmp_path):
    run = slide(215)
    with Image.open(make_movie(run, tmp_path / "movie.gif", width=300)) as movie:
        assert movie.n_frames == 3
        frame = np.asarray(movie.convert("RGB")).astype(int)
    inner = frame[120:-80, 120:-60]
    assert (inner.sum(axis=2) < 3 * 252).mean() > 0.5  # ground, where there was white around walls
