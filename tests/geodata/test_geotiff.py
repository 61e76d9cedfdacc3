"""GeoTIFF: read, written, and refused in a sentence; GDAL's own programs as the other side."""

from __future__ import annotations

import json
import math
import shutil
import subprocess
import sys

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.geodata.raster import Raster, read_raster, write_raster

rasterio = pytest.importorskip("rasterio", reason="rasterio: pip install 'doseki[terrain]'")

UTM = "EPSG:32633"
VALUES = np.array([[1, 2, 3], [4, 0, 6]])


@pytest.fixture
def tiff(tmp_path):
    """A function that writes VALUES as a GeoTIFF with rasterio alone, and its path."""

    def write(values=VALUES, dtype="float32", place=(5.0, 0.0, 100.0, 0.0, -5.0, 210.0), **about):
        path = tmp_path / "dem.tif"
        tail = about.pop("after", lambda dataset: None)
        settings = {
            "driver": "GTiff", "dtype": dtype, "count": 1, "crs": UTM,
            "height": values.shape[-2], "width": values.shape[-1],
            "transform": rasterio.Affine(*place),
        }  # fmt: skip
        with rasterio.open(path, "w", **settings | about) as dataset:
            for band in range(1, dataset.count + 1):
                dataset.write(values.astype(dtype), band)
            tail(dataset)
        return path

    return write


@pytest.mark.parametrize("compress", ["none", "lzw", "deflate", "zstd", "packbits"])
@pytest.mark.parametrize("dtype", ["uint8", "int16", "int32", "float32", "float64"])
def test_numbers_of_any_kind(tiff, compress, dtype):
    raster = read_raster(tiff(dtype=dtype, compress=compress, nodata=0))
    assert raster.extent == (100.0, 200.0, 115.0, 210.0)
    assert (raster.cell, raster.nodata, raster.driver) == (5.0, 0.0, "GTiff")
    np.testing.assert_array_equal(raster.values, [[1, 2, 3], [4, np.nan, 6]])
    assert raster.crs.startswith('PROJCS["WGS 84 / UTM zone 33N"')


def test_tiles(tiff):
    values = np.arange(100.0 * 70).reshape(100, 70)
    path = tiff(values, "float64", tiled=True, blockxsize=16, blockysize=32)
    np.testing.assert_array_equal(read_raster(path).values, values)


def test_without_a_reference_system(tiff):
    assert read_raster(tiff(crs=None)).crs is None


def test_rows_from_south_to_north(tiff):
    raster = read_raster(tiff(place=(5.0, 0.0, 100.0, 0.0, 5.0, 200.0)))
    assert raster.extent == (100.0, 200.0, 115.0, 210.0)
    np.testing.assert_array_equal(raster.values, VALUES[::-1])


def test_a_number_for_no_data_that_is_no_float32(tmp_path, tiff, gdal):
    """As text in the file it has fewer digits than the value that it means."""
    lowest = np.finfo(np.float32).min
    path = tiff(np.array([[1.0, lowest], [3.0, 4.0]]))
    copy = tmp_path / "copy.tif"
    command = ["gdal_translate", "-q", "-a_nodata", "-3.4028235e+38", str(path), str(copy)]
    subprocess.run(command, check=True)
    raster = read_raster(copy)
    np.testing.assert_array_equal(raster.values, [[1, np.nan], [3, 4]])
    write_raster(tmp_path / "again.tif", raster)
    np.testing.assert_array_equal(read_raster(tmp_path / "again.tif").values, raster.values)


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_a_number_for_no_data_of_fewer_digits(tiff, dtype):
    values = np.array([[1.0, np.finfo(np.float32).min], [3.0, 4.0]])
    raster = read_raster(tiff(values, dtype, nodata=-3.40282346639e38))
    np.testing.assert_array_equal(raster.values, [[1, np.nan], [3, 4]])


def test_a_mask_in_the_file(tiff):
    mask = np.array([[255, 255, 0], [255, 255, 255]], dtype=np.uint8)
    with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=True):
        path = tiff(after=lambda dataset: dataset.write_mask(mask))
    np.testing.assert_array_equal(read_raster(path).values, [[1, 2, np.nan], [4, 0, 6]])


def test_scale_and_offset_are_applied(tiff):
    def scaled(dataset):
        dataset.scales, dataset.offsets = (0.1,), (1000.0,)

    path = tiff(dtype="int16", nodata=0, after=scaled)
    expected = [[1000.1, 1000.2, 1000.3], [1000.4, np.nan, 1000.6]]
    np.testing.assert_allclose(read_raster(path).values, expected)


