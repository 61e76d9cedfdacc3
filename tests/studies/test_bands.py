"""Percentiles over runs whose values are known, and their pictures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.figures.nothing import NothingToDrawError
from doseki.figures.studies.responses import Column, grid_images, parallel_coordinates, responses
from doseki.geodata.grid import Raster
from doseki.geodata.raster import read_raster
from doseki.studies.outcome import bands
from doseki.studies.outcome.table import Entry, Table
from doseki.studies.reading.bands import Curve, MapBand, SeriesBand, curve_text
from doseki.studies.runs.folder import RunPlace
from doseki.studies.runs.row import DONE, FAILED, Row

RUNS = 21
SERIES = SeriesBand(kind="series", gauge="g", column="height")


@pytest.fixture
def table(tmp_path):
    """Runs k = 0 to 20 with the score k, and one that failed."""
    places = [RunPlace(tmp_path / f"{k:04d}-000000000000") for k in range(RUNS + 1)]
    for k, place in enumerate(places):
        place.path.mkdir()
        x = np.linspace(0, 1, 11 + k)  # each run has samples of its own
        curve = Curve(x, k * x, "time (s)", "height (m)")
        place.curve("level").write_text(curve_text(curve))
    rows = [Row(DONE, "", score=float(k)) for k in range(RUNS)]
    entries = [Entry(p, (), row) for p, row in zip(places, rows, strict=False)]
    return Table(None, [*entries, Entry(places[-1], (), Row(FAILED, "", "lost"))])


def test_a_curve_has_percentiles(table):
    found = bands.curve_percentiles("level", SERIES, table)
    assert len(found.runs) == RUNS
    assert found.values == pytest.approx(np.outer([1, 10, 19], found.x))  # 5, 50, 95 % of 0..20
    near = SERIES.model_copy(update={"max_score": 10.0})
    found = bands.curve_percentiles("level", near, table)
    assert found.values[1] == pytest.approx(5 * found.x)
    with pytest.raises(UserError, match="a band needs 3"):
        bands.curve_percentiles("level", SERIES.model_copy(update={"max_score": 1.0}), table)


def test_gaps_count_for_nothing():
    values = np.array([[1.0, np.nan, np.nan], [2.0, 5.0, np.nan], [3.0, 7.0, np.nan]])
    found = bands.percentiles(values, [0, 50, 100])
    assert found[:, 0] == pytest.approx([1, 2, 3])
    assert found[:, 1] == pytest.approx([5, 6, 7])
    assert np.isnan(found[:, 2]).all()


class FakeRun:
    """A run with a map: depth k in the west; arrival after k s, in the runs beyond 10 never."""

    def __init__(self, path):
        self.directory, self.ground = path, None
        self.k = int(path.parent.name[:4])


def raster_of(band, run):
    depth = np.zeros((3, 4))
    depth[:, :2] = run.k
    if band.map == "arrival_time":
        depth = np.where(depth * (run.k <= 10) > 0, run.k, np.nan)
    depth[0, 3] = np.nan  # no ground
    return Raster(depth, 500.0, 700.0, 10.0 if run.k < 99 else 5.0)


@pytest.fixture
def maps(monkeypatch):
    monkeypatch.setattr(bands, "load", FakeRun)
    monkeypatch.setattr(MapBand, "raster", raster_of)


def test_a_map_has_percentiles_and_a_probability(table, maps, tmp_path):
    band = MapBand(kind="map", map="peak_depth", exceed=14.5)
    found = bands.map_percentiles(band, table)
    for raster, expected in zip(found.percentiles, (1, 10, 19), strict=True):
        assert raster.values[:, :2] == pytest.approx(expected)
        assert raster.values[1:, 2:] == pytest.approx(0)
        assert np.isnan(raster.values[0, 3])
    assert found.exceeded.values[:, :2] == pytest.approx(6 / 21)
    files = bands.write_maps(tmp_path / "bands", "depth", found, band)
    names = ["depth-p5.asc", "depth-p50.asc", "depth-p95.asc", "depth-above-14.5.asc"]
    assert [file.name for file in files] == names
    again = read_raster(files[1])
    assert again.same_grid(found.percentiles[1])
    assert np.array_equal(again.values, found.percentiles[1].values, equal_nan=True)


def test_what_never_comes_is_late(table, maps):
    band = MapBand(kind="map", map="arrival_time", percent=[5.0, 25.0, 95.0])
    low, middle, high = (r.values for r in bands.map_percentiles(band, table).percentiles)
    assert low[1, 0] == 2.0  # run 0 has none either
    assert middle[1, 0] == 6.0
    assert np.isnan(high[1, 0])  # half of the runs never come
    assert np.isnan(low[1, 2])


def test_what_never_comes_counts_as_late(table, maps):
    band = MapBand(kind="map", map="arrival_time", exceed=5.5)
    share = bands.map_percentiles(band, table).exceeded.values
    # Runs 6 to 10 are late; 0, and 11 to 20, never come.
    assert share[1, 0] == pytest.approx((5 + 11) / 21)
    assert share[1, 2] == 1.0
    assert np.isnan(share[0, 3])  # no ground


def test_maps_on_other_cells_are_refused(table, maps, tmp_path):
    odd = RunPlace(tmp_path / "0099-000000000000")
    odd.path.mkdir()
    more = replace(table, entries=[*table.entries, Entry(odd, (), Row(DONE, "", score=0.0))])
    with pytest.raises(UserError, match="other cells"):
        bands.map_percentiles(MapBand(kind="map", map="peak_depth"), more)


X = Column("ks [m]", np.array([0.001, 0.01, 0.1, 0.001, 0.01, 0.1]), log=True)
Y = Column("wall", np.array([0.0, 0, 0, 1, 1, 1]), ticks=("rough", "no_slip"))
Z = Column("level [m]", np.array([1.0, 2, 3, 4, np.nan, 6]))


def test_pictures_show_every_run(tmp_path):
    figure = parallel_coordinates([X, Y, Z], Z, "title")
    assert len(figure.axes[0].lines) == 6 + 3  # runs, and scales
    texts = {text.get_text() for text in figure.axes[0].texts}
    assert {"0.001", "0.1", "rough", "no_slip", "1", "6"} <= texts
    figure = responses([X, Y], [Z], "title")
    assert [len(axes.lines[0].get_xdata()) for axes in figure.axes] == [5, 5]
    figure = grid_images([X, Y], [Z], "title")
    image = figure.axes[0].images[0].get_array()
    assert np.array_equal(np.ma.filled(image, -1), [[1, 2, 3], [4, -1, 6]])
    figure.savefig(tmp_path / "grid.png")


def test_what_cannot_be_drawn_says_why():
    for draw in (
        lambda: parallel_coordinates([X], Z, ""),
        lambda: responses([X], [], ""),
        lambda: grid_images([X], [Z], ""),
    ):
        with pytest.raises(NothingToDrawError):
            draw()


def test_panels_of_a_column_have_the_same_values():
    """Where some runs have no result of one kind, too."""
    arrival = Column("arrival [s]", np.where(X.values > 0.05, np.nan, 2.0))
    figure = responses([X], [Z, arrival], "title")
    above, below = figure.axes
    assert above.get_xlim() == below.get_xlim()
    assert above.get_xlim()[1] > 0.1
