"""Loading: every array as it was recorded, and clear errors for what is not a run."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.record.reader import load

NAMES = {"material": ("water", "basalt", "aluminium"), "body": ("sea", "grain", "bed")}


@pytest.mark.parametrize("dim", [2, 3])
def test_snapshots_come_back_bit_by_bit(tmp_path, record_run, dim):
    _, states = record_run(tmp_path / "run", dim=dim)
    run = load(tmp_path / "run")
    assert list(run.times) == [0.0, 1.0, 2.0]
    for snapshot, state in zip(run, states, strict=True):
        assert snapshot.dim == dim
        assert set(snapshot) == {*state, "fixed"}
        for key, values in state.items():
            expected = np.array(NAMES[key])[values] if key in NAMES else values
            assert np.array_equal(snapshot[key], expected), key
        assert np.array_equal(snapshot["fixed"], state["motion"] == 1)


def test_at_gives_the_nearest_snapshot(run_folder):
    run = load(run_folder)
    assert run.at(1.4).time == 1.0
    assert run.at(99.0).time == run[-1].time == 2.0
    assert [snapshot.time for snapshot in run[1:]] == [1.0, 2.0]


def test_history_scenario_and_summary(run_folder):
    run = load(run_folder)
    assert run.history.columns[:3] == ["time", "step", "dt"]
    assert run.history["kinetic_energy"][1] == 1.0 / 3.0 + 1.0
    assert run.scenario["dim"] == 2
    assert run.summary == {"status": "done"}


def test_unknown_names_are_met_with_the_nearest_known_one(run_folder):
    run = load(run_folder)
    with pytest.raises(KeyError, match="did you mean density"):
        run[0]["densty"]
    with pytest.raises(KeyError, match="did you mean kinetic_energy"):
        run.history["kinetic_enrgy"]


def test_a_run_that_is_going_on_can_be_loaded(tmp_path, record_run):
    recorder, _ = record_run(tmp_path / "run", times=())
    run = load(tmp_path / "run")
    assert len(run) == 0
    assert len(run.history) == 0
    with pytest.raises(UserError, match="no snapshot yet"):
        run.at(0.0)
    recorder.history({"time": 0.0, "step": 0})
    with (tmp_path / "run/history.csv").open("a") as file:
        file.write("1.0,")  # a row that is just being written
    assert list(load(tmp_path / "run").history["time"]) == [0.0]


def test_a_half_written_snapshot_is_not_seen(run_folder):
    (run_folder / "snapshots/.000003.vtkhdf.part").write_bytes(b"half")
    assert len(load(run_folder)) == 3


@pytest.mark.parametrize("made", ["nothing", "folder", "file"])
def test_what_is_not_a_run_is_refused(tmp_path, made):
    path = tmp_path / "x"
    if made == "folder":
        path.mkdir()
    elif made == "file":
        path.write_text("")
    with pytest.raises(UserError, match=r"not the folder of a run|no such folder"):
        load(path)


def test_a_damaged_snapshot_is_named(run_folder):
    (run_folder / "snapshots/000001.vtkhdf").write_bytes(b"not HDF5")
    with pytest.raises(UserError, match=r"000001\.vtkhdf: cannot be read"):
        load(run_folder)[0]


def test_a_damaged_history_is_named(run_folder):
    with (run_folder / "history.csv").open("a") as file:
        file.write("1.0,oops\n")
    with pytest.raises(UserError, match=r"history\.csv: cannot be read"):
        _ = load(run_folder).history
