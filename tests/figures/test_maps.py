"""Maps and profiles drawn, and the command that does it."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import LightSource
from matplotlib.image import imread

from doseki.cli.app import app
from doseki.cli.main import main
from doseki.errors import ResourceError, UserError
from doseki.figures.maps.drawing import DARKEST, draw_map, draw_profile
from doseki.figures.maps.output import MapOptions, map_makers, write_pictures
from doseki.figures.maps.structures import COLOUR, OVER, Structures
from doseki.figures.nothing import NothingToDrawError
from doseki.figures.space.ground import hillshade
from doseki.geodata.grid import Raster
from doseki.geodata.raster import read_raster, write_raster
from doseki.measure.maps.profile import along_path
from doseki.measure.maps.quantities import ARRIVAL_TIME, PEAK_DEPTH, QUANTITIES
from doseki.record.reader import load

WEST, SOUTH = 460_000.0, 5_200_000.0
TITLE = "a slide"


def hill():
    """A slope with a channel, at coordinates of a map."""
    grid = Raster(np.zeros((24, 40)), WEST, SOUTH, 2.0)
    x, y = grid.x[None, :] - WEST, grid.y[:, None] - SOUTH
    return grid.with_values(900 - 0.5 * x + 0.01 * (y - 24) ** 2)


def sliding(time):
    """A block of 8 x 8 x 2 m that slides 10 m/s eastwards, and stops at 5 s."""
    axes = [np.arange(a + 0.25, b, 0.5) for a, b in ((6, 14), (20, 28), (0, 2))]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    x = x + np.array([WEST + 10 * time, SOUTH, 900 - 5 * time])
    n, speed = len(x), 10.0 if time < 5 else 0.0
    zeros = np.zeros((n, 3, 3))
    return {
        "position": x, "velocity": np.tile([speed, 0, 0], (n, 1)), "mass": np.full(n, 125.0),
        "density": np.full(n, 1000.0), "pressure": np.zeros(n), "stress": zeros,
        "smoothing_length": np.full(n, 0.6), "deviatoric_stress": zeros,
        "sound_speed": np.full(n, 10.0), "material": np.zeros(n, np.int32),
        "body": np.zeros(n, np.int32), "motion": np.zeros(n, np.int32), "id": np.arange(n),
        "grain": np.full(n, -1),
    }  # fmt: skip


@pytest.fixture
def slide(tmp_path, record_run):
    """The folder of a run of the block, with a terrain."""
    times = tuple(np.arange(0, 5.01, 0.25))
    recorder, _ = record_run(tmp_path / "run", dim=3, times=times, state_at=sliding)
    recorder.close({"status": "done"})
    write_raster(tmp_path / "run/terrain.asc", hill())
    return tmp_path / "run"


DAM = np.array([WEST + 55, SOUTH + 24])  # middle of a dam, 16 m long, 4 m thick and 6 m high


def dam(angle):
    """Particles of a dam at an angle (degrees) from the east, as far above the slope as in it."""
    axes = [np.arange(-a + 0.5, a, 1.0) for a in (8, 2, 3)]
    along, across, up = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3).T
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    x, y = c * along - s * across, s * along + c * across
    return np.stack([DAM[0] + x, DAM[1] + y, 900 - 0.5 * (55 + x) + up], axis=1)


def with_dam(angle, height=0.0):
    """The sliding block above a dam that is moved upwards, m."""

    def state(time):
        block, bodies = sliding(time), dam(angle) + np.array([0, 0, height])
        n = len(bodies)
        wall = {key: np.zeros((n, *value.shape[1:]), value.dtype) for key, value in block.items()}
        wall |= {
            "position": bodies, "mass": np.full(n, 1000.0), "density": np.full(n, 1000.0),
            "smoothing_length": np.full(n, 1.2), "body": np.full(n, 2, np.int32),
            "motion": np.ones(n, np.int32), "id": len(block["id"]) + np.arange(n),
            "grain": np.full(n, -1),
        }  # fmt: skip
        return {key: np.concatenate([block[key], wall[key]]) for key in block}

    return state


@pytest.fixture
def dammed(tmp_path, record_run):
    """A function that makes a run of the block, with maps, and a dam at an angle and a height."""

    def make(angle, height=0.0):
        path = tmp_path / f"{angle}_{height}"
        recorder, _ = record_run(
            path, dim=3, times=(0.0, 2.5, 5.0), state_at=with_dam(angle, height)
        )
        recorder.close({"status": "done"})
        write_raster(path / "terrain.asc", hill())
        return path

    return make


def grey_of(figure, points):
    """Whether a figure has the colour of structures at points (n, 2) of its map, below numbers."""
    for number in figure.axes[0].texts:
        number.set_visible(False)
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[..., :3] / 255
    at = figure.axes[0].transData.transform(points).astype(int)
    seen = pixels[len(pixels) - 1 - at[:, 1], at[:, 0]]
    return np.abs(seen - float(COLOUR)).max(axis=1) < 0.01


@pytest.mark.parametrize("angle", [0, 37, 90, 215])
def test_a_map_shows_the_dam_that_stands_on_it(dammed, angle):
    path = dammed(angle)
    write_pictures(path, MapOptions())
    scenario = path / "scenario.toml"
    scenario.write_text(scenario.read_text() + "\n[maps]\n")
    figures = dict(map_makers(load(path)))
    inside = dam(angle)[:, :2]
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    away = DAM + 1.4 * 2 * np.array([[-s, c], [s, -c]])  # 0.8 m beside its faces
    for name in ("peak_depth", "arrival_time"):
        figure = figures[name]()
        assert grey_of(figure, inside).mean() > 0.98
        assert not grey_of(figure, away).any()
        (key,) = figure.axes[0].get_legend().get_texts()
        assert key.get_text() == "fixed bodies"
        box, scale = key.get_window_extent(), figure.axes[1].get_window_extent()
        assert box.y1 <= scale.y0
        assert box.y0 >= 0
        assert box.x1 <= figure.bbox.x1
        box = figure.axes[0].get_legend().get_window_extent()
        numbers = [each.get_window_extent() for each in figure.axes[0].get_xticklabels()]
        assert not any(box.overlaps(number.padded(4)) for number in numbers)


def test_a_dam_does_not_cut_the_numbers_of_contours(dammed):
    path = dammed(37)
    scenario = path / "scenario.toml"
    write_pictures(path, MapOptions())
    scenario.write_text(scenario.read_text() + "\n[maps]\n")
    axes = dict(map_makers(load(path)))["peak_depth"]().axes[0]
    assert len(axes.texts) > 2
    assert min(text.get_zorder() for text in axes.texts) > OVER


def test_no_number_of_a_contour_lies_on_a_body():
    """A body hides the bends of two lines, where numbers stand; they move to what is seen."""
    grid = Raster(np.zeros((18, 12)), WEST, SOUTH, 1.0)
    x, y = grid.x[None, :] - WEST, grid.y[:, None] - SOUTH
    bed = grid.with_values(180 - 0.45 * x + 0.03 * (y - 9) ** 2)
    place = np.stack(np.meshgrid(np.arange(5.05, 10, 0.1), np.arange(7.05, 11, 0.1)), axis=-1)
    place = place.reshape(-1, 2) + np.array([WEST, SOUTH])

    def on_body(structures):
        depth = bed.with_values(np.ones(bed.shape))
        figure = draw_map(PEAK_DEPTH, depth, bed, "", structures)
        figure.canvas.draw()
        axes = figure.axes[0]
        inside = axes.transData.transform(place)
        boxes = {text.get_text(): text.get_window_extent() for text in axes.texts}
        return {k: any(box.contains(*at) for at in inside) for k, box in boxes.items()}

    alone, beside = on_body(None), on_body(Structures(place, 0.1))
    assert alone["176"]
    assert alone["177"]
    assert beside.keys() == alone.keys()
    assert not any(beside.values())


def test_bodies_are_darker_than_any_slope():
    """The relief is drawn from DARKEST, which stands for black, to white."""
    assert float(COLOUR) < 0.7 * DARKEST / (DARKEST - 1)


def test_runs_with_other_dams_share_none(dammed):
    runs = [load(dammed(angle)) for angle in (0, 90)]
    assert len(Structures.of_all(runs).place) == len(dam(0)) // 2
    table = "\n[body.dam]\nfixed = true\nmin = [0, 0, {}]\n"
    for k, run in enumerate(runs):
        path = run.folder.scenario
        path.write_text(path.read_text() + table.format(k))
    assert Structures.of_all([load(run.directory) for run in runs]) is None


@pytest.mark.parametrize("height", [-10.0, 10.0])
def test_a_body_in_the_ground_is_not_on_the_map(dammed, height):
    path = dammed(0, height)
    assert (Structures.of(load(path)) is None) == (height < 0)


def test_maps_that_cannot_be_drawn_end_the_command_with_an_error(slide, monkeypatch, capsys):
    def full(*_):
        raise ResourceError("no space left")

    monkeypatch.setattr("doseki.figures.saving.write_whole", full)
    with pytest.raises(SystemExit) as ended:
        main(["maps", str(slide)])
    assert ended.value.code == 4
    assert "of the maps could not be drawn" in capsys.readouterr().err


def test_a_run_without_maps_is_mapped_from_its_snapshots(slide):
    said = write_pictures(slide, MapOptions())
    assert said[0].startswith("from 21 snapshots: what peaked between them is missed")
    depth = read_raster(slide / "maps/peak_depth.asc").values
    assert depth.max() == pytest.approx(2.0)
    assert read_raster(slide / "maps/peak_speed.asc").values.max() == pytest.approx(10.0)
    lying = read_raster(slide / "maps/deposit.asc").values
    assert lying.sum() * 4 == pytest.approx(128.0)  # m3
    arrival = read_raster(slide / "maps/arrival_time.asc").values
    assert np.nanmax(arrival) == 5.0
    found = json.loads((slide / "maps/runout.json").read_text())
    assert found["angle"] == pytest.approx(np.degrees(np.arctan(0.5)), abs=1.0)
    assert found["area"] == pytest.approx(58 * 8, rel=0.05)
    assert any(line.startswith("run-out") for line in said)
    for quantity in QUANTITIES:
        picture = imread(slide / f"maps/{quantity.name}.png")
        assert picture.std() > 0.05


def test_other_cells(slide):
    said = write_pictures(slide, MapOptions(cell=4.0))
    assert read_raster(slide / "maps/peak_depth.asc").shape == (12, 20)
    assert not any("warning" in line for line in said)
    part = (WEST, SOUTH + 10, WEST + 40, SOUTH + 40)
    write_pictures(slide, MapOptions(extent=part))
    assert read_raster(slide / "maps/peak_depth.asc").extent == part


@pytest.mark.parametrize("as_file", [False, True])
def test_a_profile_along_a_path(slide, tmp_path, as_file):
    points = [[WEST + 1, SOUTH + 24.5], [WEST + 79, SOUTH + 24.5]]
    path = " ".join(f"{x},{y}" for x, y in points)
    if as_file:
        geometry = {"type": "LineString", "coordinates": points}
        path = str(tmp_path / "path.geojson")
        (tmp_path / "path.geojson").write_text(json.dumps(geometry))
    said = write_pictures(slide, MapOptions(path=path))
    (line,) = (line for line in said if line.startswith("along the path"))
    assert line == "along the path: reached from 5 to 61 m, at 26.6 degrees"
    header, *rows = (slide / "maps/profile.csv").read_text().splitlines()
    assert header.startswith("distance [m],x [m],y [m],bed [m],peak_depth [m]")
    table = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    covered = table[:, 4] > 0
    assert np.ptp(table[covered, 0]) == pytest.approx(58, abs=4)
    assert (slide / "maps/profile.png").is_file()


def test_a_path_that_leaves_the_map_is_told(slide):
    path = f"{WEST + 1},{SOUTH + 24.5} {WEST + 100},{SOUTH + 24.5}"
    said = write_pictures(slide, MapOptions(path=path))
    (line,) = (line for line in said if "beside the map, where" in line)
    assert line.startswith("along the path: 20 of its 99 m")


@pytest.mark.parametrize(
    "path", ["", "1,2", "1,2 3", "a,b c,d", "nan,1 2,3", "1,2,3 4,5,6", 99 * "1;2 "]
)
def test_a_path_that_is_none_is_refused(slide, path):
    with pytest.raises(UserError):
        write_pictures(slide, MapOptions(path=path))


def test_a_path_has_as_many_points_as_are_given(slide):
    """A text that is longer than names of files may be."""
    points = [[WEST + 1 + x, SOUTH + 24.5] for x in np.linspace(0, 78, 40)]
    path = " ".join(f"{x:.3f},{y:.3f}" for x, y in points)
    said = write_pictures(slide, MapOptions(path=path))
    (line,) = (line for line in said if line.startswith("along the path"))
    assert line.startswith("along the path: reached from 5 to 6")


def test_a_file_of_several_lines_is_refused(slide, tmp_path):
    lines = [[[0, 0], [1, 1]], [[2, 2], [3, 3]]]
    text = json.dumps({"type": "MultiLineString", "coordinates": lines})
    (tmp_path / "two.geojson").write_text(text)
    with pytest.raises(UserError, match="2 lines"):
        write_pictures(slide, MapOptions(path=str(tmp_path / "two.geojson")))


def warnings_of(said, words):
    return [line for line in said if line.startswith("warning: ") and words in line]


def test_a_path_on_another_map_is_refused(slide, tmp_path):
    pytest.importorskip("rasterio", reason="rasterio: pip install 'doseki[terrain]'")
    write_raster(slide / "terrain.tif", replace(hill(), crs="EPSG:32633", driver="GTiff"))
    points = [[WEST + 1, SOUTH + 24.5], [WEST + 79, SOUTH + 24.5]]
    geometry = {"type": "LineString", "coordinates": points}
    crs = {"type": "name", "properties": {"name": "EPSG:31287"}}
    path = tmp_path / "path.geojson"
    path.write_text(json.dumps({"type": "Feature", "geometry": geometry, "crs": crs}))
    with pytest.raises(UserError, match="another coordinate reference system"):
        write_pictures(slide, MapOptions(path=str(path)))
    (slide / "terrain.tif").rename(tmp_path / "known.tif")
    assert warnings_of(write_pictures(slide, MapOptions(path=str(path))), "not compared")
    (tmp_path / "known.tif").rename(slide / "terrain.tif")
    path.write_text(path.read_text().replace("31287", "32633"))
    said = write_pictures(slide, MapOptions(path=str(path)))
    assert any(line.startswith("along the path") for line in said)
    assert not warnings_of(said, "not compared")
    assert read_raster(slide / "maps/peak_depth.tif").crs is not None


def test_a_run_that_kept_its_maps_keeps_them(slide):
    """Peaks between snapshots are in the files: they are drawn, not made anew."""
    write_pictures(slide, MapOptions())
    kept = read_raster(slide / "maps/peak_depth.asc")
    write_raster(slide / "maps/peak_depth.asc", kept.with_values(2 * kept.values))
    scenario = slide / "scenario.toml"
    scenario.write_text(scenario.read_text().replace("\n", "\n", 1) + "\n[maps]\n")
    said = write_pictures(slide, MapOptions())
    assert not any("snapshots" in line for line in said)
    assert read_raster(slide / "maps/peak_depth.asc").values.max() == pytest.approx(4.0)
    with pytest.raises(UserError, match="kept its maps"):
        write_pictures(slide, MapOptions(cell=4.0))


def test_a_run_without_terrain_needs_a_grid(slide):
    (slide / "terrain.asc").unlink()
    with pytest.raises(UserError, match="has no terrain"):
        write_pictures(slide, MapOptions())
    extent = (WEST, SOUTH, WEST + 80, SOUTH + 48)
    said = write_pictures(slide, MapOptions(cell=2.0, extent=extent))
    assert not any(line.startswith("run-out") for line in said)
    assert (slide / "maps/peak_depth.png").is_file()


def test_a_2d_run_has_no_map(run_folder):
    write_raster(run_folder / "terrain.asc", hill())
    with pytest.raises(UserError, match="2-D run has no map"):
        write_pictures(run_folder, MapOptions())


def test_the_command(slide, capsys):
    app(["maps", str(slide), "--cell", "4"], standalone_mode=False)
    said = capsys.readouterr().out
    assert "peak_depth.png" in said
    assert "run-out" in said


def test_what_a_map_shows():
    """Coordinates in full, the relief and contours of the bed, and only what was reached."""
    bed = hill()
    values = np.zeros(bed.shape)
    values[10:14, 5:30] = 1.5
    figure = draw_map(PEAK_DEPTH, bed.with_values(values), bed, TITLE)
    axes = figure.axes[0]
    assert axes.get_title() == TITLE
    relief, shown = axes.images
    assert np.isnan(shown.get_array().filled(np.nan)).sum() > 0
    assert np.nanmax(shown.get_array().filled(np.nan)) == 1.5
    assert np.ptp(relief.get_array()) > 0
    figure.canvas.draw()
    texts = [label.get_text() for label in axes.get_xticklabels()]
    assert all(text.startswith("4600") for text in texts if text)
    assert "largest depth" in figure.axes[1].get_ylabel()
    west, east = axes.get_xlim()
    assert west >= WEST
    assert east <= bed.east
    assert west < WEST + 10 < WEST + 60 < east


@pytest.mark.parametrize("shape", [(34, 67), (60, 24), (40, 40), (12, 90), (18, 12), (90, 12)])
@pytest.mark.parametrize(
    ("title", "south", "depth"), [("", -12345678.5, 1e-4), (8 * "a long title ", SOUTH, 1.0)]
)
def test_nothing_of_a_map_is_cut_off(shape, title, south, depth):
    bed = Raster(np.add.outer(np.arange(shape[0]), np.arange(shape[1])) * 0.5, WEST, south, 2.0)
    place = np.array([[WEST + shape[1], south + shape[0]]])
    figure = draw_map(
        PEAK_DEPTH, bed.with_values(np.full(shape, depth)), bed, title, Structures(place, 2.0)
    )
    figure.canvas.draw()
    drawn, (width, height) = figure.get_tightbbox(), figure.get_size_inches()
    assert min(drawn.x0, drawn.y0, width - drawn.x1, height - drawn.y1) >= 0
    words = figure.axes[0].get_legend().get_window_extent()
    assert figure.bbox.x0 <= words.x0 < words.x1 <= figure.bbox.x1
    axes, key = figure.axes
    for text in (axes.title, axes.xaxis.label, axes.yaxis.label, key.yaxis.label):
        if not text.get_text():
            continue
        box = text.get_window_extent()
        assert box.x0 >= 0
        assert box.y0 >= 0
        assert box.x1 <= figure.bbox.x1
        assert box.y1 <= figure.bbox.y1


def test_the_edge_of_what_is_known_is_no_cliff():
    """Beside cells without data, and far from them, the relief is the one that it has without."""
    whole = hill().values
    holes = whole.copy()
    holes[5:12, 10:20] = holes[:, 35:] = holes[20, 3] = np.nan
    known = np.isfinite(holes)
    full, cut = hillshade(whole, 2.0), hillshade(holes, 2.0)
    assert np.abs(cut - full)[known].max() < 0.1
    sun = LightSource(azdeg=315, altdeg=45)
    np.testing.assert_allclose(full, sun.hillshade(whole, dx=2.0, dy=2.0), atol=1e-12)
    plane = np.where(known, hill().x[None, :] - 0.3 * hill().y[:, None], np.nan)
    assert np.ptp(hillshade(plane, 2.0)[known]) < 1e-9


def test_nothing_is_no_picture():
    bed = hill()
    with pytest.raises(NothingToDrawError, match="peak depth"):
        draw_map(PEAK_DEPTH, bed.with_values(np.zeros(bed.shape)), bed, TITLE)
    with pytest.raises(NothingToDrawError, match="arrival time"):
        draw_map(ARRIVAL_TIME, bed.with_values(np.full(bed.shape, np.nan)), bed, TITLE)


def test_what_a_profile_shows():
    bed = hill()
    maps = {quantity.name: bed.with_values(np.ones(bed.shape)) for quantity in QUANTITIES}
    path = np.array([[WEST, SOUTH + 10], [WEST + 80, SOUTH + 10]])
    figure = draw_profile(along_path(maps, bed, path), TITLE)
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "height (m)", "depth (m)", "largest speed (m/s)",
    ]  # fmt: skip
    heights = figure.axes[0].lines[0].get_ydata()
    assert heights[0] > heights[-1]


@pytest.mark.parametrize("text", ["[", '{"runout": [1]}'])
def test_a_damaged_summary_is_told_before_maps_are_drawn(dammed, text):
    path = dammed(0)
    (path / "summary.json").write_text(text)
    with pytest.raises(UserError, match=r"summary\.json: is "):
        write_pictures(path, MapOptions())
    assert not (path / "maps").exists()
