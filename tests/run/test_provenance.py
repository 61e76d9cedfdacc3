"""With what a run was made: kept at its start, and at each resumption."""

from __future__ import annotations

import json
import re
import socket

import pytest
from tests.terrain.scenes import grid, text

import doseki
from doseki.errors import UserError
from doseki.record.folder import RunFolder
from doseki.running.provenance import (
    _command,
    commit,
    note_provenance,
    provenance_now,
    read_provenance,
)
from doseki.scenario import named_files
from doseki.scenario.load import load_scenario


def test_it_says_versions_machine_and_command():
    said = provenance_now(threads=3, ranks=2)
    assert said["doseki"] == doseki.__version__
    assert {"numpy", "h5py", "scipy"} <= set(said["libraries"])
    assert (said["threads"], said["ranks"]) == (3, 2)
    assert said["command"]
    assert said["memory_bytes"] > 1e8
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\+00:00", said["time"])
    assert socket.gethostname() not in json.dumps([said["system"], said["processor"]])


def test_of_the_program_only_the_name_is_kept():
    assert _command(["/a/b/doseki", "run", "flume"]) == ["doseki", "run", "flume"]
    assert _command([]) == []


def test_the_commit_is_that_of_the_clone():
    found = commit()
    assert found is None or re.fullmatch(r"[0-9a-f]{40}\+?", found)


def test_resumptions_are_added_and_a_new_start_begins_anew(run_folder):
    folder = RunFolder(run_folder)
    assert read_provenance(folder) == []
    for fresh, count in ((True, 1), (False, 2), (False, 3), (True, 1)):
        note_provenance(folder, fresh, 1, 1)
        assert len(read_provenance(folder)) == count


@pytest.mark.parametrize("text", ["", "[]", '{"runs": [1]}', '{"runs": {}}', "\x00"])
def test_a_damaged_one_is_refused_and_keeps_no_run_from_going_on(run_folder, text):
    folder = RunFolder(run_folder)
    folder.provenance.write_text(text)
    with pytest.raises(UserError, match=r"provenance\.json: is .*damaged.* bring it back, or"):
        read_provenance(folder)
    note_provenance(folder, False, 1, 1)
    assert len(read_provenance(folder)) == 1


def test_it_goes_with_the_run_that_is_overwritten(run_folder):
    folder = RunFolder(run_folder)
    note_provenance(folder, True, 1, 1)
    folder.report.write_text("old")
    assert {folder.provenance, folder.report} <= set(folder.recorded())


RELEASE = """
[body.slide]
shape = "release"
material = "water"
file = "release.geojson"
thickness = 0.5
[inflow.rain]
material = "water"
surge = "surge.csv"
width = 0.5
position = [3, 2, 10]
direction = [1, 0, 0]
[gauge.probe]
kind = "surface_height"
position = [3, 2, 10]
[gauge.probe.array]
file = "places.csv"
"""


def test_files_that_a_scenario_takes_in_are_known(tmp_path):
    """Polygons, hydrographs and places of copies become keys of the stored scenario."""
    grid(tmp_path / "terrain.asc", lambda x, y: 10 - 0.1 * x)
    (tmp_path / "terrain.prj").write_text("")
    ring = [[1, 1], [2, 1], [2, 2], [1, 2], [1, 1]]
    shape = {"type": "Polygon", "coordinates": [ring]}
    feature = {"type": "Feature", "properties": {}, "geometry": shape}
    collection = {"type": "FeatureCollection", "features": [feature]}
    (tmp_path / "release.geojson").write_text(json.dumps(collection))
    (tmp_path / "surge.csv").write_text("t,thickness,velocity\n0,0.5,1\n1,0.5,1\n")
    (tmp_path / "places.csv").write_text("x,y,z\n0,0,0\n1,0,0\n")
    (tmp_path / "base.toml").write_text(text(3, more=RELEASE))
    (tmp_path / "case.toml").write_text('extends = "base.toml"\n')
    scenario = load_scenario(str(tmp_path / "case.toml"))
    before = {each.file.path.name: each.file.digest for each in scenario.named_files}
    named = {(each.key, each.file.path.name) for each in scenario.named_files}
    assert named == {
        ("scenario", "case.toml"),
        ("extends", "base.toml"),
        ("terrain.file", "terrain.asc"),
        ("terrain.file", "terrain.prj"),
        ("body.slide.file", "release.geojson"),
        ("inflow.rain.surge", "surge.csv"),
        ("gauge.probe.array.file", "places.csv"),
    }
    (tmp_path / "release.geojson").write_text("{}")
    digests = {each.file.path.name: each.file.digest for each in scenario.named_files}
    assert digests == before  # that of what was read


def test_what_lies_beside_a_file_need_not_be_readable(tmp_path, monkeypatch):
    for name in ("a.asc", "a.prj", "a.asc.aux.xml"):
        (tmp_path / name).write_text(name)
    closed, read = {"a.prj"}, named_files.input_file

    def forbidden(path):
        if path.name in closed:
            raise UserError(f"{path}: cannot be read")
        return read(path)

    monkeypatch.setattr(named_files, "input_file", forbidden)
    named = {("body", "slide", "file"): [tmp_path / "a.asc"]}
    in_full = named_files.read_in_full(named)
    assert [each.path.name for each in in_full] == ["a.asc", "a.asc.aux.xml"]
    by_key = named_files.named_files(named, {})
    assert [each.file.path.name for each in by_key] == ["a.asc", "a.asc.aux.xml"]
    closed.add("a.asc")
    with pytest.raises(UserError, match="cannot be read"):
        named_files.read_in_full(named)
