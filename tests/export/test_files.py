"""The files of surfaces, read back, and what is refused."""

from __future__ import annotations

import csv
import json
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

from doseki.cli.app import app
from doseki.errors import UserError
from doseki.export.surface.write import SurfaceOptions, export_surface
from doseki.export.triangles import near_origin
from doseki.record.reader import load

from ..synthetic_runs import make_plain_state
from .clouds import lattice

DP, SIDE = 0.1, 0.5
FAR = np.array([600_000.5, 200_000.25, 400.0])


def block(dim, at=0.0):
    """A block of water that falls at 1 m/s, with a bed below it."""

    def state(time):
        water = lattice([0.0] * dim, [SIDE] * dim, DP)
        water[:, -1] -= time
        bed = lattice([-0.3] * (dim - 1) + [-2.8], [0.8] * (dim - 1) + [-2.5], DP)
        position = np.concatenate([water, bed]) + np.asarray(at)
        velocity = np.zeros_like(position)
        velocity[: len(water), -1] = -1.0
        made = make_plain_state(position, velocity, np.repeat([0, 2], [len(water), len(bed)]))
        return made | {"mass": np.full(len(position), 1000 * DP**dim),
                       "density": np.full(len(position), 1000.0)}  # fmt: skip

    return state


@pytest.fixture
def blocks(tmp_path, record_run):
    """A function that records the falling block."""

    def record(dim=3, at=0.0):
        record_run(tmp_path / "run", dim=dim, state_at=block(dim, at))[0].close({})
        return load(tmp_path / "run")

    return record


@pytest.mark.parametrize("kind", ["ply", "stl"])
def test_meshes_are_closed_and_have_their_volume(blocks, kind):
    run = blocks()
    export_surface(run, SurfaceOptions(kind))
    for number, time in enumerate(run.times):
        mesh = trimesh.load_mesh(run.directory / f"surface/water_{number:06d}.{kind}")
        mesh.merge_vertices()
        assert mesh.is_watertight
        assert mesh.volume == pytest.approx(SIDE**3, rel=0.2)
        assert mesh.bounds[1, 2] == pytest.approx(SIDE - time, abs=0.01)
    index = json.loads((run.directory / f"surface/water.{kind}.series").read_text())
    assert index["file-series-version"] == "1.0"
    assert [entry["time"] for entry in index["files"]] == run.times.tolist()
    assert all((run.directory / "surface" / e["name"]).is_file() for e in index["files"])


def test_a_ply_has_fields_and_says_their_units(blocks):
    run = blocks()
    export_surface(run, SurfaceOptions("ply", times=(1.0,)))
    file = run.directory / "surface/water_000001.ply"
    head = file.read_bytes().partition(b"end_header")[0].decode()
    for line in ("x y z [m]", "speed [m/s]", "pressure [Pa]", "velocity_z [m/s]"):
        assert f"comment {line}" in head
    assert "property double x" in head
    found = trimesh.load_mesh(file, process=False).metadata["_ply_raw"]["vertex"]["data"]
    assert np.asarray(found["velocity_z"]) == pytest.approx(-1.0)


@pytest.mark.parametrize("kind", ["ply", "stl"])
def test_map_coordinates_lose_nothing(blocks, kind):
    """Readers keep single precision: the file holds places about a point that it names."""
    run = blocks(at=FAR)
    export_surface(run, SurfaceOptions(kind, times=(0.0,)))
    file = run.directory / f"surface/water_000000.{kind}"
    start = file.read_bytes()[:2000].decode("latin-1")
    origin = np.array(re.search(r"origin (-?\d+) (-?\d+) (-?\d+)", start).groups(), float)
    mesh = trimesh.load_mesh(file)
    assert np.abs(mesh.vertices).max() < 2.0
    middle = mesh.bounds.mean(axis=0) + origin
    assert middle == pytest.approx(FAR + 0.5 * SIDE, abs=1e-5)


@pytest.mark.parametrize("kind", ["ply", "stl"])
def test_files_of_one_export_have_one_origin(blocks, kind):
    """Or what falls would jump back by whole metres from one time to the next."""
    run = blocks(at=FAR)
    export_surface(run, SurfaceOptions(kind))
    origins = set()
    for file in (run.directory / "surface").glob(f"*.{kind}"):
        start = file.read_bytes()[:2000].decode("latin-1")
        origins.add(re.search(r"origin (-?\d+ -?\d+ -?\d+)", start).group(1))
    assert len(run.times) > 1
    assert len(origins) == 1


def test_near_places_stay_as_they_are():
    assert not near_origin(np.array([[100.0, -3.0, 2.0]]), 0.01).any()
    assert near_origin(np.array([[200.5, -3.0, 2.0]]), 0.01).tolist() == [200.0, -3.0, 2.0]


@pytest.mark.parametrize("dim", [2, 3])
def test_the_index_and_the_table_say_what_there_is(blocks, dim):
    run = blocks(dim)
    lines = export_surface(run, SurfaceOptions())
    folder = run.directory / "surface"
    assert lines[0].startswith(f"{folder}/water.pvd: 3 times")
    entries = list(ET.parse(folder / "water.pvd").getroot().iter("DataSet"))
    assert [float(entry.get("timestep")) for entry in entries] == run.times.tolist()
    assert all((folder / entry.get("file")).is_file() for entry in entries)
    header, *rows = csv.reader((folder / "water.csv").read_text().splitlines())
    assert (
        header[1:]
        == {
            2: ["length [m]", "area [m2]", "area of particles [m2]"],
            3: ["area [m2]", "volume [m3]", "volume of particles [m3]"],
        }[dim]
    )
    table = np.array(rows, float)
    assert table[:, 0] == pytest.approx(run.times)
    assert table[:, 2] == pytest.approx(SIDE**dim, rel=0.2)
    assert table[:, 3] == pytest.approx(SIDE**dim)


def test_other_materials_have_surfaces_when_they_are_named(blocks):
    run = blocks()
    export_surface(run, SurfaceOptions(materials=("water",), times=(0.9,)))
    assert {file.name for file in (run.directory / "surface").iterdir()} == {
        "water_000001.vtp", "water.pvd", "water.csv"
    }  # fmt: skip


@pytest.mark.parametrize(
    ("dim", "options", "message"),
    [
        (2, SurfaceOptions("stl"), "a 2-D run is a line; use --format vtp"),
        (3, SurfaceOptions("obj"), "not a format of surfaces"),
        (3, SurfaceOptions(materials=("wather",)), "did you mean water"),
        (3, SurfaceOptions(materials=("basalt",)), "nothing of basalt moves"),
        (3, SurfaceOptions(cell=5.0), r"--cell 5: a particle acts as far as"),
        (3, SurfaceOptions(times=(7.0,)), "outside the record"),
    ],
)
def test_what_cannot_be_is_refused_and_leaves_nothing(blocks, dim, options, message):
    run = blocks(dim)
    before = sorted(run.directory.iterdir())
    with pytest.raises(UserError, match=message):
        export_surface(run, options)
    assert sorted(run.directory.iterdir()) == before


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "say what to export, one of --vtu, --surface, --paraview"),
        (["--vtu", "--surface"], "--vtu and --surface at once: export one of them after the"),
        (["--vtu", "--cell", "0.1"], "--cell is about surfaces"),
        (["--paraview", "--time", "0"], "--time is about surfaces"),
    ],
)
def test_options_that_do_not_go_together(blocks, words, message):
    run = blocks()
    ended = CliRunner().invoke(app, ["export", str(run.directory), *words])
    assert isinstance(ended.exception, UserError)
    assert message in str(ended.exception)