def feet(dataset):
    dataset.units = ("ft",)


REFUSED = {
    "two bands": ({"count": 2}, "gdal_translate -b 1"),
    "rotated": ({"place": (5.0, 1.0, 0.0, 1.0, -5.0, 0.0)}, "gdalwarp IN OUT"),
    "mirrored": ({"place": (-5.0, 0.0, 0.0, 0.0, -5.0, 0.0)}, "north up"),
    "oblong cells": ({"place": (5.0, 0.0, 0.0, 0.0, -4.0, 0.0)}, "gdalwarp -tr 5 5"),
    "degrees": ({"crs": "EPSG:4326"}, "gdalwarp -t_srs"),
    "geocentric": ({"crs": "EPSG:4978"}, "geocentric"),
    "a map in feet": ({"crs": "EPSG:2227"}, "foot"),
    "heights in feet": (
        {"after": feet},
        'heights are in "ft", and metres are needed; multiply them',
    ),
    "nowhere": ({"place": (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)}, "where on the map"),
    "complex numbers": ({"dtype": "complex64"}, "complex64"),
    "infinite": ({"values": np.array([[1.0, np.inf]])}, "row 1, column 2 holds inf, which is no"),
}


@pytest.mark.parametrize("name", REFUSED)
@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
def test_what_cannot_be_used_is_refused(tiff, refusal, name):
    about, word = REFUSED[name]
    assert word in refusal(read_raster, tiff(**about))


@pytest.mark.parametrize("size", [4, 8, 60, 200, 0.5, 0.9])
def test_a_file_cut_off_is_refused(tiff, size):
    path = tiff(np.random.default_rng(1).random((60, 60)), "float64", compress="deflate")
    content = path.read_bytes()
    path.write_bytes(content[: size if size > 1 else int(size * len(content))])
    with pytest.raises(UserError) as caught:
        read_raster(path)
    assert str(path) in str(caught.value)
    assert "TIFF" not in str(caught.value).replace("GeoTIFF", "")


