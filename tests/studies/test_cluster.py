"""Runs as jobs of submitit: here as its own processes, and by SLURM where there is one."""

from __future__ import annotations

import shutil
import subprocess
import sys

import pytest

from doseki.errors import ResourceError, UserError
from doseki.studies.runs.row import DONE
from doseki.studies.study import run_study

from .small_study import STUDY, write_study

CLUSTER = '\n[cluster]\nkind = "{}"\nminutes = 5\nmemory_gb = 0.5\n'


def slurm_is_there():
    """Whether jobs can be submitted."""
    if shutil.which("sbatch") is None:
        return False
    told = subprocess.run(["sinfo", "-h"], capture_output=True, text=True, check=False)
    return told.returncode == 0 and bool(told.stdout.strip())


def runs_on(kind, folder):
    pytest.importorskip("submitit")
    path = write_study(folder, STUDY.replace("[5, 10, 20]", "[5, 20]") + CLUSTER.format(kind))
    report = run_study(path, folder / "out", lambda _: None, pictures=False)
    assert [entry.row.status for entry in report.table.entries] == [DONE, DONE]
    assert report.table.results("speed") == pytest.approx([-0.1, -0.4])
    again = run_study(path, folder / "out", lambda _: None, pictures=False)
    assert again.made == 0


@pytest.mark.minutes
def test_jobs_of_this_machine(tmp_path):
    runs_on("local", tmp_path)


@pytest.mark.full
@pytest.mark.skipif(not slurm_is_there(), reason="no SLURM that takes jobs")
def test_jobs_of_slurm(tmp_path):
    runs_on("slurm", tmp_path)


def test_without_submitit_one_sentence_says_what_helps(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "submitit", None)
    path = write_study(tmp_path, STUDY + CLUSTER.format("local"))
    with pytest.raises(UserError, match=r"pip install 'doseki\[cluster\]'"):
        run_study(path, tmp_path / "out", lambda _: None)


@pytest.mark.skipif(slurm_is_there(), reason="a SLURM is there")
def test_without_slurm_one_sentence_says_so(tmp_path):
    pytest.importorskip("submitit")
    path = write_study(tmp_path, STUDY + CLUSTER.format("slurm"))
    # Its commands are missing, or what they talk to.
    with pytest.raises((UserError, ResourceError), match="slurm"):
        run_study(path, tmp_path / "out", lambda _: None)
