"""Thickness of a release, which each polygon of a file may have as an attribute."""

from __future__ import annotations

import json

import pytest

from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.scenario.releases import NoArea

from .scenes import grid, text

RELEASE = """
[body.slide]
shape = "release"
material = "water"
file = "area.geojson"
"""
SQUARE = [[1, 1], [4, 1], [4, 3], [1, 3], [1, 1]]
LINE = [[4, 1], [4.5, 1.5], [5, 2], [4, 1]]


def scenario_with(folder, *areas):
    """A scenario with a release of areas, each a ring and its attributes."""
    features = [
        {
            "type": "Feature",
            "properties": about,
            "geometry": {"type": "Polygon", "coordinates": [r]},
        }
        for r, about in areas
    ]
    collection = {"type": "FeatureCollection", "features": features}
    (folder / "area.geojson").write_text(json.dumps(collection))
    grid(folder / "terrain.asc", lambda x, y: 0.6 * x + 0.1 * y)
    (folder / "case.toml").write_text(text(3, dp=0.1, more=RELEASE))
    return load_scenario(folder / "case.toml")


@pytest.mark.parametrize(
    ("about", "said"),
    [
        ({"Thickness": 0.5}, "no attribute thickness, .*; did you mean Thickness?"),
        ({"depth": 0.5}, "no attribute thickness, .*; known: depth"),
        ({}, "no attribute thickness, .* give body.slide.thickness$"),
        ({"thickness": "0.5"}, "thickness = '0.5', not a length"),
        ({"thickness": True}, "thickness = True, not a length"),
        ({"thickness": 1e20}, r"thickness = 1e\+20, not a length in m above 0 and up to 10000"),
    ],
)
def test_polygons_without_a_thickness_are_refused(tmp_path, about, said):
    with pytest.raises(UserError, match=said):
        scenario_with(tmp_path, (SQUARE, about))


@pytest.mark.parametrize("about", [{}, {"thickness": None}, {"thickness": 0}])
def test_an_area_that_is_left_out_needs_no_thickness(tmp_path, about):
    scenario = scenario_with(tmp_path, (LINE, about), (SQUARE, {"thickness": 0.5}))
    release = scenario.body["slide"]
    assert (release.polygons, release.thickness) == ([[SQUARE[:-1]]], [0.5])
    assert any(isinstance(each, NoArea) for each in scenario.findings)
