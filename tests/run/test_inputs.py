"""A run needs nothing but its folder: it goes on where the files that it began with are gone."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.record.reader import load
from doseki.report.parts.provenance import provenance
from doseki.running.provenance import noted_files
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.util.input_file import digest_of

from .channel import assert_same_record

SCENARIO = """\
dim = 3
scheme = "resolved"
dp = 0.02
speed_max = 2
time_max = 0.02
time_out = 0.005
gravity = [0, 0, -9.8]
[body.water]
shape = "file"
file = "water.csv"
[body.floor]
shape = "box"
material = "basalt"
fixed = true
min = [0, 0, -0.06]
max = [0.2, 0.2, 0]
[body.stone]
shape = "stl"
material = "basalt"
file = "stone.stl"
centre = [0.1, 0.1, 0.2]
[inflow.more]
material = "water"
hydrograph = "flood.csv"
width = 0.1
position = [0.4, 0.1, 0]
direction = [-1, 0, 0]
depth = 0.04
"""
FILES = ("case.toml", "water.csv", "stone.stl", "flood.csv")


def write_scenario(folder):
    """The scenario and the files that it names."""
    trimesh = pytest.importorskip("trimesh")
    folder.mkdir()
    (folder / "case.toml").write_text(SCENARIO)
    trimesh.creation.box((0.06, 0.06, 0.06)).export(folder / "stone.stl")
    x = 0.01 + 0.02 * np.arange(4)
    rows = [f"{a},{b},{c},0,0,0,0.008,1000,water" for a in x for b in x for c in x]
    header = "x,y,z,vx,vy,vz,mass,density,material"
    (folder / "water.csv").write_text("\n".join([header, *rows]) + "\n")
    (folder / "flood.csv").write_text("t [s],Q [L/s]\n0,1\n0.01,2\n1,2\n")
    return folder / "case.toml"


def run(file, folder, **options):
    return run_scenario(load_scenario(file), folder, RunOptions(threads=1, **options))


@pytest.fixture
def stopped(tmp_path):
    """A run that was stopped on its way, then moved; its files are gone."""
    folder = tmp_path / "run"
    run(write_scenario(tmp_path / "given"), tmp_path / "straight")
    run(
        tmp_path / "given/case.toml",
        folder,
        progress=lambda time, *_: (folder / "STOP").touch() if time > 0.006 else None,
    )
    shutil.rmtree(tmp_path / "given")
    (tmp_path / "elsewhere").mkdir()
    folder.rename(tmp_path / "elsewhere/moved")
    return tmp_path / "elsewhere/moved"


def test_it_goes_on_from_another_place_without_its_files(stopped, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert len(load("moved")) < len(load(tmp_path / "straight"))
    resume_run("moved", ["title=moved"], RunOptions(threads=1))
    assert_same_record(stopped, tmp_path / "straight")
    # The stored scenario names nothing else, after it was written again as well.
    text = (stopped / "scenario.toml").read_text()
    assert str(tmp_path) not in text
    assert len(list((stopped / "inputs").iterdir())) == 2


def test_it_begins_anew_without_its_files(stopped, tmp_path):
    named = noted_files(load(stopped).folder)
    for file in [*(stopped / "checkpoints").iterdir(), stopped / "summary.json"]:
        file.unlink()
    resume_run(stopped, (), RunOptions(threads=1))
    assert_same_record(stopped, tmp_path / "straight")
    assert noted_files(load(stopped).folder) == named


def test_every_file_is_in_its_provenance_and_its_report(stopped, tmp_path):
    """Those that the run needs no longer, too; with the content that they had when read."""
    assert [(each["key"], each["file"]) for each in noted_files(load(stopped).folder)] == [
        ("scenario", "case.toml"),
        ("body.water.file", "water.csv"),
        ("inflow.more.hydrograph", "flood.csv"),
        ("body.stone.file", "stone.stl"),
    ]
    write_scenario(tmp_path / "again")
    shown = provenance(load(stopped))
    for each in noted_files(load(stopped).folder):
        assert each["digest"] == digest_of(tmp_path / "again" / each["file"])
        assert each["file"] in shown
        assert each["digest"] in shown


def test_the_stored_scenario_runs_again(stopped, tmp_path):
    run(stopped / "scenario.toml", tmp_path / "again")
    assert_same_record(tmp_path / "again", tmp_path / "straight")
    names = [
        sorted(f.name for f in (d / "inputs").iterdir()) for d in (stopped, tmp_path / "again")
    ]
    assert names[0] == names[1]


@pytest.mark.parametrize("kind", ["csv", "stl"])
def test_a_changed_copy_is_refused(stopped, kind):
    copy = next((stopped / "inputs").glob(f"*.{kind}"))
    content = bytearray(copy.read_bytes())
    content[-3] ^= 1
    copy.write_bytes(content)
    with pytest.raises(UserError, match=rf"digest: .*{copy.name} is not the file that was meant"):
        resume_run(stopped)


def test_a_missing_copy_is_refused(stopped):
    next((stopped / "inputs").glob("*.stl")).unlink()
    with pytest.raises(UserError, match="no such file"):
        resume_run(stopped)


def test_a_file_that_changes_before_it_is_copied_is_refused(tmp_path):
    scenario = load_scenario(write_scenario(tmp_path / "given"))
    inputs = scenario.body_files  # looked at
    inputs["water"].path.write_text("another")
    with pytest.raises(UserError, match="has changed since it was read"):
        inputs["water"].copy_to(tmp_path / "copy")
