"""What is read of runs whose numbers are known, and files of observations that are hostile."""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.measure.maps.quantities import QUANTITIES
from doseki.record.reader import load
from doseki.studies.plan.file import read_plan
from doseki.studies.reading.bands import ProfileBand, curve_text, read_curve, shared
from doseki.studies.reading.observations import (
    ObservedArea,
    ObservedFront,
    ObservedValue,
    ObservedValues,
    total_score,
)
from doseki.studies.reading.observed_files import read_series
from doseki.studies.reading.results import FrontTime, OfFront, OfHistory, OfMap
from doseki.studies.reading.series import Reduced, Series

from .small_study import SCENARIO, STUDY, write_study

# The front of `flow_folder` is at 3 - t m, from 0 to 3 s.


@pytest.mark.parametrize("gravity", ["[-1.0, -9.0]", "[0.0, -9.0]"])
def test_on_level_ground_the_front_is_where_the_flow_goes(flow_folder, gravity):
    text = flow_folder / "scenario.toml"
    assert "[-1.0, -9.0]" in text.read_text()
    text.write_text(text.read_text().replace("[-1.0, -9.0]", gravity))
    run = load(flow_folder)
    assert OfFront(kind="front", take="at", at=1.6).read(run) == pytest.approx(1.4)
    assert FrontTime(kind="front_time", x=1.9).read(run) == pytest.approx(1.1)


def test_front_and_history_are_read(flow_folder):
    run = load(flow_folder)
    assert FrontTime(kind="front_time", x=1.9).read(run) == pytest.approx(1.1)
    assert np.isnan(FrontTime(kind="front_time", x=-5.0).read(run))
    assert OfFront(kind="front").read(run) == pytest.approx(0.0, abs=1e-9)
    assert OfFront(kind="front", take="at", at=1.6).read(run) == pytest.approx(1.4)
    energy = OfHistory(kind="history", column="bulk_energy", take="max", before=2.0)
    assert energy.read(run) == pytest.approx(2.0)
    with pytest.raises(UserError, match="has no column"):
        OfHistory(kind="history", column="nothing").read(run)


SERIES = Series(np.arange(5.0), np.array([3.0, np.nan, 5.0, 1.0, 2.0]), "m")


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({"take": "last"}, 2.0), ({"take": "first"}, 3.0), ({"take": "min"}, 1.0),
        ({"take": "max", "after": 2.5}, 2.0), ({"take": "mean", "before": 2.0}, 4.0),
        ({"take": "at", "at": 2.5}, 3.0), ({"take": "at", "at": 9.0}, np.nan),
        ({"take": "at", "at": 0.5}, np.nan), ({"take": "max", "after": 8.0}, np.nan),
    ],
)  # fmt: skip
def test_one_number_is_made_of_a_series(keys, expected):
    assert Reduced(**keys).reduced(SERIES) == pytest.approx(expected, nan_ok=True)


def front_file(folder, x, head="time [ms],x [cm],error"):
    rows = [f"{1000 * t},{100 * value},{2}" for t, value in x]
    path = folder / "front.csv"
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


def test_a_front_is_compared_in_its_own_units(flow_folder, tmp_path):
    each = ObservedFront(kind="front", file="front.csv")
    front_file(tmp_path, [(0.5, 2.5), (1.1, 1.9), (5.0, 9.0)])  # the last is beyond the run
    assert each.misfit(load(flow_folder), {}, tmp_path) == pytest.approx(0.0, abs=1e-9)
    front_file(tmp_path, [(0.5, 2.5 + 0.06), (1.1, 1.9 - 0.06)], "time [ms],x [cm],error [cm]")
    assert each.misfit(load(flow_folder), {}, tmp_path) == pytest.approx(3.0)
    # The control: a front that is another one.
    front_file(tmp_path, [(0.5, 2.2), (1.1, 1.6)], "time [ms],x [cm],error [cm]")
    assert each.misfit(load(flow_folder), {}, tmp_path) == pytest.approx(15.0)


def test_numbers_are_compared(tmp_path):
    one = ObservedValue(kind="value", result="level", value=2.0, error=0.5)
    assert one.misfit(None, {"level": 3.0}, tmp_path) == pytest.approx(2.0)
    (tmp_path / "o.csv").write_text("result,value,error\nlevel,2,0.5\narrival,1,0.1\n")
    both = ObservedValues(kind="values", file="o.csv", weight=3.0)
    misfit = both.misfit(None, {"level": 3.0, "arrival": 1.2}, tmp_path)
    assert misfit == pytest.approx(np.sqrt((4 + 4) / 2))
    score = total_score({"one": one, "both": both}, {"one": 2.0, "both": 4.0})
    assert score == pytest.approx(np.sqrt((4 + 3 * 16) / 4))
    assert np.isnan(total_score({"one": one}, {"one": np.nan}))


