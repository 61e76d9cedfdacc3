"""Damaged checkpoints are found out, and the one before is used, saying so."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from doseki.driver.checkpoint import (
    Checkpoint,
    CheckpointFolder,
    DamagedCheckpointError,
    Position,
    from_bytes,
    to_bytes,
)
from doseki.errors import UserError
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions

from .channel import assert_same_record, doseki_command, run_channel

HERE = Path("000000000003.h5")


def make_checkpoint(step=3):
    state = {"time": np.array([0.1]), "steps": np.array([step]), "lanes": np.array([4])}
    state["position"] = np.eye(50, 2)
    position = Position(
        outputs=2,
        snapshots=2,
        rows=17,
        gauge_rows={"depth": 3},
        next_checkpoint=0.5,
        wall_seconds=3.5,
        sensors={"wall": [0.1, 1 / 3]},
    )
    return Checkpoint(state, position, ["water"], ["sea", "bed"])


@pytest.fixture(scope="module")
def stopped(channel_file, tmp_path_factory):
    """The folder of a run that was stopped, with two checkpoints."""
    folder = tmp_path_factory.mktemp("stopped") / "run"

    def stop(now, _dt, _step):
        if now >= 0.02:
            (folder / "STOP").touch()

    run_channel(channel_file, folder, progress=stop, checkpoint_every=0.004)
    return folder


@pytest.fixture
def run(stopped, tmp_path):
    """A copy of it, to be damaged."""
    return shutil.copytree(stopped, tmp_path / "run")


def truncate(data):
    return data[: len(data) // 2]


def flip(data):
    middle = len(data) // 2
    return data[:middle] + bytes([data[middle] ^ 4]) + data[middle + 1 :]


def test_a_checkpoint_reads_back_to_the_last_bit():
    written = make_checkpoint()
    read = from_bytes(bytes(to_bytes(written)), HERE)
    assert (read.position, read.material_names, read.body_names) == (
        written.position,
        ["water"],
        ["sea", "bed"],
    )
    assert (read.time, read.step) == (0.1, 3)
    for name, values in written.state.items():
        np.testing.assert_array_equal(read.state[name], values)
        assert read.state[name].dtype == values.dtype


def test_every_flipped_bit_and_every_cut_is_found():
    data = bytes(to_bytes(make_checkpoint()))
    random = np.random.default_rng(1)
    for place in random.integers(0, len(data), 300):
        broken = bytearray(data)
        broken[place] ^= 1 << random.integers(8)
        with pytest.raises(DamagedCheckpointError):
            from_bytes(bytes(broken), HERE)
    for length in (0, 1, 63, 64, 65, 200, len(data) - 1):
        with pytest.raises(DamagedCheckpointError):
            from_bytes(data[:length], HERE)


@pytest.mark.parametrize("damage", [truncate, flip, lambda _data: b""])
def test_the_previous_checkpoint_is_used_and_said_so(run, uninterrupted, damage):
    last = CheckpointFolder(run / "checkpoints").files()[-1]
    last.write_bytes(damage(last.read_bytes()))
    _, notes = resume_run(run, (), RunOptions(threads=1))
    assert len(notes) == 1
    assert str(last) in notes[0]
    assert "damaged" in notes[0]
    assert_same_record(run, uninterrupted)


def test_the_command_line_says_so_too(run, uninterrupted):
    last = CheckpointFolder(run / "checkpoints").files()[-1]
    last.write_bytes(flip(last.read_bytes()))
    done = doseki_command("resume", run, "--threads", 1, "--no-figures")
    assert done.returncode == 0
    assert f"warning: {last} is damaged" in done.stderr
    assert_same_record(run, uninterrupted)


def test_without_a_whole_checkpoint_nothing_is_touched(run):
    for file in CheckpointFolder(run / "checkpoints").files():
        file.write_bytes(truncate(file.read_bytes()))
    before = {file: file.read_bytes() for file in run.rglob("*") if file.is_file()}
    with pytest.raises(UserError, match="no whole checkpoint") as caught:
        resume_run(run)
    assert "using the one before it" not in str(caught.value)
    assert {file: file.read_bytes() for file in run.rglob("*") if file.is_file()} == before


@pytest.mark.parametrize("spoilt", [False, True])
def test_times_before_all_checkpoints_are_told_which_there_are(run, spoilt):
    first, last = CheckpointFolder(run / "checkpoints").files()
    times = [from_bytes(file.read_bytes(), file).time for file in (first, last)]
    if spoilt:
        first.write_bytes(flip(first.read_bytes()))
        times = times[1:]
    with pytest.raises(UserError, match=r"no whole checkpoint at .* at most 0.001 s") as caught:
        resume_run(run, until=0.001)
    said, at = str(caught.value).split("; checkpoints are at ")
    assert (f"{first} is damaged" in said) == spoilt
    told = [float(time.removesuffix(" s")) for time in at.split(" and ")]
    assert told == pytest.approx(times, rel=1e-5)
    assert all(one >= other for one, other in zip(told, times, strict=True))


def test_a_record_with_missing_rows_is_refused(run):
    history = run / "history.csv"
    history.write_text("".join(history.read_text().splitlines(keepends=True)[:4]))
    with pytest.raises(UserError, match="rows have gone"):
        resume_run(run)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("time", "tiem", "'tiem' stands where a run of this version has the column 'time'"),
        (",step", "", "'dt' stands where .* has the column 'step'"),
        (",share_wait", "", "it ends where .* has the column 'share_wait'"),
        (",share_wait", ",share_wait,more", "'more' stands where .* has nothing"),
    ],
)
def test_a_history_with_another_header_is_refused_before_anything_is_touched(run, old, new, said):
    history = run / "history.csv"
    header, *rows = history.read_text().splitlines()
    lost = len(new.split(",")) - len(old.split(","))
    cells = [",".join([*row.split(","), "0"][: header.count(",") + 1 + lost]) for row in rows]
    history.write_text("\n".join([header.replace(old, new, 1), *cells, ""]))
    before = {file: file.read_bytes() for file in run.rglob("*") if file.is_file()}
    with pytest.raises(UserError, match=rf"history\.csv, line 1: {said}"):
        resume_run(run)
    assert {file: file.read_bytes() for file in run.rglob("*") if file.is_file()} == before


@pytest.mark.parametrize("name", ["film", "channel"])
def test_a_checkpoint_of_another_run_is_refused(run, channel_file, tmp_path, name):
    """Also of one with the same bodies of the same materials, at other places."""
    other = ("film",) if name == "film" else (channel_file, "body.rocks.max=[0.09, 0.03]")
    file, *settings = other
    run_channel(file, tmp_path / "other", "time_max=0.01", *settings)
    for own in CheckpointFolder(run / "checkpoints").files():
        own.unlink()
    for foreign in CheckpointFolder(tmp_path / "other/checkpoints").files():
        shutil.copy(foreign, run / "checkpoints")
    with pytest.raises(UserError, match="is a checkpoint of another run"):
        resume_run(run)
    unsealed = (run / "scenario.toml").read_text().splitlines()[:-1]
    (run / "scenario.toml").write_text("\n".join(unsealed) + "\n")
    if name == "film":
        with pytest.raises(UserError, match="materials are not those"):
            resume_run(run)
