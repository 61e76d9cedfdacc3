"""With what a run was made: kept at its start, and at each resumption."""

from __future__ import annotations

import json
import re
import socket

import pytest

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
    with pytest.raises(UserError, match=r"provenance\.json"):
        read_provenance(folder)
    note_provenance(folder, False, 1, 1)
    assert len(read_provenance(folder)) == 1


def test_it_goes_with_the_run_that_is_overwritten(run_folder):
    folder = RunFolder(run_folder)
    note_provenance(folder, True, 1, 1)
    folder.report.write_text("old")
    assert {folder.provenance, folder.report} <= set(folder.recorded())