MAP = """ncols 10
nrows 4
xllcorner 100
yllcorner 200
cellsize 1
nodata_value -9999
"""


@pytest.fixture
def mapped(flow_folder):
    """A run that has kept maps: cells from x = 102 to 106 m and y = 201 to 203 m are 2 m deep."""
    (flow_folder / "maps").mkdir()
    depth = np.zeros((4, 10))
    depth[1:3, 2:6] = 2.0
    for name in (quantity.name for quantity in QUANTITIES):
        rows = "\n".join(" ".join(str(v) for v in row) for row in depth)
        (flow_folder / "maps" / f"{name}.asc").write_text(MAP + rows + "\n")
    return load(flow_folder)


def polygon(folder, corners, kind="Polygon"):
    ring = [list(corner) for corner in corners]
    shape = {"type": kind, "coordinates": [ring] if kind == "Polygon" else ring}
    table = {"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {}, "geometry": shape}]}  # fmt: skip
    (folder / "area.geojson").write_text(json.dumps(table))


def in_system(folder, code):
    table = json.loads((folder / "area.geojson").read_text())
    name = f"urn:ogc:def:crs:EPSG::{code}"
    table["crs"] = {"type": "name", "properties": {"name": name}}
    (folder / "area.geojson").write_text(json.dumps(table))


AREA = ObservedArea(kind="area", file="area.geojson")
BOX = [(102, 201), (106, 201), (106, 203), (102, 203), (102, 201)]


def test_areas_are_compared(mapped, tmp_path):
    polygon(tmp_path, BOX)
    assert AREA.misfit(mapped, {}, tmp_path) == 0.0
    polygon(tmp_path, [(x + 2, y) for x, y in BOX])  # half of each is common: a third of both
    assert AREA.misfit(mapped, {}, tmp_path) == pytest.approx(2 / 3)
    polygon(tmp_path, [(x, y + 2 * (y > 202) - 2 * (y < 202)) for x, y in BOX])
    assert AREA.misfit(mapped, {}, tmp_path) == pytest.approx(0.5)
    polygon(tmp_path, BOX[:-1])  # not closed: the last side is drawn
    assert AREA.misfit(mapped, {}, tmp_path) == 0.0
    polygon(tmp_path, BOX, "LineString")
    with pytest.raises(UserError, match="polygons"):
        AREA.misfit(mapped, {}, tmp_path)
    polygon(tmp_path, [(x + 1e6, y) for x, y in BOX])
    with pytest.raises(UserError, match="beside the map"):
        AREA.misfit(mapped, {}, tmp_path)


def test_an_area_is_in_the_system_of_the_map(mapped, tmp_path):
    rasterio = pytest.importorskip("rasterio", reason="rasterio: pip install 'doseki[terrain]'")
    system = rasterio.crs.CRS.from_epsg
    for map_ in (mapped.directory / "maps").glob("*.asc"):
        map_.with_suffix(".prj").write_text(system(6674).to_wkt())
    for code, refused in ((6674, False), (30166, True)):
        polygon(tmp_path, BOX)
        in_system(tmp_path, code)
        if refused:
            with pytest.raises(UserError, match="another coordinate reference system"):
                AREA.misfit(mapped, {}, tmp_path)
        else:
            assert AREA.misfit(mapped, {}, tmp_path) == 0.0


def test_an_area_that_cannot_be_compared_with_the_map_is_warned_about(tmp_path):
    scenario = SimpleNamespace(maps=True, bed=SimpleNamespace(raster=SimpleNamespace(crs=None)))
    polygon(tmp_path, BOX)
    assert AREA.check(scenario, {}, tmp_path, UserError) == []
    in_system(tmp_path, 6674)
    (said,) = AREA.check(scenario, {}, tmp_path, UserError)
    assert "area.geojson has the coordinate reference system of the terrain was not" in said


def test_maps_are_read(mapped):
    assert OfMap(kind="map", map="peak_depth").read(mapped) == 2.0
    assert OfMap(kind="map", map="peak_depth", take="mean").read(mapped) == 2.0
    place = OfMap(kind="map", map="peak_depth", take="at", position=[104.0, 202.0])
    assert place.read(mapped) == pytest.approx(2.0)
    # Beside the flow it is what the cell holds, not what lines between cells say.
    for x, depth in ((101.9, 0.0), (102.1, 2.0)):
        place = OfMap(kind="map", map="peak_depth", take="at", position=[x, 201.1])
        assert place.read(mapped) == depth


def test_a_cell_that_is_reached_at_once_counts(mapped, tmp_path):
    times = np.full((4, 10), -9999.0)
    times[1:3, 2:6] = [0.0, 0.0, 1.0, 3.0]
    rows = "\n".join(" ".join(str(v) for v in row) for row in times)
    (mapped.directory / "maps" / "arrival_time.asc").write_text(MAP + rows + "\n")
    polygon(tmp_path, BOX)
    area = ObservedArea(kind="area", file="area.geojson", map="arrival_time")
    assert area.misfit(mapped, {}, tmp_path) == 0.0
    later = area.model_copy(update={"above": 1.0})
    assert later.misfit(mapped, {}, tmp_path) == pytest.approx(0.5)
    assert OfMap(kind="map", map="arrival_time", take="mean").read(mapped) == pytest.approx(1.0)


ON_A_MAP = """
dim = 3
dp = 0.1
time_max = 0.02
time_out = 0.01
gravity = [0, 0, "= -pull"]
scheme = "resolved"
speed_max = 1

[parameters]
pull = { value = 9.81, unit = "m/s2" }

[body.block]
shape = "box"
material = "water"
min = [0, 0, 0]
max = [0.6, 0.3, 0.3]

[maps]
cell = 0.2
extent = [10, 20, 11.1, 21]
"""
AT = (
    STUDY.partition("[result")[0]
    + """
[result.depth]
kind = "map"
map = "peak_depth"
take = "at"
position = {place}
"""
)


@pytest.mark.parametrize("place", ["[10, 21]", "[11.15, 20.1]", "[10.5, 20.5]"])
def test_a_place_on_the_cells_of_the_map_is_read(place, tmp_path):
    assert read_plan(write_study(tmp_path, AT.format(place=place), ON_A_MAP)).results


@pytest.mark.parametrize("place", ["[9.99, 20.5]", "[11.25, 20.5]", "[10.5, 21.01]", "[10, 19]"])
def test_a_place_off_the_map_is_refused(place, tmp_path):
    path = write_study(tmp_path, AT.format(place=place), ON_A_MAP)
    with pytest.raises(
        UserError, match=r"result.depth.position: = .* lies off the map, .*11.2, 21"
    ):
        read_plan(path)


HOSTILE = {
    "nothing": ("", "empty"),
    "no rows": ("time,y,error\n", "o.csv: no rows; an observation has"),
    "nan": ("time,y,error\n0,nan,1\n", "row 1: y = nan"),
    "infinite": ("time,y,error\n0,1e999,1\n", "row 1"),
    "a word": ("time,y,error\n0,high,1\n", "'high' is not a number"),
    "another column": ("time,z,error\n0,1,1\n", "no column y"),
    "another unit": ("time,y [kg],error\n0,1,1\n", "unit"),
    "times that fall": ("time,y,error\n0,1,1\n0,2,1\n", "row 2: times must rise"),
    "an error of nothing": ("time,y,error\n0,1,0\n", "greater than 0"),
    "twice a column": ("time,y,y,error\n0,1,1,1\n", "twice"),
    "a short row": ("time,y,error\n0,1\n", "2 fields"),
    "other times": ("time,y,error\n7,1,1\n", "outside of the runs"),
    "no error": ("time,y\n0,1\n", "in neither"),
}
OBSERVATION = """
[observation.centre]
kind = "series"
file = "o.csv"
gauge = "centre"
column = "y"
"""


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_observation_is_refused(name, tmp_path):
    text, words = HOSTILE[name]
    (tmp_path / "o.csv").write_text(text)
    with pytest.raises(UserError) as caught:
        read_plan(write_study(tmp_path, STUDY + OBSERVATION))
    assert words in str(caught.value)
    assert "observation.centre" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_error_stands_once(tmp_path):
    (tmp_path / "o.csv").write_text("time [ms],y [mm],error [m]\n1,100,0.01\n2,99,0.01\n")
    assert not read_plan(write_study(tmp_path, STUDY + OBSERVATION)).remarks
    with pytest.raises(UserError, match="in both"):
        read_plan(write_study(tmp_path, STUDY + OBSERVATION + "error = 1\n"))
    found = read_series(tmp_path / "o.csv", "y", "m")
    assert found["time"] == pytest.approx([0.001, 0.002])
    assert found["value"] == pytest.approx([0.1, 0.099])


WALL = """
[body.wall]
shape = "box"
material = "aluminium"
fixed = true
min = [0, -0.4]
max = [0.6, 0]

[gauge.wall]
kind = "{kind}"
bodies = ["wall"]
interval = 0.005
"""
FACE = """
origin = [0, 0]
edges = [[0.6, 0]]
panels = [3]
direction = [0, 1]
"""


@pytest.mark.parametrize(
    ("kind", "column"),
    [("load", "force_y"), ("load", "static_force_y"), ("load", "peak_force_y"),
     ("force", "contact_force_y")],
)  # fmt: skip
def test_no_observation_is_before_the_first_mean(kind, column, tmp_path):
    text = STUDY + OBSERVATION.replace('"centre"', '"wall"').replace('"y"', f'"{column}"')
    path = write_study(tmp_path, text, SCENARIO + WALL.format(kind=kind))
    (tmp_path / "o.csv").write_text(f"time,{column},error\n0.005,1,1\n0.01,1,1\n")
    assert not read_plan(path).remarks
    (tmp_path / "o.csv").write_text(f"time,{column},error\n0.004,1,1\n0.01,1,1\n")
    with pytest.raises(UserError, match=r"time = 0.004 s is before 0.005 s, when gauge wall has"):
        read_plan(path)


def test_what_a_gauge_reads_at_once_may_be_observed_at_the_start(tmp_path):
    text = STUDY + OBSERVATION.replace('"centre"', '"wall"').replace('"y"', '"force_y"')
    path = write_study(tmp_path, text, SCENARIO + WALL.format(kind="force"))
    (tmp_path / "o.csv").write_text("time,force_y,error\n0,1,1\n")
    assert not read_plan(path).remarks


def test_a_time_within_rounding_of_a_sample_is_that_sample():
    series = Series(np.array([0.1, 0.3, 0.5]), np.array([np.nan, 1.0, 2.0]), "N")
    found = series.at(np.array([0.1 + 0.2 - 1e-16, 0.4, 0.2, 0.5 + 1e-16]))
    assert found == pytest.approx([1.0, 1.5, np.nan, 2.0], nan_ok=True)


SERIES_OF_PANELS = '[bands.b]\nkind = "series"\ngauge = "wall"\ncolumn = "flow_pressure"\n'


@pytest.mark.parametrize(
    ("read", "refused"),
    [(SERIES_OF_PANELS, True)]
    + [
        (SERIES_OF_PANELS.replace("bands", "result").replace("series", "gauge") + take, refused)
        for take, refused in (
            ("", True), ('take = "first"', True), ('take = "at"\nat = 0.01', True),
            ('take = "max"', False),
        )
    ],
)  # fmt: skip
def test_several_rows_for_a_time_are_no_series(read, refused, tmp_path):
    path = write_study(tmp_path, STUDY + read, SCENARIO + WALL.format(kind="panels") + FACE)
    if not refused:
        assert read_plan(path)
        return
    with pytest.raises(UserError, match=r"\.gauge: a gauge of kind panels has several rows"):
        read_plan(path)


def test_a_huge_or_odd_file_is_not_read(tmp_path, monkeypatch):
    monkeypatch.setattr("doseki.studies.reading.observed_files.MAX_BYTES", 10)
    (tmp_path / "o.csv").write_text("time,y,error\n0,1,1\n")
    with pytest.raises(UserError, match="at most"):
        read_plan(write_study(tmp_path, STUDY + OBSERVATION))
    (tmp_path / "o.csv").unlink()
    (tmp_path / "o.csv").mkdir()
    with pytest.raises(UserError, match="a folder"):
        read_plan(write_study(tmp_path, STUDY + OBSERVATION))


def test_a_profile_keeps_the_volume(flow_folder):
    run = load(flow_folder)
    band = ProfileBand(kind="profile", time=2.0, min=-1.0, max=4.0, cell=0.25)
    curve = band.curve(run)
    water = run.at(2.0)["material"] == "water"
    volume = (run.at(2.0)["mass"] / run.at(2.0)["density"])[water].sum()
    assert curve.value.sum() * 0.25 == pytest.approx(volume)
    assert curve.value[curve.x < 0.8] == pytest.approx(0.0)
    assert curve.value[(curve.x > 1.2) & (curve.x < 2.8)] == pytest.approx(0.2, rel=0.11)
    x, value = read_curve("a", curve_text(curve))
    assert x == pytest.approx(curve.x)
    assert value == pytest.approx(curve.value)
    with pytest.raises(UserError, match="damaged"):
        read_curve("a", "x,y\n1,2,3\n")


def test_amounts_are_shared_by_width():
    edges = np.array([0.0, 1.0, 2.0, 3.0])
    found = shared(np.array([1.0, 2.5]), np.array([1.0, 0.5]), np.array([4.0, 1.0]), edges)
    assert found == pytest.approx([2.0, 2.0, 1.0])
