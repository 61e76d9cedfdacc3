"""What lies on a terrain: volume, place, and what is refused."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest

from doseki.errors import ResourceError, UserError
from doseki.geodata.raster import Raster, write_raster
from doseki.scenario.load import load_scenario
from doseki.scenario.releases import NoArea, NotCompared
from doseki.scene.build import build_scene
from doseki.scene.ground import Ground
from doseki.scene.kinds.registry import body_of
from doseki.scene.kinds.release import ReleaseBody

from .scenes import grid, profile, text

RELEASE = """
[body.slide]
shape = "release"
material = "water"
{keys}
"""
SQUARE = "polygon = [[1, 1], [4, 1], [4, 3], [1, 3]]\nthickness = 0.5"
SMALL = "[[2, 1.5], [2.5, 1.5], [2.5, 2], [2, 2]]"


def hole(*rings):
    """Keys of the square with holes."""
    return f"polygons = [[[[1, 1], [4, 1], [4, 3], [1, 3]], {', '.join(rings)}]]\nthickness = 0.5"


def hill(x, y):
    return 0.6 * x + 0.4 * np.sin(0.8 * y) + 0.1 * np.cos(x)


@pytest.fixture
def case(tmp_path):
    """Writes a scenario on a hill and gives its path."""

    def write(keys=SQUARE, dp=0.1, shift=(0.0, 0.0, 0.0), dim=3):
        if dim == 3:
            grid(tmp_path / "terrain.asc", hill, shift=shift)
        else:
            profile(tmp_path / "terrain.csv", lambda x: 0.5 * x**1.5)
        path = tmp_path / "case.toml"
        path.write_text(text(dim, dp=dp, more=RELEASE.format(keys=keys)))
        return path

    return write


def volume_of(scenario):
    """Of the particles of the release, m3 (2-D: m2)."""
    scene = build_scene(scenario)
    own = scene.particles.body == scene.names.index("slide")
    return float((scene.particles.mass[own] / scene.particles.density[own]).sum())


def doubts_of(path):
    """What is said of a scenario that is built."""
    return build_scene(load_scenario(path)).warnings


def area_of(inside, low, high, n=800):
    """Surface of the hill over places that are inside, m2, by the trapezium rule."""
    axes = [a + (np.arange(n) + 0.5) / n * (b - a) for a, b in zip(low, high, strict=True)]
    x, y = np.meshgrid(*axes)
    slope = np.hypot(0.6 - 0.1 * np.sin(x), 0.32 * np.cos(0.8 * y))
    cell = np.prod(np.subtract(high, low)) / n**2
    return float((np.sqrt(1 + slope**2) * inside(x, y)).sum() * cell)


@pytest.mark.parametrize("dp", [0.2, 0.1, 0.07])
def test_the_volume_is_area_of_the_ground_times_thickness(case, dp):
    exact = 0.5 * area_of(lambda x, y: x == x, (1, 1), (4, 3))
    assert volume_of(load_scenario(case(dp=dp))) == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize("low", [1.02, 1.1, 1.16])
def test_the_volume_asked_for_does_not_depend_on_dp(case, low):
    """A strip two particles wide, wherever it lies between them."""
    high = low + 0.4
    keys = f"polygon = [[1, {low}], [4, {low}], [4, {high}], [1, {high}]]\nthickness = 0.5"
    exact = 0.5 * area_of(lambda x, y: x == x, (1, low), (4, high))
    body = body_of(load_scenario(case(keys, dp=0.2)), "slide")
    assert body.asked == pytest.approx(exact, rel=1e-4)
    assert body.volume == pytest.approx(exact, rel=0.015)


def test_holes_and_several_polygons_count(case):
    polygons = (
        "polygons = [[[[1, 1], [3, 1], [3, 3], [1, 3]], [[1.5, 1.5], [2.5, 1.5], [2.5, 2.5], "
        "[1.5, 2.5]]], [[[4, 1], [5, 1], [5, 3]]]]\nthickness = [0.3, 0.4]"
    )

    def ring(x, y):
        return (np.abs(x - 2) > 0.5) | (np.abs(y - 2) > 0.5)

    exact = 0.3 * area_of(ring, (1, 1), (3, 3))
    exact += 0.4 * area_of(lambda x, y: y - 1 < 2 * (x - 4), (4, 1), (5, 3))
    assert volume_of(load_scenario(case(polygons))) == pytest.approx(exact, rel=0.015)


def test_files_of_polygons_and_rasters_say_the_same(case, tmp_path):
    exact = volume_of(load_scenario(case()))
    ring = [[1, 1], [4, 1], [4, 3], [1, 3], [1, 1]]
    feature = {
        "type": "Feature",
        "properties": {"thickness": 0.5},
        "geometry": {"type": "Polygon", "coordinates": [ring]},
    }
    (tmp_path / "area.geojson").write_text(
        json.dumps({"type": "FeatureCollection", "features": [feature]})
    )
    from_file = load_scenario(case('file = "area.geojson"'))
    assert volume_of(from_file) == exact
    assert from_file.body["slide"].file is None  # a run keeps the polygons, not the file
    depth = np.zeros((40, 60))
    depth[10:30, 10:40] = 0.5
    write_raster(tmp_path / "depth.asc", Raster(depth, 0.0, 0.0, 0.1))
    from_raster = volume_of(load_scenario(case('file = "depth.asc"')))
    assert from_raster == pytest.approx(exact, rel=0.03)
    for name in ("depth.grd", "depth.txt", "depth"):  # a raster is known by what it holds
        (tmp_path / name).write_bytes((tmp_path / "depth.asc").read_bytes())
        assert volume_of(load_scenario(case(f'file = "{name}"'))) == from_raster


@pytest.mark.parametrize("name", ["none.geojson", "none.gpkg", "none.asc", "none.tif", "none.grd"])
def test_a_file_that_is_missing_is_named_with_its_key(case, name):
    keys = f'file = "{name}"'
    with pytest.raises(
        UserError, match=rf"case.toml, line \d+: body.slide.file: .*{name}: no such"
    ):
        load_scenario(case(keys))
    with pytest.raises(UserError, match=rf"body.slide.digest: .*{name}: no such"):
        load_scenario(case(f'{keys}\ndigest = "{"0" * 32}"'))


def test_it_lies_on_the_ground_in_layers(case):
    scenario = load_scenario(case())
    scene = build_scene(scenario)
    position = scene.particles.position
    x, y = position[:, 0], position[:, 1]
    steep = np.sqrt(1 + (0.6 - 0.1 * np.sin(x)) ** 2 + (0.32 * np.cos(0.8 * y)) ** 2)
    height = (position[:, 2] - hill(x, y)) / steep
    layers = np.rint(height / 0.1 - 0.5)
    assert set(layers.tolist()) == {0.0, 1.0, 2.0, 3.0, 4.0}
    assert height / 0.1 - 0.5 == pytest.approx(layers, abs=0.15)


def test_it_does_not_depend_on_where_the_map_lies(case):
    """The columns are laid in the coordinates of the map: a shift by whole tiles changes none."""
    shift = (4096 * 0.8, 1024 * 0.8, 512.0)
    corners = [[x + shift[0], y + shift[1]] for x, y in ((1, 1), (4, 1), (4, 3), (1, 3))]
    moved = f"polygon = {corners}\nthickness = 0.5"
    near = build_scene(load_scenario(case())).particles
    far = build_scene(load_scenario(case(moved, shift=shift))).particles
    assert len(near) == len(far)
    assert far.position - shift == pytest.approx(near.position, abs=1e-6)


def test_in_two_dimensions_it_lies_between_two_places(case):
    scenario = load_scenario(case("between = [1, 3]\nthickness = 0.4", dim=2))
    x = np.linspace(1, 3, 4001)
    length = float(np.sum(np.hypot(np.diff(x), np.diff(0.5 * x**1.5))))
    assert volume_of(scenario) == pytest.approx(0.4 * length, rel=0.01)
    body = body_of(scenario, "slide")
    assert body.volume == pytest.approx(body.asked, rel=0.01)


def test_water_in_a_box_fills_what_is_above_the_ground(tmp_path):
    profile(tmp_path / "terrain.csv", lambda x: 0.2 * (x - 3) ** 2)
    lake = """
