"""Files of others: nothing outside them is read, nothing hangs, no size is taken on trust."""

from __future__ import annotations

import hashlib
import os
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from tests.fuzz.generators import hdf5_file
from tests.hostile_hdf5 import HARMS, spoil

from doseki.driver.checkpoint import Checkpoint, CheckpointFolder, Position, to_bytes
from doseki.errors import UserError
from doseki.record.reader import load
from doseki.scenario.hydrographs import read_hydrograph
from doseki.scenario.particle_files.reader import read_particles
from doseki.scenario.values.toml_source import read_toml
from doseki.scene.shapes import ShapeError, mesh_shape
from doseki.util.foreign import read_bytes
from doseki.util.hdf5 import open_hdf5


@pytest.fixture
def particle_file(tmp_path):
    path = tmp_path / "p.h5"
    path.write_bytes(hdf5_file(compressed=True))
    return path


@pytest.fixture
def checkpoint_file(tmp_path):
    state = {name: np.array([1.0]) for name in ("time", "steps", "lanes")}
    state["position"] = np.ones((50, 2))
    path = tmp_path / "checkpoints/000000000001.h5"
    path.parent.mkdir()
    path.write_bytes(to_bytes(Checkpoint(state, Position(), ["water"], ["sea"])))
    return path


def sign(path):
    """Append the digest, as whoever tampers with a checkpoint does."""
    content = path.read_bytes()
    path.write_bytes(content + hashlib.blake2b(content).digest())


def assert_refused(read, *arguments):
    """One sentence, and no memory taken."""
    with pytest.raises(UserError) as caught:
        read(*arguments)
    assert "mistake" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("harm", HARMS)
def test_a_particle_file(particle_file, harm):
    spoil(particle_file, "x", harm)
    assert '"x"' in assert_refused(read_particles, particle_file, 2, None)


@pytest.mark.parametrize("harm", HARMS)
def test_names_in_a_particle_file(particle_file, harm):
    spoil(particle_file, "material", harm)
    assert_refused(read_particles, particle_file, 2, None)


@pytest.mark.parametrize("harm", HARMS)
def test_a_snapshot(run_folder, harm):
    spoil(run_folder / "snapshots/000001.vtkhdf", "VTKHDF/Points", harm)
    assert "Points" in assert_refused(lambda: load(run_folder)[1]["position"])


@pytest.mark.parametrize("harm", HARMS)
def test_a_checkpoint(checkpoint_file, harm):
    spoil(checkpoint_file, "position", harm)
    sign(checkpoint_file)
    said = assert_refused(CheckpointFolder(checkpoint_file.parent).read_last)
    assert '"position"' in said


def test_names_beside_a_snapshot_that_are_longer_than_memory(run_folder, monkeypatch):
    path = run_folder / "snapshots/000001.vtkhdf"
    with h5py.File(path, "r+") as file:
        names = np.array(["x" * 10**6] + ["x"] * 2000, object)
        attributes = file["VTKHDF"].attrs
        del attributes["BodyNames"]
        attributes.create("BodyNames", names, dtype=h5py.string_dtype())
    monkeypatch.setattr("doseki.util.hdf5.available_bytes", lambda: 2**28)
    assert "more than this machine can hold" in assert_refused(lambda: load(run_folder)[0])


def test_an_index_beyond_the_names(run_folder):
    with h5py.File(run_folder / "snapshots/000001.vtkhdf", "r+") as file:
        file["VTKHDF/PointData/Material"][3] = 99
    assert "outside the 3 names" in assert_refused(lambda: load(run_folder)[1]["material"])


def test_fields_that_differ_in_length(run_folder):
    with h5py.File(run_folder / "snapshots/000001.vtkhdf", "r+") as file:
        del file["VTKHDF/PointData/Density"]
        file["VTKHDF/PointData/Density"] = np.ones(3)
    assert "must hold 20 numbers" in assert_refused(lambda: load(run_folder)[1]["density"])


READERS = {
    "particles": lambda path: read_particles(path, 2, None),
    "hydrograph": read_hydrograph,
    "scenario": read_toml,
    "bytes": read_bytes,
    "hdf5": lambda path: open_hdf5(path).__enter__(),
    "stl": lambda path: mesh_shape(path, 1.0),
}


def not_files(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    (tmp_path / "link").symlink_to("/dev/zero")
    found = [tmp_path / name for name in ("pipe", "folder", "link", "absent", "n" * 300)]
    return [*found, Path("/dev/zero"), Path("/dev/stdin")]


@pytest.mark.parametrize("reader", READERS)
def test_what_is_no_file_is_not_opened(tmp_path, reader):
    """A pipe would wait for ever, a device would never end."""
    for path in not_files(tmp_path):
        with pytest.raises((UserError, ShapeError)):
            READERS[reader](path)


@pytest.mark.parametrize("reader", [name for name in READERS if name != "bytes"])
@pytest.mark.parametrize("path", ["/proc/self/mem", "/proc/self/environ", "/proc/kmsg"])
def test_what_the_kernel_pretends_to_be_a_file_is_empty(reader, path):
    if reader == "scenario":
        assert READERS[reader](Path(path)).table == {}
        return
    with pytest.raises((UserError, ShapeError)):
        READERS[reader](Path(path))
    assert read_bytes(Path("/proc/self/environ")) == b""


@pytest.mark.parametrize("name", ["snapshots/000001.vtkhdf", "history.csv", "gauges/g.csv"])
@pytest.mark.parametrize("content", [b"", b"\x00\xff" * 500, b"\x89HDF\r\n\x1a\n" + bytes(99)])
def test_a_run_folder_with_one_file_spoilt(run_folder, name, content):
    """Empty tables are those of a run that was killed; all else is refused in a sentence."""
    path = run_folder / name
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(content)

    def read():
        run = load(run_folder)
        return run.history, run.gauges, [dict(snapshot) for snapshot in run]

    if content or name.startswith("snapshots"):
        assert name in assert_refused(read)
    else:
        read()


@pytest.mark.parametrize("name", ["snapshots/000001.vtkhdf", "history.csv", "scenario.toml"])
def test_a_pipe_in_a_run_folder_does_not_hang(run_folder, name):
    (run_folder / name).unlink()
    os.mkfifo(run_folder / name)

    def read():
        run = load(run_folder)
        return run.history, run.scenario, run.times

    assert_refused(read)


def test_checkpoints_of_other_names_are_none(checkpoint_file):
    shutil.copy(checkpoint_file, checkpoint_file.with_name("9x.h5"))
    shutil.copy(checkpoint_file, checkpoint_file.with_name("1.h5"))
    folder = CheckpointFolder(checkpoint_file.parent)
    assert folder.files() == [checkpoint_file]
    folder.drop_later(0)
    assert checkpoint_file.with_name("9x.h5").exists()
