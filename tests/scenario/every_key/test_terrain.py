"""Every key of [terrain] and of releases changes the run or is refused: see walk.py."""

from __future__ import annotations

import json

import numpy as np
import pytest

from doseki.geodata.raster import Raster, write_raster
from doseki.scenario.tables.terrain.release import Release
from doseki.scenario.tables.terrain.terrain import Terrain

from .walk import NONE, REFUSED, SCHEMES, WORDS, ignored, outcome

HEAD = """
dp = 0.1
time_max = 1
time_out = 0.1
cflnumber = 0.1
[material.water]
nu = 1e-3
[material.rock]
based_on = "basalt"
"""
SQUARE = "[[1.0, 0.8], [2.0, 0.8], [2.0, 1.6], [1.0, 1.6]]"
PLACE = {2: "between = [1, 2]", 3: f"polygon = {SQUARE}"}


def write_map(path, tilt):
    """A tilted, bumpy slope of 4 m by 2.4 m, and a raster of thickness on it."""
    x, y = np.meshgrid((np.arange(40) + 0.5) * 0.1, (np.arange(24) + 0.5) * 0.1)
    height = tilt * x + 0.05 * np.sin(3 * x) + 0.03 * np.cos(4 * y)
    write_raster(path, Raster(height[::-1], 0.0, 0.0, 0.1))


@pytest.fixture
def folder(tmp_path):
    write_map(tmp_path / "map.asc", 0.3)
    write_map(tmp_path / "other.asc", 0.4)
    thick = np.zeros((24, 40))
    thick[8:16, 12:20] = 0.3
    write_raster(tmp_path / "thick.asc", Raster(thick, 0.0, 0.0, 0.1))
    ring = [[1.0, 0.8], [2.0, 0.8], [2.0, 1.4], [1.0, 0.8]]
    geometry = {"type": "Polygon", "coordinates": [ring]}
    feature = {"type": "Feature", "properties": {"thickness": 0.25}, "geometry": geometry}
    text = json.dumps({"type": "FeatureCollection", "features": [feature]})
    (tmp_path / "areas.geojson").write_text(text)
    return tmp_path


@pytest.mark.parametrize("dim", [2, 3])
def test_a_terrain_and_a_release(folder, dim):
    cut = "section = [[0.2, 0.4], [3.6, 2.0]]\n" if dim == 2 else ""
    gravity = "gravity = [0, -9.8]" if dim == 2 else "gravity = [0, 0, -9.8]"
    path = folder / "case.toml"
    path.write_text(
        f'dim = {dim}\n{SCHEMES["resolved"]}{gravity}\n{HEAD}[terrain]\nfile = "map.asc"\n{cut}'
        f'material = "rock"\n[body.slide]\nshape = "release"\nmaterial = "water"\n{PLACE[dim]}\n'
        "thickness = 0.3\n"
    )
    assert outcome(str(path), ()) != REFUSED
    terrain = {
        "file": [str(folder / "other.asc")],
        "digest": ["0" * 32],
        "window": ["[0.1, 0.1, 3.8, 2.3]"],
        "resample": ["0.2"],
        "smoothing": ["0.3"],
        "section": ["[[0.2, 0.4], [3.6, 1.8]]"],
        "material": ["water"],
        "wall": ["free_slip"],
        "ks": ["0.02 with terrain.wall=rough; terrain.ks=0.01; turbulence=mixing_length", "0.02"],
        "mu": ["0.3 with terrain.wall=voellmy; terrain.mu=0.2", "0.3"],
        "turbulent_xi": ["900 with terrain.wall=voellmy; terrain.mu=0.2", "900"],
    }
    names = set(Terrain.model_fields)
    assert ignored(str(path), "terrain.", sorted(names), terrain) == NONE


@pytest.mark.parametrize("dim", [2, 3])
def test_a_release(folder, dim):
    cut = "section = [[0.2, 0.4], [3.6, 2.0]]\n" if dim == 2 else ""
    gravity = "gravity = [0, -9.8]" if dim == 2 else "gravity = [0, 0, -9.8]"
    path = folder / "case.toml"
    path.write_text(
        f'dim = {dim}\n{SCHEMES["resolved"]}{gravity}\n{HEAD}[terrain]\nfile = "map.asc"\n{cut}'
        f'material = "rock"\n[body.slide]\nshape = "release"\nmaterial = "water"\n{PLACE[dim]}\n'
        "thickness = 0.3\n"
    )
    others = "body.slide.polygon=[[1.1, 0.8], [1.9, 0.8], [1.9, 1.5]]"
    zeros = "0, " if dim == 3 else ""
    values = {
        "file": [str(folder / "areas.geojson"), str(folder / "thick.asc")],
        "digest": ["0" * 32],
        "polygon": [others.partition("=")[2]],
        "polygons": [f"[[{SQUARE}]]"],
        "between": ["[1.2, 2]"],
        "thickness": ["0.4", "[0.4]", "[0.4, 0.2]"],
        "material": ["rock"],
        "pressure": ["500"],
        "array": [f"{{count=[2{', 1' if dim == 3 else ''}{', 1'}], step=[0.1, {zeros}0]}}"],
        "velocity": [f"[1, {zeros}0]"],
        "kinematics": ["single"],
        "clamped": ["1"],
        "displacement": [f"[0.1, {zeros}0]"],
        "elastic_law": ["neo_hookean"],
        "damping": ["0.1"],
        "hourglass": ["0.1"],
        "flaw_seed": ["2"],
        "spin": ["[0, 0, 1]" if dim == 3 else "1"],
        "wall": ["free_slip"],
        "ks": ["0.01"],
        "normal": [f"[0, {zeros}1]"],
        "fixed": ["true"],
        "motion": [f"{{velocity=[1, {zeros}0]}}"],
        "mu": ["0.3"],
        "turbulent_xi": ["900"],
    }
    fields = set(Release.model_fields) - WORDS
    assert ignored(str(path), "body.slide.", sorted(fields), values) == NONE
