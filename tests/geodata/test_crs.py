"""Systems of coordinates: which are metres on a map, and which are the same."""

from __future__ import annotations

import sys

import pytest

from doseki.geodata.crs import (
    check_map_coordinates,
    epsg_code,
    needs_rasterio,
    same_crs,
    why_not_compared,
)

UTM = 'PROJCS["zone",GEOGCS["g",UNIT["degree",0.0174]],UNIT["metre",1]{code}]'
UTM32, UTM33 = (UTM.format(code=f',AUTHORITY["EPSG","{n}"]') for n in (32632, 32633))
UNNAMED = UTM.format(code="")
HEIGHTS = 'VERT_CS["h",UNIT["metre",1]],AUTHORITY["EPSG","9999"]]'


@pytest.fixture(params=[False, True])
def without_rasterio(request, monkeypatch):
    """Tests with and, where it is installed, without it."""
    if request.param:
        monkeypatch.setitem(sys.modules, "rasterio", None)
    else:
        pytest.importorskip("rasterio", reason="rasterio: pip install 'doseki[terrain]'")
    return request.param


@pytest.mark.parametrize(
    "crs",
    [
        "EPSG:4269",
        "urn:ogc:def:crs:EPSG::4312",
        "http://www.opengis.net/def/crs/EPSG/0/4326",
        "EPSG:4326+5773",
        "EPSG:2263",
        "EPSG:4978",
    ],
)
def test_a_name_of_degrees_or_feet_is_refused(without_rasterio, refusal, crs):
    said = refusal(check_map_coordinates, "a.geojson", crs)
    assert "a.geojson: " in said
    assert "gdalwarp -t_srs" in said


@pytest.mark.parametrize("crs", ["EPSG:32633", "EPSG:4647", "urn:ogc:def:crs:EPSG::31287"])
def test_a_name_of_metres_is_not(without_rasterio, crs):
    check_map_coordinates("a.geojson", crs)


@pytest.mark.parametrize(
    ("wkt", "word"),
    [
        ('GEOCCS["WGS 84",UNIT["metre",1]]', "geocentric"),
        ('GEODCRS["WGS 84",CS[Cartesian,3],LENGTHUNIT["metre",1]]', "geocentric"),
        (f'COMPD_CS["c",GEOGCS["g",UNIT["degree",0.0174]],{HEIGHTS}', "degrees"),
        ('PROJCS["km",GEOGCS["g"],UNIT["kilometre",1000]]', "kilometre"),
    ],
)
def test_a_text_of_something_else_is_refused(refusal, wkt, word):
    assert word in refusal(check_map_coordinates, "a.prj", wkt)


def test_a_text_of_metres_is_not():
    for wkt in (UTM32, UNNAMED, f'COMPD_CS["c",{UTM32},{HEIGHTS}'):
        check_map_coordinates("a.prj", wkt)


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        (UTM32, UTM33, False),
        (UTM32, "EPSG:32632", True),
        (UTM32, "EPSG:32633", False),
        ("EPSG:31287+5778", "EPSG:31287", True),
        (f'COMPD_CS["c",{UTM32},{HEIGHTS}', UTM32, True),
        (UNNAMED, UTM32, None),
        (UTM32, None, None),
    ],
)
def test_numbers_in_the_texts_are_compared_without_rasterio(monkeypatch, one, other, same):
    monkeypatch.setitem(sys.modules, "rasterio", None)
    assert same_crs(one, other) is same
    assert same_crs(other, one) is same
    assert needs_rasterio(one, other) is (one == UNNAMED)


@pytest.mark.parametrize(
    ("one", "other", "why"),
    [
        (UTM32, UTM32, None),
        (UTM32, UTM33, None),
        (None, UTM32, None),
        (UTM32, None, "that of the terrain is not known"),
        (UNNAMED, UTM32, "needs rasterio"),
        ("EPSG:32632", None, "needs rasterio"),  # which knows if it is in metres
    ],
)
def test_a_system_that_was_not_compared_is_told(monkeypatch, one, other, why):
    monkeypatch.setitem(sys.modules, "rasterio", None)
    said = why_not_compared(one, other)
    assert said is None if why is None else why in said


def test_the_number_of_a_compound_system_is_that_of_its_map(without_rasterio):
    heights = 'VERT_CS["h",UNIT["metre",1]]]'
    for of_heights in (HEIGHTS, heights):
        assert epsg_code(f'COMPD_CS["c",{UTM32},{of_heights}') == 32632
    assert epsg_code("EPSG:31287+5778") == 31287
    assert epsg_code(UTM33) == 32633
