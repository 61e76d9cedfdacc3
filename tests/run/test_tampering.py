"""Checkpoints that somebody has changed, digest and all: refused in a sentence, never a crash."""

from __future__ import annotations

import hashlib
import io
import json
import shutil

import h5py
import numpy as np
import pytest

from doseki.driver.checkpoint import DIGEST_BYTES, CheckpointFolder
from doseki.errors import UserError
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions

from .channel import assert_same_record, run_channel


@pytest.fixture(scope="module")
def stopped(channel_file, tmp_path_factory):
    """The folder of a run that was stopped."""
    folder = tmp_path_factory.mktemp("stopped") / "run"

    def stop(now, _dt, _step):
        if now >= 0.03:
            (folder / "STOP").touch()

    run_channel(channel_file, folder, progress=stop)
    return folder


@pytest.fixture
def run(stopped, tmp_path):
    """A copy of it with one checkpoint, to be changed."""
    folder = shutil.copytree(stopped, tmp_path / "run")
    for file in CheckpointFolder(folder / "checkpoints").files()[:-1]:
        file.unlink()
    return folder


def tamper(run, change):
    """Let `change` change the checkpoint, and give it the digest that belongs to it."""
    (file,) = CheckpointFolder(run / "checkpoints").files()
    image = io.BytesIO(file.read_bytes()[:-DIGEST_BYTES])
    with h5py.File(image, "r+") as opened:
        change(opened)
    content = image.getvalue()
    file.write_bytes(content + hashlib.blake2b(content).digest())


def replaced(name, make):
    """A change of one array."""

    def change(file):
        values = make(file[name][...])
        del file[name]
        file[name] = values

    return change


def at(place, value):
    """A change of one number."""

    def change(values):
        values.reshape(-1)[place] = value
        return values

    return change


def said(change):
    """A change of what stands beside the state."""

    def change_file(file):
        table = json.loads(file["doseki"][...].tobytes())
        change(table)
        del file["doseki"]
        file["doseki"] = np.frombuffer(json.dumps(table).encode(), np.uint8)

    return change_file


CHANGES = {
    "position": replaced("position", lambda values: values[:-3]),
    "density": replaced("density", lambda values: values[:-1]),
    "material": replaced("material", at(0, 32767)),
    "body": replaced("body", at(0, 9999)),
    "motion": replaced("motion", at(0, 200)),
    "lists_entries": replaced("lists_entries", at(5, 2**27 - 1)),
    "lists_moving": replaced("lists_moving", at(0, 2**32 - 1)),
    "lists_fixed": replaced("lists_fixed", lambda values: values[:-1]),
    "moving_particles": replaced("moving_particles", at(0, 1)),
    "stress_record": replaced("stress_record", at(0, np.nan)),
    "velocity": replaced("velocity", at(3, np.inf)),
    "smoothing_length": replaced("smoothing_length", at(0, 0.0)),
    "id": replaced("id", at(0, 7)),
    "next_id": replaced("next_id", at(0, 0)),
    "0_inflow_released": replaced("0_inflow_released", at(0, -(2**62))),
    "mass": replaced("mass", lambda values: values.astype(np.float32)),
    "steps": replaced("steps", lambda values: np.repeat(values, 2)),
    "updates": replaced("updates", at(0, 2**63 - 1)),
    "rebuilds": replaced("rebuilds", at(0, 2**63 - 1)),
    "beyond.steps": replaced("steps", at(0, 2**63 - 1)),
    "beyond.next_id": replaced("next_id", at(0, 2**63 - 1)),
    "elsewhere": lambda file: file.create_dataset("elsewhere", data=[1.0]),
    "last_timestep": lambda file: file.pop("last_timestep"),
    "position.rows": said(lambda table: table["position"].update(rows=-1)),
    "position.outputs": said(lambda table: table["position"].update(outputs="many")),
    "body_names": said(lambda table: table.update(body_names=3)),
    "body_names.0": said(lambda table: table.update(body_names=[1, 2])),
}


@pytest.mark.parametrize("name", CHANGES)
def test_what_cannot_be_is_refused(run, name):
    tamper(run, CHANGES[name])
    before = {file: file.read_bytes() for file in run.rglob("*") if file.is_file()}
    with pytest.raises(UserError) as caught:
        resume_run(run, (), RunOptions(threads=1))
    assert name.partition(".")[2] in str(caught.value) or name in str(caught.value)
    assert "\n" not in str(caught.value)
    assert {file: file.read_bytes() for file in run.rglob("*") if file.is_file()} == before


def test_what_is_only_packed_otherwise_gives_the_same_bits(run, uninterrupted):
    def pack(file):
        for name in list(file):
            values = file[name][...]
            del file[name]
            options = {"compression": "gzip"} if values.size > 1 else {}
            file.create_dataset(name, data=values, **options)

    tamper(run, pack)
    resume_run(run, (), RunOptions(threads=1))
    assert_same_record(run, uninterrupted)


@pytest.mark.parametrize("names", [[], ["bed"], ["bed", "rocks", "water", "more"], ["x", "y", "z"]])
def test_other_names_of_bodies(run, names):
    tamper(run, said(lambda table: table.update(body_names=names)))
    with pytest.raises(UserError, match="bodies"):
        resume_run(run, (), RunOptions(threads=1))


@pytest.fixture
def half(channel_file, tmp_path):
    """The folder of a run that was stopped on its way."""
    folder = tmp_path / "half"
    run_channel(channel_file, folder, progress=lambda *_: (folder / "STOP").touch())
    return folder


def test_a_scenario_that_was_changed_by_hand_is_noticed(half, uninterrupted):
    scenario = half / "scenario.toml"
    text = scenario.read_text()
    for edited in (text.replace("time_max = 0.06", "time_max = 0.05"), "# mine\n" + text):
        assert edited != text
        scenario.write_text(edited)
        before = sorted(half.rglob("*"))
        with pytest.raises(UserError, match=r"changed by hand since the run wrote it; .* --set"):
            resume_run(half, (), RunOptions(threads=1))
        assert sorted(half.rglob("*")) == before
    scenario.write_text(text)
    resume_run(half, ["title=other"], RunOptions(threads=1))  # which seals it again
    resume_run(half, ["time_max=0.061"], RunOptions(threads=1))


def test_what_was_changed_on_purpose_goes_on(half):
    """Without its last line, a scenario is taken as it is."""
    scenario = half / "scenario.toml"
    lines = scenario.read_text().replace("time_max = 0.06", "time_max = 0.05").splitlines()
    scenario.write_text("\n".join(lines[:-1]) + "\n")
    summary, _ = resume_run(half, (), RunOptions(threads=1))
    assert summary["time"] == pytest.approx(0.05)
