"""Loading: every array as it was recorded, and clear errors for what is not a run."""

from __future__ import annotations

import warnings

import h5py
import numpy as np
import pytest

from doseki.errors import UserError
from doseki.record.between import Between
from doseki.record.reader import load

from ..synthetic_runs import random_state

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


def test_at_gives_the_snapshot_of_a_time(run_folder):
    run = load(run_folder)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert run.at(1.0).time == run.at(1.0 + 1e-12).time == 1.0
        assert run.at(2.0).time == run[-1].time == 2.0
        assert run.at(1.4, nearest=True).time == 1.0
    with pytest.warns(UserWarning, match="no snapshot at 1.4 s, took that of 1 s"):
        assert run.at(1.4).time == 1.0
    assert [snapshot.time for snapshot in run[1:]] == [1.0, 2.0]


@pytest.mark.parametrize("time", [99.0, -0.1, 2.001, float("nan"), float("inf")])
@pytest.mark.parametrize("how", [{}, {"nearest": True}, {"interpolate": True}])
def test_at_refuses_times_outside_the_record(run_folder, time, how):
    with pytest.raises(UserError, match="outside the record, which goes from 0 to 2 s"):
        load(run_folder).at(time, **how)


def test_at_interpolates_between_two_snapshots(run_folder):
    run = load(run_folder)
    before, after, between = run[1], run[2], run.at(1.25, interpolate=True)
    assert between.time == 1.25
    assert set(between) == set(before)
    both = np.isin(before["id"], after["id"])
    assert np.array_equal(between["id"], before["id"][both])
    rows = [np.flatnonzero(after["id"] == k)[0] for k in between["id"]]
    for key in ("position", "velocity", "pressure", "stress"):
        expected = 0.75 * before[key][both] + 0.25 * after[key][rows]
        np.testing.assert_allclose(between[key], expected, rtol=1e-12, atol=1e-15)
    assert np.array_equal(between["material"], before["material"][both])
    assert run.at(1.0, interpolate=True).time == 1.0


def test_what_crosses_a_period_goes_the_shorter_way():
    before = {"id": np.array([7, 3, 5]), "position": np.array([[0.9, 0], [0.1, 1], [0.5, 0]])}
    after = {"id": np.array([3, 7]), "position": np.array([[0.9, 1.0], [0.1, 2.0]])}
    between = Between(0.75, (0.0, 1.0), (before, after), [(0, 0.0, 1.0)])
    np.testing.assert_allclose(between["position"], [[0.05, 1.5], [0.95, 1.0]])
    assert between["id"].tolist() == [7, 3]


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


@pytest.mark.parametrize(
    ("made", "said"),
    [
        ("nothing", "x: no such folder"),
        ("folder", "x: not the folder of a run"),
        ("file", "x: is a file; give the folder of a run"),
    ],
)
def test_what_is_not_a_run_is_refused(tmp_path, made, said):
    path = tmp_path / "x"
    if made == "folder":
        path.mkdir()
    elif made == "file":
        path.write_text("")
    with pytest.raises(UserError, match=said):
        load(path)


def test_a_damaged_snapshot_is_named(run_folder):
    (run_folder / "snapshots/000001.vtkhdf").write_bytes(b"not HDF5")
    with pytest.raises(UserError, match=r"000001\.vtkhdf: cannot be read.*move it away"):
        load(run_folder)[0]
    (run_folder / "snapshots/000001.vtkhdf").unlink()
    assert load(run_folder).times.tolist() == [0.0, 2.0]


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("dim = 2\n", "", "dim is missing"),
        ("dim = 2\n", "dim = 4\n", "dim = 4 must be 2 or 3"),
        ("dp = 0.1\n", "dp = 'fine'\n", "dp = fine must be a number"),
        ("time_max = 2.0\n", "time_max = nan\n", "time_max = nan must be a finite number"),
        ("gravity = [-1.0, ", "gravity = [0.0, 0.0, ", "gravity: a 2-D run needs 2 entries"),
        ("dim = 2\n", "dim = 2\nbody = 3\n", "body = 3 must be a table"),
        ("dp = 0.1\n", "dp = -1.0\n", "dp = -1.0 must be a number above 0"),
        ("gravity = [-1.0, ", "gravity = [-1.0, 0.0, 0.0, ", "must be a list of two or three"),
        ("dim = 2\n", "dim = 2\nperiodic = ['x']\n", "periodic needs domain_min"),
    ],
)
def test_a_damaged_scenario_is_named(run_folder, old, new, said):
    file = run_folder / "scenario.toml"
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))
    with pytest.raises(UserError) as caught:
        _ = load(run_folder).scenario
    assert str(caught.value).startswith(f"{file}: no run has written this: ")
    assert said in str(caught.value)


