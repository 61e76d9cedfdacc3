"""Gauges and fixed bodies that no flow on a terrain gets to are warned about."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.scene.build import Settled, build_scene

from .scenes import grid, profile, text

SQUARE = """
[body.slide]
shape = "release"
material = "water"
polygon = [[1, 1], [2, 1], [2, 2], [1, 2]]
thickness = 0.3
"""
APPROACH = """
[gauge.one]
kind = "approach"
position = [{x}, 1.0, {z}]
direction = [1, 0, 0]
width = 1.0
"""
HEIGHT = """
[gauge.one]
kind = "surface_height"
position = [{x}, 1.0, {z}]
"""
SECTION = """
[gauge.one]
kind = "section"
left = [{x}, 3.0]
right = [{x}, 1.0]
"""
DAM = """
[body.dam]
shape = "box"
material = "basalt"
fixed = true
min = [{x}, 1.0, {z}]
max = [{x}.4, 3.0, "= {z} + 1"]
"""


def hill(x, y):
    return 2 - 0.2 * x + 0 * y


@pytest.fixture
def said(tmp_path):
    """What is said of a thing at a place on a slope of 20 % that is 1.4 m high at x = 3."""

    def find(more, x, z):
        grid(tmp_path / "terrain.asc", hill)
        path = tmp_path / "case.toml"
        path.write_text(text(3, dp=0.1, more=SQUARE + more.format(x=x, z=z)))
        doubts = build_scene(load_scenario(path)).warnings
        return [str(each) for each in doubts if each.place in ("gauge.one", "body.dam")]

    return find


@pytest.mark.parametrize("gauge", [APPROACH, HEIGHT, SECTION, DAM])
def test_beside_the_map(said, gauge):
    (doubt,) = said(gauge, 3000, 1.4)
    assert "lies beyond the terrain" in doubt


@pytest.mark.parametrize(("bank", "others"), [("left", "right"), ("right", "left")])
def test_a_bank_beside_the_map(said, bank, others):
    keys = f'\n[gauge.one]\nkind = "section"\n{bank} = [3000, 3]\n{others} = [{{x}}, 1.0]\n'
    (doubt,) = said(keys, 3, 0)
    assert doubt.startswith(f"gauge.one: its {bank} bank [3000, 3] lies beyond the terrain")
    assert said(SECTION, 3, 0) == []


def test_a_gauge_off_the_bed(said):
    assert said(HEIGHT, 3, 1.4) == []
    assert said(HEIGHT, 3, 1.36) == []
    (near,) = said(HEIGHT, 3, 1.2)
    assert "0.2 m below the bed, so that its heights count from there" in near
    (below,) = said(HEIGHT, 3, 0.4)
    assert "position is 1 m below the bed, so that it misses the flow" in below
    assert "the bed is at 1.4 m" in below
    (above,) = said(HEIGHT, 3, 2.4)
    assert "position is 1 m above the bed" in above
    assert said(APPROACH, 3, 0.4) == []  # its columns find the bed


def test_a_body_in_the_ground(said):
    assert said(DAM, 3, 1.0) == []
    (buried,) = said(DAM, 3, -0.2)
    assert "all of it lies in the ground" in buried


BOULDER = '[body.one]\nshape = "sphere"\nmaterial = "basalt"\nradius = 0.4\n'
LAKE = '[body.one]\nshape = "box"\nmaterial = "water"\n'
PACKING = BOULDER.replace("radius = 0.4", "d = 0.4\ncount = 8")


def holed(x, y):
    return np.where(np.abs(x - 4.0) < 0.3, np.nan, hill(x, y))


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (BOULDER + "centre = [30, 2, 3]", "lies beyond the terrain, .* as at .30.0, 2.0. m"),
        (BOULDER + "centre = [4, 2, 3]", "lies beyond the terrain, or where it has no data"),
        (LAKE + "min = [8, 1, 1]\nmax = [9, 2, 2]", "all of its particles lie beyond"),
        (LAKE + "min = [5, 1, 1]\nmax = [7, 2, 2]", r"1,?\d* of its .* particles \(\d+ %\) lie"),
        (PACKING + "min = [5, 1, 1]\nmax = [7, 2, 2]", r"3 of its 8 bodies \(\d+ %\) lie beyond"),
    ],
)
def test_what_moves_starts_on_the_map(tmp_path, more, said):
    grid(tmp_path / "terrain.asc", holed)
    path = tmp_path / "case.toml"
    path.write_text(text(3, dp=0.1, more=SQUARE + more))
    with pytest.raises(UserError, match=rf"body.one: {said}.* would leave at once"):
        build_scene(load_scenario(path))


def test_what_moves_starts_on_the_profile(tmp_path):
    profile(tmp_path / "terrain.csv", lambda x: 0 * x)
    path = tmp_path / "case.toml"
    pool = LAKE + "min = [5.0, 0.0]\nmax = [7.0, 0.5]\n"
    path.write_text(text(2, more=pool))
    with pytest.raises(UserError, match=r"body.one: .* of its 100 particles .* lie beyond the ter"):
        build_scene(load_scenario(path))


@pytest.mark.parametrize("centre", ["[5.9, 2, 1.5]", "[0.1, 2, 2.5]"])
def test_a_body_may_reach_beyond_the_map_and_water_below_its_ground(tmp_path, centre):
    """Only the centre of a body tells where it is, and what lies in the ground is left out."""
    grid(tmp_path / "terrain.asc", hill)
    path = tmp_path / "case.toml"
    lake = LAKE.replace("one", "low") + "min = [-1, 1, 1]\nmax = [5.5, 2, 1.5]\n"
    path.write_text(text(3, dp=0.1, more=f"{BOULDER}centre = {centre}\n{lake}"))
    build_scene(load_scenario(path))


def test_grains_that_roll_off_the_map_are_told_of(tmp_path):
    grid(tmp_path / "terrain.asc", hill)
    path = tmp_path / "case.toml"
    settles = "min = [4.5, 1, 2]\nmax = [5.9, 2, 3]\nsettle = true\n"
    path.write_text(text(3, dp=0.1, more=SQUARE + PACKING + settles))

    def away(scenario, groups, names):
        moved = [
            replace(g, centre=g.centre + np.array([0.5, 0, 0])) for g in groups if g.name == "one"
        ]
        return Settled(moved, [])

    doubts = [str(each) for each in build_scene(load_scenario(path), away).warnings]
    (doubt,) = (each for each in doubts if "settled beyond the terrain" in each)
    assert doubt.startswith("body.one: ")


@pytest.mark.parametrize("content", [None, b"II*\0 and no more"])
def test_a_map_that_cannot_be_read_is_named_with_its_key(tmp_path, content):
    path = tmp_path / "case.toml"
    path.write_text(text(3, dp=0.1, more=SQUARE).replace("terrain.asc", "dem.tif"))
    if content is not None:
        (tmp_path / "dem.tif").write_bytes(content)
    with pytest.raises(UserError, match=r"line \d+: terrain.file: .*dem.tif: "):
        load_scenario(path)


@pytest.mark.parametrize("window", ["", "window = [1, 1, 3, 3]"])
def test_a_map_without_data_is_named_with_its_key(tmp_path, window):
    grid(tmp_path / "terrain.asc", lambda x, y: np.full(x.shape, np.nan))
    path = tmp_path / "case.toml"
    path.write_text(text(3, dp=0.1, more=SQUARE).replace("[terrain]", f"[terrain]\n{window}"))
    with pytest.raises(UserError, match=r"line \d+: terrain.file: .*terrain.asc: no cell .* data"):
        load_scenario(path)
