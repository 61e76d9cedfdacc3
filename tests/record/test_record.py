"""The recorder: what it writes, what it refuses, and that a killed run stays readable."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from doseki.errors import ResourceError, UserError
from doseki.record.fields import FIELDS, GRAIN_FIELDS
from doseki.record.folder import RunFolder
from doseki.record.reader import load
from doseki.record.writer import Recorder
from doseki.util.files import write_whole

from ..synthetic_runs import random_state


def start(directory: Path, **options: bool) -> Recorder:
    return Recorder(directory, "schema = 1\n", ["water"], ["sea"], 2, **options)


def one_grain(dim):
    """The table of one body at rest in the origin."""
    rows = {"vector": (1, dim), "rows": (1, 3), "scalar": (1,)}
    table = {field.key: np.zeros(rows[field.shape]) for field in GRAIN_FIELDS}
    return table | {"orientation": np.array([[1.0, 0.0, 0.0, 0.0]])}


def test_folder_of_a_run_has_the_promised_files(run_folder):
    names = {str(path.relative_to(run_folder)) for path in run_folder.rglob("*") if path.is_file()}
    assert names == {
        "scenario.toml",
        "history.csv",
        "summary.json",
        "snapshots.vtkhdf.series",
        "snapshots/000000.vtkhdf",
        "snapshots/000001.vtkhdf",
        "snapshots/000002.vtkhdf",
    }


def test_every_field_is_in_the_file_under_its_name_and_unit(run_folder):
    with h5py.File(run_folder / "snapshots/000001.vtkhdf") as file:
        root = file["VTKHDF"]
        assert root["Points"].attrs["units"] == "m"
        for field in FIELDS[1:]:
            assert root["PointData"][field.file_name].attrs.get("units", "") == field.unit_in(2)
        assert root["PointData/Stress"].shape == (20, 6)
        assert root["FieldData/Time"][0] == 1.0


@pytest.mark.parametrize(("dim", "unit"), [(2, "kg/m"), (3, "kg")])
def test_mass_is_per_metre_in_2d(tmp_path, record_run, dim, unit):
    recorder, _ = record_run(tmp_path / "run", dim=dim)
    file = recorder.snapshot(random_state(3, dim), time=9.0, step=1, dt=0.1, grains=one_grain(dim))
    with h5py.File(file) as stored:
        assert stored["VTKHDF/PointData/Mass"].attrs["units"] == unit
        assert stored["Grains/Mass"].attrs["units"] == unit


def test_points_and_velocities_of_a_2d_run_have_z_zero(run_folder):
    with h5py.File(run_folder / "snapshots/000000.vtkhdf") as file:
        for name in ("Points", "PointData/Velocity"):
            assert file["VTKHDF"][name].shape == (20, 3)
            assert not np.any(file["VTKHDF"][name][:, 2])


def test_stress_components_stand_in_the_order_of_vtk(tmp_path, record_run):
    _, states = record_run(tmp_path / "run", dim=3)
    with h5py.File(tmp_path / "run/snapshots/000000.vtkhdf") as file:
        stored = file["VTKHDF/PointData/Stress"][3]
    s = states[0]["stress"][3]
    assert list(stored) == [s[0, 0], s[1, 1], s[2, 2], s[0, 1], s[1, 2], s[0, 2]]


def test_series_index_names_existing_files_with_their_times(run_folder):
    index = json.loads((run_folder / "snapshots.vtkhdf.series").read_text())
    assert [entry["time"] for entry in index["files"]] == [0.0, 1.0, 2.0]
    assert all((run_folder / entry["name"]).is_file() for entry in index["files"])


def test_history_reads_back_to_the_last_bit_and_is_flushed_row_by_row(tmp_path):
    recorder = start(tmp_path / "run")
    recorder.history({"time": 0.1 + 0.2, "step": 3})
    with (tmp_path / "run/history.csv").open() as file:
        assert list(csv.reader(file)) == [["time", "step"], ["0.30000000000000004", "3"]]


def test_history_refuses_other_columns(tmp_path):
    recorder = start(tmp_path / "run")
    recorder.history({"time": 0.0})
    with pytest.raises(ValueError, match="columns changed"):
        recorder.history({"time": 0.0, "energy": 1.0})


def test_summary_is_strict_json(tmp_path):
    recorder = start(tmp_path / "run")
    recorder.close({"a": np.float64("nan"), "b": np.int32(3), "c": {"d": np.arange(2)}})
    text = (tmp_path / "run/summary.json").read_text()
    assert json.loads(text) == {"a": None, "b": 3, "c": {"d": [0, 1]}}
    assert "NaN" not in text


def test_a_folder_that_is_not_empty_is_refused(run_folder):
    before = (run_folder / "history.csv").read_bytes()
    with pytest.raises(UserError, match="not empty"):
        start(run_folder)
    assert (run_folder / "history.csv").read_bytes() == before


def test_overwrite_removes_the_earlier_run_and_nothing_else(run_folder):
    (run_folder / "notes.txt").write_text("mine")
    start(run_folder, overwrite=True)
    assert len(load(run_folder)) == 0
    assert not (run_folder / "summary.json").exists()
    assert (run_folder / "notes.txt").read_text() == "mine"


def test_overwrite_refuses_a_folder_that_is_no_run(tmp_path):
    (tmp_path / "thesis.tex").write_text("x")
    with pytest.raises(UserError, match="not the folder of a run"):
        start(tmp_path, overwrite=True)
    assert (tmp_path / "thesis.tex").exists()


def test_a_file_in_place_of_the_folder_is_refused(tmp_path):
    (tmp_path / "run").write_text("")
    with pytest.raises(UserError, match="is a file"):
        start(tmp_path / "run")


def test_reopen_drops_what_is_later_and_goes_on(run_folder, record_run):
    recorder = Recorder.reopen(run_folder, snapshots=2, rows=2)
    assert list(load(run_folder).times) == [0.0, 1.0]
    assert list(load(run_folder).history["time"]) == [0.0, 1.0]
    assert load(run_folder).summary == {}
    state = {key: load(run_folder)[0].stored(key) for key in load(run_folder)[0] if key != "fixed"}
    recorder.snapshot(state, time=1.5, step=15, dt=0.1)
    row = dict.fromkeys(load(run_folder).history, 1.5)
    recorder.history(row)
    run = load(run_folder)
    assert list(run.times) == [0.0, 1.0, 1.5]
    assert list(run.history["time"]) == [0.0, 1.0, 1.5]
    assert np.array_equal(run[-1]["material"], run[0]["material"])


def test_reopen_needs_a_snapshot(tmp_path):
    start(tmp_path / "run")
    with pytest.raises(UserError, match="no snapshot"):
        Recorder.reopen(tmp_path / "run", 0, 0)


def test_a_failed_write_leaves_neither_file_nor_scraps(tmp_path):
    def fail(path: Path) -> None:
        path.write_text("half")
        raise OSError(28, "No space left on device")

    with pytest.raises(ResourceError, match=r"file.*No space left"):
        write_whole(tmp_path / "file", fail)
    assert list(tmp_path.iterdir()) == []


FILL_THE_DISK = """
import resource, sys
import numpy as np
from doseki.errors import ResourceError
from doseki.record.fields import FIELDS, GRAIN_FIELDS
from doseki.record.writer import Recorder

recorder = Recorder(sys.argv[1], "schema = 1\\n", ["water"], ["sea"], 2)
random = np.random.default_rng(0)
sizes = {"scalar": (9000,), "vector": (9000, 2), "symmetric": (9000, 3, 3)}
state = {field.key: random.normal(size=sizes[field.shape]) for field in FIELDS}
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
try:
    recorder.snapshot(state, time=0.0, step=0, dt=0.1)
except ResourceError as error:
    print(error)
"""


def test_a_snapshot_that_does_not_fit_is_a_resource_error(tmp_path):
    program = [sys.executable, "-c", FILL_THE_DISK, str(tmp_path / "run")]
    done = subprocess.run(program, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "000000.vtkhdf: cannot be written: File too large" in done.stdout
    assert list(RunFolder(tmp_path / "run").snapshots.iterdir()) == []