def test_snapshots_that_go_back_in_time_are_refused_with_the_names_of_both(run_folder):
    files = run_folder / "snapshots"
    (files / "000003.vtkhdf").write_bytes((files / "000001.vtkhdf").read_bytes())
    with pytest.raises(UserError) as caught:
        len(load(run_folder))
    assert str(caught.value).startswith(
        f"{files / '000003.vtkhdf'}: its time, 1 s, is before that of 000002.vtkhdf, 2 s: one of"
    )


def test_a_snapshot_whose_time_is_no_number_is_refused(run_folder):
    file = run_folder / "snapshots/000000.vtkhdf"
    with h5py.File(file, "r+") as opened:
        opened["VTKHDF/FieldData/Time"][...] = np.nan
    with pytest.raises(UserError, match=r"000000\.vtkhdf: its time, nan s, is not finite"):
        len(load(run_folder))


@pytest.mark.parametrize("name", ["summary", "trust"])
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[1,2", "is cut short or damaged: no JSON; bring it back, or move it away"),
        ("[" * 100_000, "is cut short or damaged: no JSON"),
        ("5", "is damaged: it must hold a table, {...}; bring it back, or move it away"),
    ],
)
def test_a_damaged_table_is_named(run_folder, name, text, said):
    (run_folder / f"{name}.json").write_text(text)
    with pytest.raises(UserError) as caught:
        getattr(load(run_folder), name)
    assert str(caught.value).startswith(f"{run_folder / name}.json: {said}")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"status": 5}', r"status = 5 must be a word;"),
        ('{"warnings": 5}', r"warnings = 5 must be a list;"),
    ],
)
def test_a_summary_that_says_what_none_says_is_refused(run_folder, text, said):
    (run_folder / "summary.json").write_text(text)
    with pytest.raises(UserError, match=rf"summary\.json: is damaged: {said}"):
        _ = load(run_folder).summary


@pytest.mark.parametrize("text", ["dim = ", "a = " + "[" * 100_000, "a = " + "1" * 5000])
def test_a_scenario_that_is_no_toml_is_told_in_our_words(run_folder, text):
    (run_folder / "scenario.toml").write_text(text)
    with pytest.raises(UserError, match=r"not valid TOML|no run writes such TOML") as caught:
        _ = load(run_folder).scenario
    assert "recursion" not in str(caught.value)


def test_a_damaged_history_is_named(run_folder):
    with (run_folder / "history.csv").open("a") as file:
        file.write("1.0,oops\n")
    with pytest.raises(UserError, match=r"history\.csv: cannot be read: line 5 has 2 entries"):
        _ = load(run_folder).history


def test_a_word_in_a_history_is_named_with_its_line(run_folder):
    file = run_folder / "history.csv"
    header, first, second, *_ = file.read_text().splitlines()
    time, _, rest = second.split(",", 2)
    file.write_text("\n".join([header, first, f"{time},oops,{rest}", ""]))
    with pytest.raises(UserError, match=r"history\.csv, line 3: step = 'oops' is not a number"):
        _ = load(run_folder).history


def test_particles_of_bodies_need_their_table(tmp_path, record_run):
    def state_at(time):
        return {**random_state(20, 2), "grain": np.arange(20) - 10}

    record_run(tmp_path / "run", state_at=state_at)
    snapshot = load(tmp_path / "run")[0]
    for read in (lambda: snapshot.grains, snapshot.overlaps):
        with pytest.raises(UserError, match=r'000000.vtkhdf: "Grains" is missing'):
            read()
