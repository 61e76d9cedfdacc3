"""Structures whose loads are read: how far they go into ground and walls, and how thick."""

from __future__ import annotations

import numpy as np
import pytest
from tests.small_scenarios import BANKS
from tests.terrain.scenes import grid, profile, text

from doseki.scenario.load import load_scenario
from doseki.scene.checks.structures import EndsAtWall, InWalls, OneFace, Shallow
from doseki.solver.build import filled_simulation

DP = 0.1
DAM = """
[body.dam]
shape = "box"
material = "basalt"
fixed = true
{keys}
[body.lake]
shape = "box"
material = "water"
min = {low}
max = {high}
[gauge.dam]
kind = "{kind}"
bodies = ["dam"]
interval = 0.1
{more}
"""


def findings(path, kind):
    scenario = load_scenario(path)
    return [each for each in filled_simulation(scenario).warnings if isinstance(each, kind)]


def wall_2d(folder, depth, slope=0.0, keys="", kind="load", more=""):
    """A wall from x = 3 to 4.2 that goes so many spacings into the lowest ground."""
    profile(folder / "terrain.csv", lambda x: slope * (3 - x))
    low = -slope * 1.2 - depth * DP
    box = f"min = [3.0, {low}]\nmax = [4.2, 1.0]\n{keys}"
    path = folder / "case.toml"
    filled = DAM.format(keys=box, low=[2.0, 0.0], high=[3.0, 0.5], kind=kind, more=more)
    path.write_text(text(2, dp=DP, speed=4.0, more=filled))
    return path


@pytest.mark.parametrize(
    ("depth", "fewer"), [(0, True), (1, True), (2, True), (3, False), (4, False)]
)
def test_a_wall_is_to_reach_three_spacings_into_its_bed(tmp_path, depth, fewer):
    found = findings(wall_2d(tmp_path, depth), Shallow)
    assert bool(found) == fewer
    if fewer:
        (one,) = found
        assert one.reach == pytest.approx(depth * DP, abs=0.8 * DP)
        assert "body.dam: reaches" in str(one)
        assert "3 dp = 0.3 m" in str(one)


@pytest.mark.parametrize(("depth", "fewer"), [(0.5, True), (3, False)])
def test_on_a_slope_the_deeper_side_is_told(tmp_path, depth, fewer):
    found = findings(wall_2d(tmp_path, depth, slope=0.4), Shallow)
    assert bool(found) == fewer
    if fewer:
        assert found[0].at[0] == pytest.approx(4.2, abs=2 * DP)


def valley_wall(folder, reach):
    """A wall across a valley of 45 degrees, which goes so many spacings into its banks."""
    grid(folder / "terrain.asc", lambda x, y: np.abs(y - 2.0))
    top = 0.8
    half = top + reach * DP * np.sqrt(2)
    box = f"min = [3.0, {2 - half}, -0.5]\nmax = [4.2, {2 + half}, {top}]\nnormal = [-1, 0, 0]"
    path = folder / "case.toml"
    lake = {"low": [2.0, 1.5, 0.0], "high": [3.0, 2.5, 0.5]}
    filled = DAM.format(keys=box, kind="load", more="", **lake)
    path.write_text(text(3, dp=DP, speed=4.0, more=filled))
    return path


@pytest.mark.parametrize(("reach", "fewer"), [(0.5, True), (4, False)])
def test_banks_count_as_the_bed_does(tmp_path, reach, fewer):
    found = findings(valley_wall(tmp_path, reach), Shallow)
    assert bool(found) == fewer
    if fewer:
        assert abs(abs(found[0].at[1] - 2.0) - 0.8) < 3 * DP


def test_the_edges_of_a_slit_on_a_slope_lead_down(tmp_path):
    """Along both faces: along one of them the slope leads out of the other."""
    assert findings("valley", Shallow) == []


def mesh_wall(folder, reach):
    """A wall of triangles across a valley, whose back leans, with so many spacings in the banks."""
    grid(folder / "terrain.asc", lambda x, y: np.maximum(np.abs(y - 2.0) - 0.6, 0.0))
    half, foot = 0.6 + 1.5 + reach * DP, -0.32
    sides = [(3.0, foot), (4.4, foot), (3.8, 1.5), (3.0, 1.5)]
    corners = np.array([(x, y, z) for y in (2 - half, 2 + half) for x, z in sides])
    around = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    quads = [(3, 2, 1, 0), (4, 5, 6, 7), *around]
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    lines += ["f " + " ".join(str(k + 1) for k in face) for face in faces]
    (folder / "dam.obj").write_text("\n".join(lines) + "\n")
    path = folder / "case.toml"
    lake = {"low": [2.0, 1.5, 0.0], "high": [3.0, 2.5, 0.5]}
    filled = DAM.format(keys='file = "dam.obj"', kind="load", more="", **lake)
    filled = filled.replace('shape = "box"', 'shape = "mesh"', 1)
    path.write_text(text(3, dp=DP, speed=4.0, more=filled))
    return path


@pytest.mark.parametrize(("reach", "fewer"), [(-4, True), (4, False)])
def test_a_crest_between_faces_is_no_end_of_a_wall(tmp_path, reach, fewer):
    """Where the crest meets the bank, the normal of a particle is the mean of two faces."""
    assert bool(findings(mesh_wall(tmp_path, reach), Shallow)) == fewer


def test_a_wall_without_a_gauge_is_not_looked_at(tmp_path):
    path = wall_2d(tmp_path, 0)
    path.write_text(path.read_text().split("[gauge.dam]")[0])
    assert not findings(path, Shallow)