[body.lake]
shape = "box"
material = "water"
min = [0, -0.5]
max = [6, 0.8]
"""
    path = tmp_path / "case.toml"
    path.write_text(text(2, dp=0.05, more=lake))
    scene = build_scene(load_scenario(path))
    x, z = scene.particles.position.T
    assert (z > 0.2 * (x - 3) ** 2).all()
    assert scene.particles.mass.sum() == pytest.approx(1000 * 4 / 3 * 0.8 * 2, rel=0.03)


@pytest.mark.parametrize("dim", [2, 3])
def test_one_that_is_far_away_is_refused_before_it_is_filled(case, monkeypatch, dim):
    """As that of another map; filled, it would be as many layers as the machine has memory for."""

    def layer(*_):
        raise AssertionError("layers of a release that is not on the map")

    monkeypatch.setattr(Ground, "layer", layer)
    monkeypatch.setattr(Ground, "tile", layer)
    keys = "polygon = [[3e6, 1], [3.1e6, 1], [3e6, 3e5]]" if dim == 3 else "between = [3e6, 4e6]"
    with pytest.raises(UserError, match=r"reaches beyond the terrain, .* as at \[3000000.0"):
        build_scene(load_scenario(case(keys + "\nthickness = 0.5", dim=dim)))


def test_a_thickness_without_end_is_refused_before_it_is_filled(case, tmp_path, monkeypatch):
    """As layers it would take for ever, and memory that no machine has."""
    monkeypatch.setattr("doseki.record.particles.MAX_PARTICLES", 1e6)
    monkeypatch.setattr(ReleaseBody, "_stacked", None)
    for dim, keys in ((2, "between = [1, 3]"), (3, SQUARE.partition("\n")[0])):
        with pytest.raises(ResourceError, match=r"particles \(.* of them in body.slide\)"):
            build_scene(load_scenario(case(keys + "\nthickness = 9999", dp=0.03, dim=dim)))
    depth = np.zeros((40, 60))
    depth[12, 30] = 1e20
    write_raster(tmp_path / "depth.asc", Raster(depth, 0.0, 0.0, 0.1))
    with pytest.raises(UserError, match=r"row 13, column 31 holds 1e\+20, .* up to 10000 m"):
        build_scene(load_scenario(case('file = "depth.asc"')))


@pytest.mark.parametrize("name", ["area.geojson", "depth.asc"])
def test_without_rasterio_systems_without_numbers_are_warned_about(
    case, tmp_path, monkeypatch, name
):
    monkeypatch.setitem(sys.modules, "rasterio", None)
    path = case(f'file = "{name}"' + ("" if name == "depth.asc" else "\nthickness = 0.5"))
    ring = [[1, 1], [4, 1], [4, 3], [1, 3], [1, 1]]
    area = {"type": "Polygon", "coordinates": [ring]}
    crs = {"type": "name", "properties": {"name": "EPSG:32633"}}
    (tmp_path / "area.geojson").write_text(json.dumps(area | {"crs": crs}))
    write_raster(tmp_path / "depth.asc", Raster(np.full((20, 30), 0.5), 1.0, 1.0, 0.1))
    (tmp_path / "depth.prj").write_text('PROJCS["zone 33",UNIT["Meter",1.0]]')
    (tmp_path / "terrain.prj").write_text('PROJCS["zone",UNIT["metre",1]]')
    (said,) = (str(each) for each in doubts_of(path) if isinstance(each, NotCompared))
    assert said.startswith("body.slide.file: ")
    assert said.endswith("pip install 'doseki[terrain]'")
    (tmp_path / "terrain.prj").write_text('PROJCS["zone",UNIT["metre",1],AUTHORITY["EPSG","2056"]]')
    (tmp_path / "depth.prj").write_text('PROJCS["n",UNIT["m",1],AUTHORITY["EPSG","32633"]]')
    with pytest.raises(UserError, match=r"EPSG:32633, another .* EPSG:2056; convert it"):
        doubts_of(path)


@pytest.mark.parametrize("name", ["area.geojson", "depth.asc"])
def test_a_system_is_not_compared_with_that_of_a_map_that_has_none(case, tmp_path, name):
    from rasterio.crs import CRS

    path = case(f'file = "{name}"' + ("" if name == "depth.asc" else "\nthickness = 0.5"))
    ring = [[1, 1], [4, 1], [4, 3], [1, 3], [1, 1]]
    crs = {"type": "name", "properties": {"name": "EPSG:32633"}}
    table = {"type": "Polygon", "coordinates": [ring], "crs": crs}
    (tmp_path / "area.geojson").write_text(json.dumps(table))
    wkt = CRS.from_epsg(32633).to_wkt()
    write_raster(tmp_path / "depth.asc", Raster(np.full((20, 30), 0.5), 1.0, 1.0, 0.1, wkt))
    (said,) = (str(each) for each in doubts_of(path) if isinstance(each, NotCompared))
    assert said.startswith(f"body.slide.file: whether {tmp_path / name} has the coordinate")
    assert "that of the terrain is not known" in said
    (tmp_path / "terrain.prj").write_text(wkt)
    assert not [each for each in doubts_of(path) if isinstance(each, NotCompared)]


def test_a_raster_of_another_coordinate_system_is_refused(case, tmp_path):
    from rasterio.crs import CRS

    path = case('file = "depth.asc"')
    (tmp_path / "terrain.prj").write_text(CRS.from_epsg(32633).to_wkt())
    depth = Raster(np.full((20, 30), 0.5), 1.0, 1.0, 0.1, CRS.from_epsg(31287).to_wkt())
    write_raster(tmp_path / "depth.asc", depth)
    with pytest.raises(UserError, match=r"slide.file: .*depth.asc: is in .*another coord"):
        build_scene(load_scenario(path))
    (tmp_path / "depth.prj").unlink()
    build_scene(load_scenario(path))


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ("polygon = [[1, 1], [9, 1], [9, 3]]\nthickness = 0.5", "reaches beyond the terrain"),
        ("polygon = [[1, 1], [1.01, 1], [1, 1.01]]\nthickness = 0.5", "smaller than one particle"),
        ("polygon = [[1, 1], [4, 1], [4, 3]]", "thickness is missing"),
        ("polygon = [[1, 1], [4, 1]]\nthickness = 1", "polygon"),
        ("thickness = 1", "give file or polygon"),
        ("polygon = [[1, 1], [4, 1], [4, 3]]\nfile = 'a.shp'\nthickness = 1", "exclude each other"),
        ("file = 'nothing.geojson'", "nothing.geojson"),
        ("between = [1, 2]\nthickness = 1", "2-D"),
        (SQUARE + "\nfixed = true", "cannot be fixed"),
        (SQUARE + "\narray = {count = [2, 1, 1], step = [1, 0, 0]}", "no copies"),
        (SQUARE.replace("0.5", "[0.5, 0.4]"), "2 numbers for 1 polygon"),
        (SQUARE.replace("0.5", "0.05"), "less than 0.6 particle"),
        (
            "polygon = [[1, 1], [4, 3], [4, 1], [1, 3]]\nthickness = 0.5",
            r"area 1 crosses itself at \[2.5, 2.0\] m",
        ),
        (
            hole("[[3, 1.5], [5, 1.5], [5, 2.5]]"),
            "75 % of hole 1 of area 1 lie outside its outline",
        ),
        (hole("[[5, 1], [5.5, 1], [5.5, 3]]"), "100 % of hole 1 of area 1 lie outside"),
        (hole(SMALL, SMALL), "holes 1 and 2 of area 1 share 0.25 m2, .* left out twice"),
        (hole(SMALL, "[[2.2, 1.6], [3, 1.6], [3, 1.9]]"), "holes 1 and 2 of area 1 share"),
        (hole("[[2, 1.5], [3, 2.5], [3, 1.5], [2, 2.5]]"), "hole 1 of area 1 crosses itself"),
        (SQUARE.replace("0.5", "true"), "body.slide.thickness .* number"),
        (SQUARE.replace("0.5", "1e5"), "body.slide.thickness .* 10000"),
        (
            "polygons = [[[[1, 1], [4, 1], [4, 3], [1, 3]]], [[[3.8, 1], [5, 1], [5, 3]]]]\n"
            "thickness = 0.5",
            r"areas 1 and 2 share 0.03\d+ m2",
        ),
        (SQUARE + "\nfile_name = 'x'", "file_name is not a known key"),
        (
            "polygon = [[1, 1], [2, 2], [3, 3]]\nthickness = 0.5",
            r"slide.polygon: has no area at \[2, 2\] m, where its corners lie on a line",
        ),
        ("polygon = [[1, 1], [2, 1], [3, 1]]\nthickness = 0.5", "slide.polygon: has no area"),
        (hole("[[1, 1], [4, 1], [4, 3], [1, 3]]"), "slide.polygons: has no area .* holes take all"),
    ],
)
def test_what_is_no_release_is_refused(case, keys, said):
    with pytest.raises(UserError, match=said):
        build_scene(load_scenario(case(keys)))


@pytest.mark.parametrize(
    "line",
    [
        [[4, 1], [4.5, 1.5], [5, 2]],
        [[4, 1], [4.4, 1], [5, 1]],
        [[4, 1], [5, 2], [4.4, 1.4 + 1e-11], [4.6, 1.6 - 1e-11]],  # rounding crosses itself
    ],
)
def test_areas_and_holes_without_area_are_left_out_with_a_warning(case, tmp_path, line):
    square, inner = [[1, 1], [4, 1], [4, 3], [1, 3]], [[2, 1.5], [2.5, 2.0], [3, 2.5]]
    areas = [[line], [square, inner]]
    (tmp_path / "area.geojson").write_text(
        json.dumps({"type": "MultiPolygon", "coordinates": areas})
    )
    exact = volume_of(load_scenario(case()))
    for key, name in (("file", f"{tmp_path}/area.geojson, feature 1"), ("polygons", "area 1")):
        given = '"area.geojson"' if key == "file" else areas
        path = case(f"{key} = {given}\nthickness = 0.5")
        scenario = load_scenario(path)
        assert scenario.body["slide"].polygons == [[square]]
        assert volume_of(scenario) == exact
        first, second = (str(each) for each in doubts_of(path) if isinstance(each, NoArea))
        middle = f"[4.5, {1 if line[2][1] == 1 else 1.5}] m has no area: it is left out"
        assert first.startswith(f"body.slide.{key}: ")
        assert first.endswith(f"{name} at {middle}")
        assert "hole 1 of " in second
        assert "at [2.5, 2] m has no area" in second
    path = case(f"polygons = {areas}\nthickness = [9.0, 0.5]")
    assert load_scenario(path).body["slide"].thickness == [0.5]


def test_a_hole_may_touch_its_outline(case):
    """And another hole, as where each is drawn along the other."""
    keys = hole("[[1, 1], [2, 1], [2, 2], [1, 2]]", "[[2, 1.5], [3, 1.5], [3, 2], [2, 2]]")

    def left(x, y):
        return ~((x < 2) & (y < 2)) & ~((x > 2) & (x < 3) & (y > 1.5) & (y < 2))

    exact = 0.5 * area_of(left, (1, 1), (4, 3))
    assert volume_of(load_scenario(case(keys))) == pytest.approx(exact, rel=0.015)


def test_areas_that_share_an_edge_are_no_overlap(case):
    """Nor is an outline that touches itself at a corner one that crosses itself."""
    areas = "[[[1, 1], [2, 2], [1, 3]]], [[[2, 2], [1, 1], [4, 1], [4, 3], [1, 3]]]"
    scenario = load_scenario(case(f"polygons = [{areas}]\nthickness = 0.5"))
    exact = 0.5 * area_of(lambda x, y: (x > 1) & (x < 4) & (y > 1) & (y < 3), (1, 1), (4, 3))
    assert volume_of(scenario) == pytest.approx(exact, rel=0.01)


def test_a_release_needs_a_terrain(case):
    path = case()
    kept = path.read_text()
    path.write_text(kept[: kept.index("[terrain]")] + kept[kept.index("[body.slide]") :])
    with pytest.raises(UserError, match=r"needs a \[terrain\]"):
        load_scenario(path)