@pytest.mark.parametrize("compress", ["none", "deflate"])
def test_a_file_without_its_end_is_told_from_others(tiff, compress):
    path = tiff(np.random.default_rng(1).random((60, 60)), "float64", compress=compress)
    # The directory stands before the numbers.
    with path.open("r+b") as file:
        file.truncate(path.stat().st_size // 2)
    with pytest.raises(UserError, match=r"cannot be read to its end: .* cut off as it was copied"):
        read_raster(path)


def test_more_cells_than_memory_are_refused(tmp_path, refusal):
    """A few kilobytes may declare 10^12 cells."""
    path = tmp_path / "huge.tif"
    about = {"driver": "GTiff", "dtype": "uint8", "count": 1, "sparse_ok": True, "tiled": True}
    size = {"width": 1_000_000, "height": 1_000_000, "blockxsize": 16384, "blockysize": 16384}
    place = {"transform": rasterio.Affine(1, 0, 5, 0, -1, 5)}
    rasterio.open(path, "w", **about, **size, **place).close()
    assert path.stat().st_size < 10**6
    assert "more than this machine can hold" in refusal(read_raster, path)


def masked(dataset):
    dataset.write_mask(np.arange(30 * 40).reshape(30, 40) % 7 > 0)


def stretched(dataset):
    dataset.scales, dataset.offsets = (0.1,), (1000.0,)


@pytest.mark.parametrize("tiled", [True, False])
@pytest.mark.parametrize("upwards", [True, False])
@pytest.mark.parametrize("about", [{}, {"nodata": 5.0}, {"after": masked}, {"after": stretched}])
def test_a_window_of_a_file_is_that_of_its_raster(tiff, upwards, about, tiled):
    values = np.random.default_rng(3).integers(0, 9, (30, 40)) / 7
    place = (2.5, 0.0, 460_000.1, 0.0, *((2.5, 5_200_000.3) if upwards else (-2.5, 5_200_075.3)))
    blocks = {"tiled": True, "blockxsize": 16, "blockysize": 16} if tiled else {}
    with rasterio.Env(GDAL_TIFF_INTERNAL_MASK=True):
        path = tiff(np.where(values > 1, 5.0, values), place=place, **about, **blocks)
    whole = read_raster(path)
    for low, size in (((7.3, 3.1), (31.0, 20.2)), ((0, 0), (100, 75)), ((97.5, 0), (2.5, 2.5))):
        west, south = whole.west + low[0], whole.south + low[1]
        box = (west, south, west + size[0], south + size[1])
        part, expected = read_raster(path, box), whole.window(*box)
        np.testing.assert_array_equal(part.values, expected.values)
        assert part.values.flags.c_contiguous
        assert part.extent == expected.extent
        assert (part.crs, part.driver, part.nodata) == (whole.crs, whole.driver, whole.nodata)


def test_of_a_large_file_only_the_window_is_read(tmp_path, refusal, monkeypatch):
    """Of 10^10 cells those of 2 x 3, however little memory there is."""
    path = tmp_path / "large.tif"
    about = {"driver": "GTiff", "dtype": "float32", "count": 1, "sparse_ok": True, "tiled": True}
    size = {"width": 100_000, "height": 100_000, "blockxsize": 512, "blockysize": 512}
    place = {"transform": rasterio.Affine(2, 0, 0, 0, -2, 200_000)}
    with rasterio.open(path, "w", **about, **size, **place) as dataset:
        window = rasterio.windows.Window(50_000, 40_000, 3, 2)
        dataset.write(np.arange(1, 7, dtype="float32").reshape(2, 3), 1, window=window)
    monkeypatch.setattr("doseki.geodata.geotiff.available_bytes", lambda: 1000)
    raster = read_raster(path, (100_000, 119_996, 100_006, 120_000))
    np.testing.assert_array_equal(raster.values, [[1, 2, 3], [4, 5, 6]])
    said = refusal(read_raster, path, (0, 0, 20, 20))
    assert "10 x 10 cells are more than this machine can hold" in said
    assert "reaches beyond the raster" in refusal(read_raster, path, (-2, 0, 20, 20))


@pytest.mark.parametrize("upwards", [True, False])
def test_a_cell_of_a_window_is_named_as_in_the_file(tiff, refusal, upwards):
    values = np.ones((20, 30))
    values[12, 7] = np.inf
    path = tiff(values, place=(5.0, 0.0, 0.0, 0.0, *((5.0, 0.0) if upwards else (-5.0, 100.0))))
    y = 62.5 if upwards else 37.5
    for window in (None, (30.0, y - 10, 60.0, y + 10)):
        assert "row 13, column 8 holds inf, which" in refusal(read_raster, path, window)
    read_raster(path, (50.0, 0.0, 100.0, 100.0))


def test_a_file_that_points_at_another_is_not_followed(tmp_path, tiff, refusal):
    """GDAL would take this text for a raster made of another file."""
    source = f"<SourceFilename>{tiff()}</SourceFilename>"
    path = tmp_path / "link.tif"
    path.write_text(f'<VRTDataset rasterXSize="3" rasterYSize="2">{source}</VRTDataset>')
    assert "neither" in refusal(read_raster, path)


@pytest.mark.parametrize("nodata", [None, -9999.0, math.nan])
def test_what_is_written_is_read_back(tmp_path, hills, nodata):
    raster = Raster(hills.values, *hills.extent[:2], hills.cell, UTM, "GTiff", nodata)
    write_raster(tmp_path / "a.tif", raster, {"name": "pft"})
    back = read_raster(tmp_path / "a.tif")
    np.testing.assert_array_equal(back.values, hills.values)
    assert (back.extent, back.cell) == (hills.extent, hills.cell)
    assert "32633" in back.crs
    with rasterio.open(tmp_path / "a.tif") as dataset:
        assert dataset.tags()["name"] == "pft"
        assert dataset.compression.name == "deflate"


def test_an_unknown_reference_system_is_refused(tmp_path, hills, refusal):
    raster = Raster(hills.values, *hills.extent[:2], hills.cell, "EPSG:999999", "GTiff")
    assert "cannot be written" in refusal(write_raster, tmp_path / "a.tif", raster)
    assert list(tmp_path.iterdir()) == []


def test_gdal_sees_what_was_written(tmp_path, hills, gdal):
    raster = Raster(hills.values, *hills.extent[:2], hills.cell, UTM, "GTiff", -9999.0)
    write_raster(tmp_path / "a.tif", raster)
    command = [gdal, "-json", "-stats", str(tmp_path / "a.tif")]
    said = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    west, south, east, north = hills.extent
    assert said["cornerCoordinates"]["upperLeft"] == [west, north]
    assert said["cornerCoordinates"]["lowerRight"] == [east, south]
    assert 'ID["EPSG",32633]' in said["coordinateSystem"]["wkt"]
    (band,) = said["bands"]
    assert band["noDataValue"] == -9999.0
    assert band["mean"] == pytest.approx(np.nanmean(hills.values), abs=1e-3)
    assert band["maximum"] == pytest.approx(np.nanmax(hills.values), abs=1e-3)


def test_gdal_makes_the_same_of_an_ascii_grid(tmp_path, hills, gdal):
    """Our grid, read by GDAL, written as a GeoTIFF, read by us."""
    write_raster(tmp_path / "a.asc", hills)
    command = ["gdal_translate", "-q", "-oo", "DATATYPE=Float64", "-a_srs", UTM]
    subprocess.run([*command, str(tmp_path / "a.asc"), str(tmp_path / "b.tif")], check=True)
    back = read_raster(tmp_path / "b.tif")
    np.testing.assert_allclose(back.values, hills.values, rtol=1e-12)
    np.testing.assert_allclose(back.extent, hills.extent, rtol=1e-12)


@pytest.mark.parametrize("way", [("average", 10.0), ("bilinear", 1.25)])
def test_gdal_resamples_alike(tmp_path, plane, gdal, way):
    """Coarse cells are means of fine ones; fine ones lie between centres, away from edges."""
    method, cell = way
    values = plane.values + np.random.default_rng(2).random(plane.shape)
    plane = Raster(values[:, :18], *plane.extent[:2], 5.0, UTM, "GTiff")
    write_raster(tmp_path / "a.tif", plane)
    command = ["gdalwarp", "-q", "-r", method, "-tr", str(cell), str(cell)]
    subprocess.run([*command, str(tmp_path / "a.tif"), str(tmp_path / "b.tif")], check=True)
    theirs, ours = read_raster(tmp_path / "b.tif"), plane.resampled(cell)
    inner = slice(4, -4)
    np.testing.assert_allclose(theirs.extent, ours.extent)
    np.testing.assert_allclose(
        theirs.values[inner, inner], ours.values[inner, inner], rtol=0, atol=1e-6
    )


def test_without_rasterio_one_sentence(tiff, refusal, monkeypatch, hills):
    path = tiff()
    monkeypatch.setitem(sys.modules, "rasterio", None)
    assert "pip install 'doseki[terrain]'" in refusal(read_raster, path)
    assert "pip install 'doseki[terrain]'" in refusal(write_raster, path, hills)


def test_real_rasters(terrain_data, tmp_path):
    alr = read_raster(terrain_data / "avaAlr/Inputs/avaAlr.tif")
    assert (alr.shape, alr.cell) == ((915, 417), 5.0)
    assert np.nanmin(alr.values) == pytest.approx(566.13, abs=0.01)
    assert np.nanmax(alr.values) == pytest.approx(2452.32, abs=0.01)
    thickness = read_raster(
        terrain_data / "benchmarks/avaAlrNullTest/relAlr_c544043f9e_C_M_null_dfa_pft.tif"
    )
    assert alr.same_grid(thickness)
    assert thickness.values.max() == pytest.approx(9.1135, abs=1e-4)


@pytest.mark.parametrize(
    ("name", "crs", "largest"),
    [
        ("ca_avalanche.tif", False, 100.0),
        ("ca_debrisflow.tif", True, 8.298797607421875),
        ("ca_impactarea.tif", True, 1.0),
    ],
)
def test_compressed_rasters_with_a_peculiar_nodata(terrain_data, name, crs, largest):
    raster = read_raster(terrain_data / "ravaflow" / name)
    assert raster.shape == (887, 1537)
    assert (raster.crs is not None) == crs
    assert np.nanmax(raster.values) == largest
    assert np.nanmin(raster.values) == 0.0


def test_real_rasters_as_gdal_reads_them(terrain_data, tmp_path, gdal):
    """GDAL writes the terrain as an ASCII grid; both are the same to us."""
    source = terrain_data / "avaAlr/Inputs/avaAlr.tif"
    copy = tmp_path / "alr.asc"
    command = ["gdal_translate", "-q", "-of", "AAIGrid", str(source), str(copy)]
    subprocess.run(command, check=True)
    tif, asc = read_raster(source), read_raster(copy)
    assert tif.same_grid(asc)
    np.testing.assert_allclose(asc.values, tif.values, rtol=1e-9)
    assert "MGI" in asc.crs
    shutil.copy(source, tmp_path / "other.name")
    np.testing.assert_array_equal(read_raster(tmp_path / "other.name").values, tif.values)