def test_a_dam_beside_the_map_is_told_only_that(tmp_path):
    path = valley_wall(tmp_path, 0.5)
    there, beyond = ("min = [3.0, ", "max = [4.2, "), ("min = [3000.0, ", "max = [3001.2, ")
    content = path.read_text()
    for old, new in zip(there, beyond, strict=True):
        assert old in content
        content = content.replace(old, new)
    path.write_text(content)
    doubts = filled_simulation(load_scenario(path)).warnings
    (one,) = (each for each in doubts if each.place == "body.dam")
    assert "lies beyond the terrain" in str(one)


@pytest.mark.parametrize(
    ("thickness", "keys", "told"),
    [(0.1, "", True), (0.2, "", False), (0.5, "", False), (0.1, "normal = [-1, 0]", False)],
)
def test_a_thin_box_has_one_face_in_the_static_part(tmp_path, thickness, keys, told):
    path = wall_2d(tmp_path, 3, keys=keys)
    path.write_text(path.read_text().replace("4.2, 1.0", f"{3 + thickness}, 1.0"))
    found = findings(path, OneFace)
    assert bool(found) == told
    if told:
        assert "1.5 dp = 0.15 m" in str(found[0])


@pytest.mark.parametrize(("ends", "told"), [(0.6, False), (1.2, True)])
def test_a_mesh_that_goes_into_other_walls_is_told(tmp_path, ends, told):
    """A dam of triangles three spacings into the floor and both banks, which end at it or not."""
    corners = [(x, y, z) for x in (0.6, 1.2) for y in (-0.15, 0.55) for z in (-0.15, 0.6)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    lines = ["v {} {} {}".format(*corner) for corner in corners]
    lines += ["f " + " ".join(str(k + 1) for k in face) for face in faces]
    (tmp_path / "dam.obj").write_text("\n".join(lines) + "\n")
    path = tmp_path / "case.toml"
    path.write_text(BANKS.format(file="dam.obj", length=0.6, ends=ends))
    found = findings(path, InWalls)
    assert bool(found) == told
    if told:
        assert "let these walls end at its faces" in str(found[0])


def test_places_on_a_map_are_told_to_a_decimetre():
    at = (512445.625, 5211038.02, 431.14)
    for found in (InWalls("dam", "load", 2, 9, at), Shallow("dam", "load", 0.6, at, 1.25)):
        assert "at (512445.6, 5211038.0, 431.1) m" in str(found)
    assert "at (0.013, 0.5) m" in str(Shallow("dam", "load", 0.01, (0.0130001, 0.5), 0.01))


CORNER = """
dim = 2
scheme = "resolved"
dp = 0.05
time_max = 1
time_out = 1
speed_max = 4
[body.floor]
shape = "box"
material = "basalt"
fixed = true
min = [-1, -0.15]
max = [{end}, 0]
rotate = {turn}
pivot = [0, 0]
[body.wall]
shape = "box"
material = "basalt"
fixed = true
min = [0, {foot}]
max = [0.15, 1]
rotate = {turn}
pivot = [0, 0]
[body.lake]
shape = "box"
material = "water"
min = [-1, 0]
max = [0, 0.5]
rotate = {turn}
pivot = [0, 0]
[gauge.thrust]
kind = "force"
bodies = ["wall"]
interval = 0.1
"""


@pytest.mark.parametrize("turn", [0, 30, 180])
@pytest.mark.parametrize(("foot", "end", "fewer"), [(0, 0.15, True), (-0.15, 0, False)])
def test_a_wall_that_ends_at_the_floor_is_told(tmp_path, turn, foot, end, fewer):
    path = tmp_path / "case.toml"
    path.write_text(CORNER.format(turn=turn, foot=foot, end=end))
    found = findings(path, EndsAtWall)
    assert [(each.place, each.other) for each in found] == [("body.wall", "body.floor")] * fewer
    assert all("gauge.thrust does not read" in str(each) for each in found)


def test_walls_of_a_tank_are_told_what_can_be_done_about_them(tmp_path):
    """Nobody can make one side of a tank longer."""
    floor, lake = CORNER.index("[body.floor]"), CORNER.index("[body.lake]")
    tank = """[body.tank]
shape = "tank"
material = "basalt"
min = [-1, 0]
max = [0, 1]
"""
    text = CORNER[:floor] + tank + CORNER[lake:].replace('"wall"', '"tank.+x"')
    path = tmp_path / "case.toml"
    path.write_text(text.format(turn=0))
    (found,) = findings(path, EndsAtWall)
    assert "make the walls of body.tank boxes of their own, the sides 3 dp" in str(found)


def test_only_gauges_that_do_not_read_both_bodies_are_named(tmp_path):
    """The same wall, read together with its floor and alone."""
    both = '[gauge.all]\nkind = "force"\nbodies = ["floor", "wall"]\ninterval = 0.1\n'
    start = CORNER.index("[gauge.thrust]")
    path = tmp_path / "case.toml"
    path.write_text((CORNER[:start] + both).format(turn=0, foot=0, end=0.15))
    assert not findings(path, EndsAtWall)
    path.write_text((CORNER[:start] + both + CORNER[start:]).format(turn=0, foot=0, end=0.15))
    (found,) = findings(path, EndsAtWall)
    assert (found.place, found.gauges) == ("body.wall", ("thrust",))
    assert "which gauge.thrust does not read" in str(found)
