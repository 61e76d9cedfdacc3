"""Gauges and fixed bodies that no flow on a terrain gets to are warned about."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_scene

from .scenes import grid, text

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
