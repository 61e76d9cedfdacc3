"""A snapshot of a small run costs little: the structure of its file is that of the one before."""

from __future__ import annotations

import h5py
import numpy as np
import pytest

from doseki.record import snapshot_writer, writer
from doseki.record.fields import FIELDS, GRAIN_FIELDS
from doseki.record.snapshot_writer import SnapshotWriter
from doseki.record.vtkhdf import Header, read_fields, read_grains, read_header
from doseki.util import files

from ..synthetic_runs import random_state

NAMES = ("water", "basalt", "aluminium"), ("sea", "grain", "bed")


def header(time, dim, names=NAMES):
    return Header(time, round(10 * time), 0.1 * time, dim, *names)


def grain_state(n, dim, seed):
    random = np.random.default_rng(seed)
    return {
        f.key: random.integers(0, 2, n).astype(f.dtype)
        if f.dtype == "int32"
        else random.normal(size=(n, *((dim,) if f.shape == "vector" else f.columns)))
        for f in GRAIN_FIELDS
    }


def assert_holds(path, state, said, grains):
    assert read_header(path) == said
    for field in FIELDS:
        np.testing.assert_array_equal(
            read_fields(path, [field], said.dim)[field.key], state[field.key]
        )
    found = read_grains(path, said.dim)
    assert found.keys() == grains.keys()
    for key, values in found.items():
        np.testing.assert_array_equal(values, grains[key])


def structure(path):
    """All that a file says beside its numbers."""
    said = {}

    def look(name, part):
        attributes = {key: np.asarray(value).tolist() for key, value in part.attrs.items()}
        kind = (part.shape, part.dtype.str) if isinstance(part, h5py.Dataset) else ()
        said[name] = (kind, attributes)

    with h5py.File(path) as file:
        file.visititems(look)
    return said


@pytest.mark.parametrize("dim", [2, 3])
def test_snapshots_hold_what_they_are_given_one_after_the_other(tmp_path, dim):
    writer = SnapshotWriter()
    cases = [(20, 3, 0), (20, 3, 1), (20, 3, 2), (21, 3, 3), (21, 4, 4), (21, 0, 5), (0, 0, 6)]
    for n, bodies, seed in cases:
        state, grains = random_state(n, dim, seed), grain_state(bodies, dim, seed)
        grains = grains if bodies else {}
        writer.write(tmp_path / "next", state, header(float(seed), dim), grains)
        assert_holds(tmp_path / "next", state, header(float(seed), dim), grains)
        SnapshotWriter().write(tmp_path / "alone", state, header(float(seed), dim), grains)
        assert (tmp_path / "alone").read_bytes() == (tmp_path / "next").read_bytes()


def test_names_that_change_are_no_longer_those_before(tmp_path):
    writer, state = SnapshotWriter(), random_state(5, 2)
    for names in (NAMES, (NAMES[0], ("sea", "grain", "bad"))):
        writer.write(tmp_path / "file", state, header(1.0, 2, names))
        assert read_header(tmp_path / "file").body_names == names[1]


def test_what_a_run_does_not_have_is_not_written(tmp_path):
    """A field that has a value where it is absent takes no room, and is read as that."""
    state = random_state(20, 2, 0)
    del state["damage"]
    SnapshotWriter().write(tmp_path / "none", state, header(1.0, 2))
    with h5py.File(tmp_path / "none") as file:
        assert "VTKHDF/PointData/Damage" not in file
    assert_holds(tmp_path / "none", state | {"damage": np.zeros(20)}, header(1.0, 2), {})


def test_large_files_are_packed_and_say_the_same(tmp_path, monkeypatch):
    state = random_state(300, 3) | {"density": np.ones(300)}
    SnapshotWriter().write(tmp_path / "small", state, header(1.0, 3))
    monkeypatch.setattr(snapshot_writer, "WORTH_PACKING", 1)
    SnapshotWriter().write(tmp_path / "large", state, header(1.0, 3))
    assert_holds(tmp_path / "large", state, header(1.0, 3), {})
    assert structure(tmp_path / "small") == structure(tmp_path / "large")
    with h5py.File(tmp_path / "small") as small, h5py.File(tmp_path / "large") as large:
        density = "VTKHDF/PointData/Density"
        assert small[density].compression is None
        assert large[density].compression == "gzip"


def test_only_the_first_of_many_snapshots_builds_a_file(tmp_path, record_run, monkeypatch):
    built, image = [], snapshot_writer._image
    monkeypatch.setattr(
        snapshot_writer, "_image", lambda *given: built.append(given) or image(*given)
    )
    record_run(tmp_path / "run", times=(0.0, 1.0, 2.0, 3.0))
    assert len(built) == 1


@pytest.mark.parametrize("end", ["sync", "close"])
def test_snapshots_wait_for_the_disk_once_before_a_checkpoint_and_at_the_end(
    tmp_path, record_run, monkeypatch, end
):
    synced, sync = [], files.sync
    for module in (files, writer):
        monkeypatch.setattr(module, "sync", lambda path: synced.append(path.name) or sync(path))
    recorder, _ = record_run(tmp_path / "run", times=(0.0, 1.0, 2.0, 3.0))
    of_snapshots = sorted(file.name for file in (tmp_path / "run" / "snapshots").iterdir())
    assert not {*of_snapshots, "snapshots"} & {*synced}
    for _ in range(2):
        recorder.sync() if end == "sync" else recorder.close({})
    assert [name for name in synced if name in of_snapshots] == of_snapshots
    assert synced.count("snapshots") == 1


def test_a_record_is_reopened_whatever_became_of_later_snapshots(tmp_path, record_run):
    record_run(tmp_path / "run", times=(0.0, 1.0, 2.0))
    last = sorted((tmp_path / "run" / "snapshots").iterdir())[-1]
    last.write_bytes(b"")
    writer.Recorder.reopen(tmp_path / "run", 2, 2)
    assert not last.exists()
