"""ESRI ASCII grids: read, written, and refused in a sentence."""

from __future__ import annotations

import subprocess

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.geodata.raster import read_raster, write_raster

HEADER = "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 5\n"
GRID = HEADER + "NODATA_value -9999\n1 2 3\n4 -9999 6\n"


@pytest.fixture
def grid(tmp_path):
    """A function that writes a text as a grid, and its path."""

    def write(text, name="dem.asc"):
        path = tmp_path / name
        path.write_bytes(text.encode())
        return path

    return write


def test_a_grid_is_read(grid):
    raster = read_raster(grid(GRID))
    assert raster.extent == (100.0, 200.0, 115.0, 210.0)
    assert (raster.cell, raster.nodata, raster.crs, raster.driver) == (
        5.0,
        -9999.0,
        None,
        "AAIGrid",
    )
    np.testing.assert_array_equal(raster.values, [[1, 2, 3], [4, np.nan, 6]])


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.upper(),
        lambda text: text.replace("xllcorner 100", "XLLCENTER 102.5").replace(
            "yllcorner 200", "yllcenter 202.5"
        ),
        lambda text: text.replace("cellsize 5", "dx 5\ndy 5.000000001"),
        lambda text: text.replace("\n", "\r\n"),
        lambda text: text.replace("3\n4 ", "3 4 "),  # rows may be wrapped anywhere
        lambda text: text.replace("2 3\n4 ", "2\n3 4\n"),
        lambda text: "\ufeff" + text,
        lambda text: text.replace("-9999", "nan"),
        lambda text: text.replace("1 2 3", "  1.0 2e0\t+3 "),
        lambda text: "\n" + text + "\n\n",
    ],
)
def test_the_same_grid_otherwise_written(grid, change):
    raster = read_raster(grid(change(GRID)))
    np.testing.assert_allclose(raster.extent, (100.0, 200.0, 115.0, 210.0), rtol=1e-8)
    np.testing.assert_array_equal(raster.values, [[1, 2, 3], [4, np.nan, 6]])


def test_without_a_number_for_no_data(grid):
    raster = read_raster(grid(HEADER + "1 2 3\n4 -9999 nan"))
    assert raster.nodata is None
    np.testing.assert_array_equal(raster.values, [[1, 2, 3], [4, -9999, np.nan]])


def test_a_number_for_no_data_is_known_by_fewer_digits(grid, tmp_path):
    """As of a raster of single precision, whose lowest number stands with twelve digits."""
    lowest, short = "-3.4028234663852886e+38", "-3.40282346639e+38"
    raster = read_raster(grid(HEADER + f"NODATA_value {lowest}\n1 2 3\n4 {short} 6\n"))
    np.testing.assert_array_equal(raster.values, [[1, 2, 3], [4, np.nan, 6]])


