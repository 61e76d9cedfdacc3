"""Windows, finer and coarser cells, smoothing and values between cells of a raster."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.geodata.ground import read_ground, write_ground
from doseki.geodata.raster import Raster

from .conftest import plane_at


def error(raster):
    """How far a raster is from the slope, m; NaN where it has no data."""
    return np.abs(raster.values - plane_at(raster.x[None, :], raster.y[:, None]))


def test_centres_and_edges(plane):
    assert plane.extent == (460_000.0, 5_200_000.0, 460_100.0, 5_200_150.0)
    assert plane.x[0] == 460_002.5
    assert plane.y[0] == 5_200_147.5  # row 0 is the northernmost
    assert plane.y[-1] == 5_200_002.5


@pytest.mark.parametrize(
    ("box", "expected"),
    [
        ((20, 30, 50, 70), (20, 30, 50, 70)),
        ((21, 31, 49, 69), (20, 30, 50, 70)),  # whole cells that cover it
        ((20 - 1e-8, 30, 50 + 1e-8, 70), (20, 30, 50, 70)),  # rounding adds no cell
        ((0, 0, 100, 150), (0, 0, 100, 150)),
    ],
)
def test_a_window(plane, box, expected):
    origin = np.array([plane.west, plane.south] * 2)
    window = plane.window(*(origin + box))
    np.testing.assert_allclose(window.extent, origin + expected, rtol=0, atol=1e-9)
    assert np.array_equal(window.values, plane_at(window.x[None, :], window.y[:, None]))


@pytest.mark.parametrize(
    "box",
    [(-1, 0, 5, 5), (0, 0, 101, 5), (0, 0, 5, 151), (0, -1, 5, 5), (5, 0, 5, 5), (9, 0, 5, 5)],
)
def test_a_window_outside_is_refused(plane, refusal, box):
    origin = np.array([plane.west, plane.south] * 2)
    assert refusal(plane.window, *(origin + box)).startswith("window [")


@pytest.mark.parametrize("cell", [1.0, 2.5, 3.3, 5.0, 10.0, 15.0])
def test_a_plane_on_other_cells_is_the_plane(plane, cell):
    assert np.nanmax(error(plane.resampled(cell))) < 1e-9
    assert np.isfinite(plane.resampled(cell).values).all()


def test_coarse_cells_have_the_mean_of_the_fine_ones(hills):
    coarse = hills.resampled(5.0)
    assert coarse.shape == (6, 8)
    low, left = hills.values[::-1][:2, :2], coarse.values[-1, 0]
    assert left == pytest.approx(low.mean())
    assert np.isnan(coarse.values).any()


@pytest.mark.parametrize(("known", "expected"), [(4, 2.5), (3, 2.0), (2, 1.5), (1, np.nan)])
def test_half_of_a_coarse_cell_must_be_known(known, expected):
    values = np.where(np.arange(4) < known, np.arange(1.0, 5.0), np.nan)
    coarse = Raster(values.reshape(2, 2), 0.0, 0.0, 1.0).resampled(2.0)
    np.testing.assert_allclose(coarse.values, [[expected]])


def test_coarse_cells_keep_the_volume(hills):
    """Also where fine cells are cut; controlled by a sum without the cut ones."""
    filled = hills.with_values(np.nan_to_num(hills.values, nan=700.0))
    coarse = filled.resampled(2.5 * 13 / 7)
    assert coarse.shape == (7, 9)
    width = 9 * 13 / 7  # of the coarse raster, in fine cells: 16 and a part
    weights = np.clip(width - np.arange(17), 0, 1)
    exact = (filled.values * weights).sum() * 2.5**2
    assert coarse.values.sum() * coarse.cell**2 == pytest.approx(exact, rel=1e-12)
    assert filled.values[:, :16].sum() * 2.5**2 != pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("length", [2.0, 10.0, 60.0])
def test_a_smoothed_plane_is_the_plane_at_edges_too(plane, length):
    values = plane.values.copy()
    values[4, 4] = values[10:14, 2:9] = np.nan
    smooth = plane.with_values(values).smoothed(length)
    assert np.array_equal(np.isnan(smooth.values), np.isnan(values))
    assert np.nanmax(error(smooth)) < 1e-8


@pytest.mark.parametrize("length", [2.0, 4.0, 30.0])
def test_a_smoothed_slope_of_a_profile_is_straight_up_to_its_ends(length):
    heights = 100 - 0.3 * np.arange(60.0)
    for values in (heights[None, :], heights[:, None]):
        smooth = Raster(values, 0.0, 0.0, 1.0).smoothed(length).values
        np.testing.assert_allclose(smooth, values, atol=1e-9)


def test_far_from_edges_smoothing_is_the_gaussian_mean():
    values = np.zeros((41, 41))
    values[20, 20] = 1.0
    smooth = Raster(values, 0.0, 0.0, 1.0).smoothed(2.0).values
    distance = np.arange(-20, 21)
    exact = np.exp(-(distance[:, None] ** 2 + distance[None, :] ** 2) / 8) / (8 * np.pi)
    assert np.abs(smooth - exact)[10:31, 10:31].max() < 1e-4 * exact.max()


def test_what_has_no_data_adds_nothing(plane):
    """A cliff among cells that are then taken away leaves no trace."""
    values = plane.values.copy()
    values[:, 10:] = np.nan
    other = plane.values[:, :10]
    both = plane.with_values(values).smoothed(10.0).values[:, :10]
    alone = Raster(other, plane.west, plane.south, plane.cell).smoothed(10.0).values
    np.testing.assert_allclose(both, alone, rtol=0, atol=1e-9)


def test_smoothing_over_no_length_changes_nothing(hills):
    assert hills.smoothed(0.0) is hills


def test_values_between_centres(hills):
    x, y = np.meshgrid(hills.x, hills.y)
    np.testing.assert_array_equal(hills.sampled(x, y), hills.values)
    middle = hills.sampled(hills.x[10:12].mean(), hills.y[10:12].mean())
    assert middle == pytest.approx(hills.values[10:12, 10:12].mean())


def test_a_plane_is_a_plane_up_to_its_edges(plane):
    random = np.random.default_rng(3)
    x = random.uniform(plane.west, plane.east, 500)
    y = random.uniform(plane.south, plane.north, 500)
    values = plane.values.copy()
    values[3, 3] = values[20, 7:9] = np.nan
    found = plane.with_values(values).sampled(x, y)
    assert np.nanmax(np.abs(found - plane_at(x, y))) < 1e-9
    row, column = (plane.north - y) // 5, (x - plane.west) // 5
    unknown = np.isnan(values[row.astype(int), column.astype(int)])
    assert np.array_equal(np.isnan(found), unknown)


def test_there_is_nothing_outside(plane):
    x = np.array([plane.west - 0.01, plane.east + 0.01, plane.west, np.nan, np.inf])
    found = plane.sampled(x, np.full(5, plane.south + 1))
    assert np.array_equal(np.isfinite(found), [False, False, True, False, False])


@pytest.mark.parametrize("shape", [(1, 1), (1, 4), (4, 1)])
def test_the_smallest_rasters(shape):
    raster = Raster(np.full(shape, 7.0), 0.0, 0.0, 1.0)
    for other in (raster.smoothed(0.5), raster.resampled(0.5), raster.resampled(1.0)):
        np.testing.assert_allclose(other.values, 7.0, rtol=1e-12)
    assert raster.sampled(0.1, 0.9) == 7.0


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (lambda r: r.with_values(np.zeros((2, 2))), "values"),
        (lambda r: r.resampled(0.0), "above 0"),
        (lambda r: r.resampled(float("nan")), "above 0"),
        (lambda r: r.resampled(1e9), "larger than the raster"),
        (lambda r: r.resampled(1e-9), "at most"),
        (lambda r: r.smoothed(-1.0), "smoothing"),
        (lambda r: r.smoothed(1e9), "longer than the raster"),
        (lambda r: Raster(r.values, 0.0, 0.0, 0.0), "cell"),
        (lambda r: Raster(r.values, np.nan, 0.0, 1.0), "finite"),
        (lambda r: Raster(r.values + np.inf, 0.0, 0.0, 1.0), "infinite"),
        (lambda r: Raster(np.zeros(3), 0.0, 0.0, 1.0), "shape"),
    ],
)
def test_what_is_no_raster_is_refused(plane, refusal, change, word):
    assert word in refusal(change, plane)


@pytest.mark.parametrize("driver", ["AAIGrid", "GTiff"])
@pytest.mark.parametrize(
    ("own", "written"), [(None, -9999), (-32768, -32768), (8, -9999), (-9999, -9999)]
)
def test_the_ground_of_a_run_keeps_its_number_for_no_data(tmp_path, own, written, driver):
    """Unless that is one of its heights."""
    if driver == "GTiff":
        pytest.importorskip("rasterio", reason="pip install 'doseki[terrain]'")
    values = np.array([[8.0, np.nan], [9.0, 10.0]])
    write_ground(tmp_path, Raster(values, 0.0, 0.0, 1.0, None, driver, own))
    kept = read_ground(tmp_path)
    assert kept.nodata == written
    np.testing.assert_array_equal(kept.values, values)


def test_the_number_for_no_data_is_never_a_value():
    heights = Raster(np.array([[-9999.0, -32768.0], [np.nan, 1.0]]), 0.0, 0.0, 1.0)
    assert heights.with_free_nodata().nodata == -99999.0
    grid = Raster(np.ones((2, 2)), 0.0, 0.0, 1.0, None, "AAIGrid", np.nan)
    assert grid.with_free_nodata().nodata == -9999.0  # ESRI ASCII grids have numbers alone
