"""Polygons and lines: read from files of three formats, and points inside them."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.geodata.crs import same_crs
from doseki.geodata.features import Polygon, read_features
from doseki.geodata.inside import inside_rings

WEST, SOUTH = 460_000.0, 5_200_000.0
OUTER = [[0, 0], [10, 0], [10, 10], [0, 10], [0, 0]]
HOLE = [[2, 2], [2, 8], [8, 8], [8, 2], [2, 2]]
CRS = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32633"}}


def moved(ring):
    return [[WEST + x, SOUTH + y] for x, y in ring]


def collection(*geometries, **more):
    """A GeoJSON text; each feature has a thickness."""
    features = [
        {"type": "Feature", "geometry": geometry, "properties": {"thickness": n + 0.5, "name": "a"}}
        for n, geometry in enumerate(geometries)
    ]
    return {"type": "FeatureCollection", "features": features} | more


FRAME = {"type": "Polygon", "coordinates": [moved(OUTER), moved(HOLE)]}
TWO = {
    "type": "MultiPolygon",
    "coordinates": [[moved(OUTER)], [[[p[0] + 20, p[1]] for p in moved(OUTER)]]],
}
PATH = {"type": "LineString", "coordinates": [[WEST, SOUTH, 900.0], [WEST + 30, SOUTH + 40, 800.0]]}


@pytest.fixture
def geojson(tmp_path):
    """A function that writes a GeoJSON file, and its path."""

    def write(content):
        path = tmp_path / "shapes.geojson"
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return path

    return write


@pytest.fixture(params=["geojson", "shp", "gpkg"])
def any_format(request, tmp_path, geojson):
    """A function that writes features in one of the formats, converted by GDAL."""

    def write(content):
        source = geojson(content)
        if request.param == "geojson":
            return source
        pytest.importorskip("pyogrio", reason="pyogrio: pip install 'doseki[terrain]'")
        target = tmp_path / f"converted.{request.param}"
        try:
            subprocess.run(["ogr2ogr", str(target), str(source)], check=True)
        except FileNotFoundError:
            pytest.skip("no ogr2ogr on this machine: apt-get install gdal-bin")
        return target

    return write


def test_polygons_with_holes_and_parts(any_format):
    found = read_features(any_format(collection(FRAME, TWO, crs=CRS)))
    frame, first, second = found.polygons
    assert (frame.area, first.area, second.area) == (64.0, 100.0, 100.0)
    assert len(frame.outer) == 4  # the first vertex is not repeated
    assert frame.attributes["thickness"] == 0.5
    assert first.attributes == second.attributes
    assert second.attributes["name"] == "a"
    assert second.extent == (WEST + 20, SOUTH, WEST + 30, SOUTH + 10)
    assert same_crs(found.crs, "EPSG:32633") is True
    assert same_crs(found.crs, "EPSG:31287") is False


def test_heights_of_a_compound_system_do_not_tell_it_apart():
    pytest.importorskip("rasterio")
    assert same_crs("EPSG:31287+5778", "EPSG:31287") is True
    assert same_crs("EPSG:31287", "EPSG:31287+5778") is True
    assert same_crs("EPSG:31287+5778", "EPSG:31254") is False


def test_lines_with_heights(any_format):
    (line,) = read_features(any_format(collection(PATH, crs=CRS))).lines
    np.testing.assert_array_equal(line.vertices, [[WEST, SOUTH], [WEST + 30, SOUTH + 40]])
    np.testing.assert_array_equal(line.heights, [900.0, 800.0])


@pytest.mark.parametrize("content", [FRAME, {"type": "Feature", "geometry": FRAME}])
def test_a_single_geometry(geojson, content):
    found = read_features(geojson(content))
    assert len(found.polygons) == 1
    assert found.crs is None


WGS84 = {"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}
REFUSED = {
    "no text": ("", "no GeoJSON: the file is empty"),
    "half of it": (json.dumps(collection(FRAME))[:-40], "no GeoJSON: it stops in the middle"),
    "half of a word": ('{"type": "Feature', "no GeoJSON: it stops in the middle"),
    "deep": ("[" * 100_000, "no GeoJSON: lists within lists, too many deep"),
    "many digits": ("[" + "1" * 5000 + "]", "no GeoJSON: a number has too many digits"),
    "no comma": (
        '{"type":\n "Feature" 3}',
        "line 2: no GeoJSON: what stands at column 12 cannot be there",
    ),
    "a list": ("[]", "feature 1: no geometry"),
    "nothing": (collection(), "neither polygons nor lines"),
    "points": (collection({"type": "Point", "coordinates": [0, 0]}), "Point is not read"),
    "no vertices": (collection({"type": "Polygon", "coordinates": []}), "without vertices"),
    "two vertices": (collection(FRAME | {"coordinates": [OUTER[:2]]}), "three vertices"),
    "words": (collection(FRAME | {"coordinates": [[["a", "b"]] * 4]}), "numbers"),
    "truths": (collection(FRAME | {"coordinates": [[[True, False]] * 4]}), "numbers"),
    "ragged": (collection(FRAME | {"coordinates": [[[0, 0], [1], [2, 2], [3]]]}), "numbers"),
    "NaN": (json.dumps(collection(FRAME)).replace("460010.0", "NaN"), "finite"),
    "far away": (collection(FRAME | {"coordinates": [[[9e99, 0], [0, 1], [1, 1]]]}), "below"),
    "no list": (collection(FRAME | {"coordinates": 5}), "list"),
    "parts are no lists": (collection(TWO | {"coordinates": [5]}), "list"),
    "degrees": (collection(FRAME, crs=WGS84), "degrees"),
    "degrees of Austria": (
        collection(FRAME, crs={"properties": {"name": "urn:ogc:def:crs:EPSG::4312"}}),
        "degrees",
    ),
    "crs without a name": (collection(FRAME, crs={"type": "name"}), "no name"),
    "features are no list": ({"type": "FeatureCollection", "features": 1}, "list"),
    "properties are no object": (
        {"type": "Feature", "geometry": FRAME, "properties": [1]},
        "object",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_used_is_refused(geojson, refusal, name):
    content, word = REFUSED[name]
    assert word in refusal(read_features, geojson(content))


@pytest.mark.parametrize("suffix", ["shp", "gpkg"])
@pytest.mark.parametrize("content", [b"", b"\x00\x00\x27\x0a", b"SQLite format 3\x00" + b"x" * 99])
def test_damaged_files_are_refused(tmp_path, suffix, content):
    pytest.importorskip("pyogrio", reason="pyogrio: pip install 'doseki[terrain]'")
    path = tmp_path / f"x.{suffix}"
    path.write_bytes(content)
    with pytest.raises(UserError, match=str(path)):
        read_features(path)


@pytest.fixture
def geopackage(tmp_path):
    """A function that writes geometries into a GeoPackage, and its path."""
    pyogrio = pytest.importorskip("pyogrio", reason="pyogrio: pip install 'doseki[terrain]'")
    shapely = pytest.importorskip("shapely")

    def write(*texts, **more):
        path, shapes = (
            tmp_path / "x.gpkg",
            [text and shapely.to_wkb(shapely.from_wkt(text)) for text in texts],
        )
        about = {"geometry_type": "Polygon", "crs": "EPSG:32633", "driver": "GPKG"}
        pyogrio.raw.write(path, np.array(shapes, object), [], [], **about | more)
        return path

    return write


AREA = "POLYGON ((0 0, 9 0, 9 9, 0 0))"


def test_a_geopackage_cut_short_is_told_without_words_of_its_library(geopackage):
    path = geopackage(*[AREA] * 99)
    path.write_bytes(path.read_bytes()[:30_000])
    with pytest.raises(UserError, match=r"it is cut short, damaged, or not a GeoPackage$"):
        read_features(path)


@pytest.mark.parametrize("text", [None, "POLYGON EMPTY"])
def test_a_feature_without_geometry_is_told(geopackage, refusal, text):
    assert "feature 2: no geometry; draw" in refusal(read_features, geopackage(AREA, text))


def test_of_several_layers_one_is_chosen(tmp_path, geojson, refusal, gdal):
    pytest.importorskip("pyogrio", reason="pyogrio: pip install 'doseki[terrain]'")
    source, target = geojson(collection(FRAME, crs=CRS)), tmp_path / "two.gpkg"
    subprocess.run(["ogr2ogr", str(target), str(source), "-nln", "one"], check=True)
    subprocess.run(["ogr2ogr", "-append", str(target), str(source), "-nln", "two"], check=True)
    assert 'no layer "three"; it has one, two' in refusal(read_features, target, "three")
    assert len(read_features(target, "two").polygons) == 1


def test_a_file_of_several_layers_is_refused_with_what_to_do(geopackage, refusal):
    geopackage(AREA, layer="one")
    said = refusal(read_features, geopackage(AREA, layer="two", append=True))
    assert "has the layers one, two, and one is read; write it into a file of its own" in said
    assert said.endswith("ogr2ogr NEW.gpkg x.gpkg LAYER")


def test_tables_of_styles_are_no_layers(tmp_path, geojson, gdal):
    """As QGIS keeps them in the same file."""
    pytest.importorskip("pyogrio", reason="pyogrio: pip install 'doseki[terrain]'")
    source, target = geojson(collection(FRAME, crs=CRS)), tmp_path / "styled.gpkg"
    (tmp_path / "style.csv").write_text("name,qml\nrelease,red\n")
    subprocess.run(["ogr2ogr", str(target), str(source), "-nln", "release"], check=True)
    styles = ["ogr2ogr", "-append", str(target), str(tmp_path / "style.csv")]
    subprocess.run([*styles, "-nln", "layer_styles"], check=True)
    assert len(read_features(target).polygons) == 1


def test_without_pyogrio_one_sentence(tmp_path, refusal, monkeypatch):
    (tmp_path / "x.shp").write_bytes(b"\x00\x00\x27\x0a")
    monkeypatch.setitem(sys.modules, "pyogrio.raw", None)
    assert "pip install 'doseki[terrain]'" in refusal(read_features, tmp_path / "x.shp")


def test_other_formats_are_refused(tmp_path, refusal):
    (tmp_path / "x.kml").write_text("<kml/>")
    assert ".geojson, .shp or .gpkg" in refusal(read_features, tmp_path / "x.kml")


def test_points_inside_a_polygon_with_a_hole():
    frame = Polygon(np.array(OUTER[:-1], float), (np.array(HOLE[:-1], float),))
    x = np.array([1.0, 5.0, 9.0, 11.0, -1.0, 5.0])
    y = np.array([1.0, 5.0, 5.0, 5.0, 5.0, 9.0])
    assert frame.contains(x, y).tolist() == [True, False, True, False, False, True]


@pytest.mark.parametrize("origin", [(0.0, 0.0), (WEST, SOUTH)])
def test_shared_edges_belong_to_one(origin):
    """A square cut into triangles from its middle; points of a lattice lie on the cuts."""
    corners = np.array(OUTER[:-1], float) + origin
    middle = corners.mean(axis=0)
    x, y = np.meshgrid(np.arange(0, 10, 0.5) + origin[0], np.arange(0, 10, 0.5) + origin[1])
    count = np.zeros(x.shape, int)
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        for ring in ([start, end, middle], [end, start, middle]):
            count += inside_rings([np.array(ring)], x, y)
    assert (count == 2).all()  # each triangle is counted both ways round


def test_as_shapely_finds_them():
    shapely = pytest.importorskip("shapely", reason="shapely: pip install 'doseki[terrain]'")
    random = np.random.default_rng(5)
    angle = np.sort(random.uniform(0, 2 * np.pi, 60))
    ring = random.uniform(0.3, 1.0, 60)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    ring = 100 * ring + (WEST, SOUTH)
    x = WEST + random.uniform(-110, 110, 20_000)
    y = SOUTH + random.uniform(-110, 110, 20_000)
    ours = Polygon(ring).contains(x, y)
    assert np.array_equal(ours, shapely.contains_xy(shapely.Polygon(ring), x, y))
    assert np.array_equal(ours, Polygon(ring[::-1]).contains(x, y))
    assert 0.2 < ours.mean() < 0.8
    assert Polygon(ring).area == pytest.approx(shapely.Polygon(ring).area)


def test_real_features(terrain_data):
    pytest.importorskip("pyogrio", reason="pyogrio: pip install 'doseki[terrain]'")
    (release,) = read_features(terrain_data / "avaAlr/Inputs/REL/relAlr.shp").polygons
    assert release.area == pytest.approx(40_997.12, abs=0.01)
    assert release.attributes["thickness"] == 1.0
    (dam,) = read_features(terrain_data / "avaSlide/Inputs/DAM/dam.shp").lines
    assert dam.attributes["slope"] == 60.0
    assert dam.heights is not None
    (path,) = read_features(terrain_data / "avaAlr/Inputs/LINES/path_aimec.shp").lines
    assert path.vertices.shape == (8, 2)


def test_real_features_in_degrees_are_refused(terrain_data, refusal):
    pytest.importorskip("pyogrio", reason="pyogrio: pip install 'doseki[terrain]'")
    path = terrain_data / "avaSlide/Inputs/devREL/slideRelease.shp"
    assert "ogr2ogr -t_srs" in refusal(read_features, path)