REFUSED = {
    "cut off": (GRID[:-8], "4 values"),
    "header alone": (HEADER, "0 values"),
    "a billion columns": (GRID.replace("ncols 3", "ncols 1000000000"), "cut off"),
    "more columns than numbers go": (GRID.replace("ncols 3", f"ncols {'9' * 400}"), "finite"),
    "letters": (GRID.replace("2 3", "2 abc"), 'line 7: "abc" is no number'),
    "decimal commas": (GRID.replace("2 3", "2 3,5"), '"3,5" is no number'),
    "infinite": (GRID.replace("2 3", "2 inf"), "infinite"),
    "half a column": (GRID.replace("ncols 3", "ncols 3.5"), "whole number"),
    "no columns": (GRID.replace("ncols 3", "ncols 0"), "whole number"),
    "no cellsize": (GRID.replace("cellsize 5\n", ""), "cellsize is missing"),
    "cellsize is a word": (GRID.replace("cellsize 5", "cellsize five"), '"five"'),
    "negative cells": (GRID.replace("cellsize 5", "cellsize -5"), "larger than 0"),
    "oblong cells": (GRID.replace("cellsize 5", "dx 5\ndy 6"), "gdalwarp -tr 5 5"),
    "both sizes": (GRID.replace("cellsize 5", "dx 5\ndy 5\ncellsize 5"), "exclude"),
    "both corners": (GRID.replace("cellsize", "xllcenter 3\ncellsize"), "exclude"),
    "twice": ("ncols 3\n" + GRID, "given twice"),
    "misspelt": (GRID.replace("cellsize", "cellsise"), "did you mean cellsize"),
    "a row moved": (GRID.replace("3\n4 ", "3 4\n\n"), "row 1 has 4 values where ncols = 3"),
    "cells of no map": (GRID.replace("cellsize 5", "cellsize 1e300"), "cells of 1e+300 m"),
    "corner of no map": (GRID.replace("xllcorner 100", "xllcorner 1e12"), "below 1e+09 m"),
    "corner at infinity": (GRID.replace("xllcorner 100", "xllcorner inf"), "finite"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_wrong_is_said_in_a_sentence(grid, refusal, name):
    text, word = REFUSED[name]
    assert word in refusal(read_raster, grid(text))


@pytest.mark.parametrize("content", [b"", b"\0" * 99, b"\xff\xfe" * 30, b"hello", b"PK\3\4"])
def test_what_is_no_grid_is_refused(tmp_path, refusal, content):
    (tmp_path / "x.asc").write_bytes(content)
    assert "neither" in refusal(read_raster, tmp_path / "x.asc")


def test_what_is_no_text_is_refused(tmp_path):
    (tmp_path / "x.asc").write_bytes(b"ncols 3\n\xff\xff")
    with pytest.raises(UserError, match="line 2"):
        read_raster(tmp_path / "x.asc")


@pytest.mark.parametrize("where", ["absent.asc", "", "/dev/zero"])
def test_what_is_no_file_is_refused(tmp_path, where):
    with pytest.raises(UserError):
        read_raster(tmp_path / where)


def test_what_is_written_is_read_back(tmp_path, hills):
    write_raster(tmp_path / "a.asc", hills)
    back = read_raster(tmp_path / "a.asc")
    np.testing.assert_array_equal(back.values, hills.values)
    assert (back.extent, back.cell, back.nodata) == (hills.extent, hills.cell, hills.nodata)


def test_a_projection_beside_it_is_kept(tmp_path, grid):
    wkt = 'PROJCS["local",GEOGCS["g"],UNIT["metre",1]]'
    (tmp_path / "dem.prj").write_text(wkt)
    raster = read_raster(grid(GRID))
    assert raster.crs == wkt
    write_raster(tmp_path / "copy.asc", raster)
    assert read_raster(tmp_path / "copy.asc").crs == wkt


@pytest.mark.parametrize(
    ("wkt", "word"),
    [
        ('GEOGCS["WGS 84",UNIT["degree",0.0174]]', "gdalwarp -t_srs"),
        ('PROJCS["x",GEOGCS["g"],UNIT["Foot_US",0.3048]]', "Foot_US"),
        ("Projection UTM\nZone 33", "WKT"),
        ("Projection    GEOGRAPHIC\nDatum WGS84\nUnits DD\n", "coordinates are degrees"),
        ("projection geographic\nunits dd\nparameters\n", "gdalwarp -t_srs"),
    ],
)
def test_a_projection_that_is_not_in_metres_is_refused(tmp_path, grid, refusal, wkt, word):
    (tmp_path / "dem.prj").write_text(wkt)
    assert word in refusal(read_raster, grid(GRID))


def test_a_projection_of_an_earlier_file_does_not_stay(tmp_path, hills):
    (tmp_path / "a.prj").write_text('PROJCS["other",UNIT["metre",1]]')
    write_raster(tmp_path / "a.asc", hills)
    assert read_raster(tmp_path / "a.asc").crs is None


def test_a_value_that_means_no_data_is_not_written(tmp_path, hills, refusal):
    values = hills.values.copy()
    values[0, 0] = -9999.0 + 1e-6
    assert "no data" in refusal(write_raster, tmp_path / "a.asc", hills.with_values(values))
    assert not (tmp_path / "a.asc").exists()


def test_an_unknown_ending_is_refused(tmp_path, hills, refusal):
    assert ".asc or .tif" in refusal(write_raster, tmp_path / "a.png", hills)


def test_gdal_reads_what_is_written(tmp_path, hills, gdal):
    write_raster(tmp_path / "a.asc", hills)
    command = [gdal, "-json", "-stats", str(tmp_path / "a.asc")]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert '"size":[\n    17,\n    13\n  ]' in said
    assert '"driverShortName":"AAIGrid"' in said
    assert '"noDataValue":-9999.0' in said
    assert f'"mean":{np.nanmean(hills.values):.2f}'[:10] in said


def test_real_grids(terrain_data):
    slide = read_raster(terrain_data / "avaSlide/Inputs/slideTopo.asc")
    assert slide.shape == (201, 419)
    assert slide.extent == (1.0, 1.0, 2096.0, 1006.0)  # the file gives the centre of a cell
    assert (slide.values.min(), slide.values.max()) == (1000.0, 1752.6)
