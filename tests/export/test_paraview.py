"""The scene that is written for ParaView, by what its files hold."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from doseki.export.folder import pvd
from doseki.export.paraview.gauges import gauge_marks
from doseki.export.paraview.grains import GrainShapes, grain_points, grain_polygons, grain_shapes
from doseki.export.paraview.structures import Structures, ground_surface
from doseki.export.paraview.write import export_paraview
from doseki.geodata.raster import Raster
from doseki.scenario.load import load_scenario


@pytest.fixture(scope="module")
def scenario(pool):
    return load_scenario(pool.folder.scenario)


@pytest.fixture(scope="module")
def exported(pool, tmp_path_factory):
    folder = tmp_path_factory.mktemp("scene") / "paraview"
    return folder, export_paraview(pool, folder)


def test_every_file_that_is_named_is_there(exported):
    folder, _ = exported
    scene = json.loads((folder / "scene.json").read_text())
    for key in ("grains", "shapes", "structures", "gauges"):
        assert (folder / scene[key]).is_file()
    for index in folder.glob("*.pvd"):
        entries = list(ET.parse(index).getroot().iter("DataSet"))
        assert [float(e.get("timestep")) for e in entries] == pytest.approx([0, 0.03, 0.06])
        assert all((folder / entry.get("file")).is_file() for entry in entries)
    assert (folder / "state.py").read_text().startswith('"""A state of ParaView')


def test_its_paths_are_relative(exported, pool):
    folder, _ = exported
    assert (folder / json.loads((folder / "scene.json").read_text())["run"]).samefile(
        pool.directory
    )
    for file in (folder / "scene.json", folder / "state.py", *folder.glob("*.pvd")):
        assert str(pool.directory.parent) not in file.read_text()


def test_what_has_no_place_is_told(exported):
    assert exported[1][1:] == ["gauges without a place are not shown: middle"]


def test_balls_are_points_and_other_bodies_are_not_balls(pool, scenario):
    known, unknown = grain_shapes(scenario, pool[0])
    assert unknown == []
    found = grain_points(pool[2], known)
    names = np.array(pool[0].body_names)[found.fields["Body"]]
    assert dict(zip(names, found.fields["BallDiameter"], strict=True)) == pytest.approx(
        {"ball": 0.2, "brick": 0.0}
    )
    assert np.array_equal(found.fields["Orientation"], pool[2].grains["orientation"])
    assert found.units["Velocity"] == "m/s"


def test_polygons_turn_with_their_body(pool, scenario):
    """As its particles do: both lie in the same place of its own axes at all times."""
    known, _ = grain_shapes(scenario, pool[0])
    brick = list(pool[0].body_names).index("brick")
    corners, spread = [], []
    for snapshot in (pool[0], pool[2]):
        found = grain_polygons(snapshot, known)
        own = snapshot["position"][snapshot.stored("body") == brick]
        corners.append(found.points)
        spread.append(np.linalg.norm(found.points[:, None] - own[None], axis=2))
    assert np.abs(corners[1] - corners[0]).max() > 0.02
    assert spread[1] == pytest.approx(spread[0], abs=1e-9)


def test_points_of_polygons_have_the_velocity_of_their_surface(pool, scenario):
    known, _ = grain_shapes(scenario, pool[0])
    start, end = (grain_polygons(pool[k], known) for k in (0, 1))
    moved = (end.points - start.points) / (pool.times[1] - pool.times[0])
    mean = 0.5 * (start.fields["Velocity"] + end.fields["Velocity"])[:, : pool[0].dim]
    assert moved == pytest.approx(mean, abs=0.1)
    assert np.abs(mean).max() > 1.0


def test_a_body_that_has_left_is_not_shown(pool):
    snapshot = pool[0]
    snapshot.grains["removed"][:] = 1
    known = GrainShapes([None] * len(snapshot.grains["removed"]))
    assert len(grain_points(snapshot, known).points) == 0


def test_structures_move_as_is_prescribed(scenario):
    structures = Structures(scenario)
    assert structures.move
    assert structures.names == ["floor", "gate"]
    start, end = structures.at(0.0), structures.at(0.5)
    rise = end.points[:, -1] - start.points[:, -1]
    assert sorted(np.unique(rise.round(9))) == [0.0, 0.5]


def test_the_ground_leaves_out_what_is_not_known():
    values = np.arange(12.0).reshape(3, 4)
    values[0, 0] = np.nan
    found = ground_surface(Raster(values, 1e6, 2e6, 2.0))
    assert len(found.points) == 11
    assert len(found.polys) == 5
    a, b, c, _ = np.moveaxis(found.points[found.polys], 1, 0)
    assert np.all(np.cross(b - a, c - b)[:, 2] > 0)
    south_west = found.points[np.argmin(found.points @ [1, 1, 0])]
    assert south_west.tolist() == [1e6 + 1, 2e6 + 1, 8.0]


def test_gauges_have_their_places_and_names(scenario):
    marks, nowhere = gauge_marks(scenario, None, Structures(scenario).top)
    data = marks.polydata()
    assert nowhere == ["middle"]
    assert data.names["Gauge"] == ["toe", "column", "column"]
    assert data.points[0] == pytest.approx(scenario.gauge["toe"].position)
    line = data.points[data.lines[0]]
    assert line[1] - line[0] == pytest.approx(0.4 * np.eye(scenario.dim)[-1])
    assert marks.labels["toe"][: scenario.dim] == pytest.approx(data.points[0])


def test_an_index_keeps_all_digits_and_escapes_names():
    root = ET.fromstring(pvd([(0.1 + 0.2, 'a"&<.vtp')]))
    (entry,) = root.iter("DataSet")
    assert float(entry.get("timestep")) == 0.1 + 0.2
    assert entry.get("file") == 'a"&<.vtp'
