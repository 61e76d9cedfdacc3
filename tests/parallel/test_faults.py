"""Ranks that fail: the run ends, once, with one report."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import doseki
from doseki.assess.failure.failure import explanation
from doseki.driver.checkpoint import from_bytes
from doseki.record.folder import RunFolder

from .conftest import SECONDS, environment

CASE = ["--no-figures", "--threads", "1", "--set", "particles_per_grain=793"]
BLOW_UP = """\
schema = 1
dim = 2
dp = 0.01
time_max = 0.05
time_out = 0.01
xi = 0.05
cflnumber = 1
cfl_force = 1

[body.block]
shape = "box"
material = "basalt"
min = [0, 0]
max = [0.08, 0.08]
velocity = [3, 3]

[body.other]
shape = "box"
material = "basalt"
min = [0.041, 0.0412]
max = [0.121, 0.1212]
"""


def test_a_rank_that_throws_ends_the_run_with_one_report(command, tmp_path):
    folder = tmp_path / "run"
    done = command(
        2, "run", "collision", "-o", folder, *CASE, "--set", "time_max=0.1", script="failing.py"
    )
    assert done.returncode != 0
    assert done.stderr.count("doseki: rank 1 failed") == 1
    assert "doseki: rank 0" not in done.stderr
    report = json.loads((folder / "failure.json").read_text())
    assert (report["kind"], report["rank"]) == ("rank", 1)
    assert "forced by a test" in report["message"]
    assert report["step"] > 0
    assert "Rank 1 failed" in explanation(RunFolder(folder))


def test_a_rank_that_fails_before_it_joins_ends_the_run(command, tmp_path):
    """The launcher would wait for ever for the other one."""
    folder = tmp_path / "run"
    done = command(2, "run", "collision", "-o", folder, *CASE, script="failing_early.py")
    assert done.returncode != 0
    assert "doseki.driver.ranks" in done.stderr


def rank_process(mark: str, rank: int) -> int:
    """The id of a rank's process, among those whose environment has the mark of this test."""
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                environment = (entry / "environ").read_bytes().split(b"\0")
                words = (entry / "cmdline").read_bytes()
            except OSError:
                continue
            ours = f"DOSEKI_TEST={mark}".encode() in environment
            if ours and f"PMI_RANK={rank}".encode() in environment and b"doseki.cli.main" in words:
                return int(entry.name)
    return 0


def wait_until(condition):
    """What `condition` gives as soon as it is true."""
    end = time.monotonic() + SECONDS
    while time.monotonic() < end:
        if found := condition():
            return found
        time.sleep(0.05)
    raise AssertionError("waited in vain")


@pytest.fixture
def endless(launcher, tmp_path):
    """A run on two ranks that does not end by itself, in the folder "run"."""
    folder = str(tmp_path / "run")
    words = ["run", "collision", "-o", folder, *CASE, "--set", "time_max=99"]
    words += ["--checkpoint-every", "0.0005"]
    process = subprocess.Popen(
        [launcher, "-n", "2", sys.executable, "-m", "doseki.cli.main", *words],
        env=environment(DOSEKI_TEST=str(tmp_path)),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    yield process
    process.terminate()
    process.wait()


@pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="the system cannot watch processes")
def test_a_rank_that_is_killed_ends_the_run_and_fewer_go_on(endless, command, tmp_path):
    folder = tmp_path / "run"
    wait_until(lambda: list(folder.glob("checkpoints/*.h5")))
    victim = rank_process(str(tmp_path), 1)
    assert victim
    os.kill(victim, signal.SIGKILL)
    assert endless.wait(SECONDS) != 0
    failure = folder / "failure.json"
    wait_until(failure.is_file)
    report = json.loads(wait_until(failure.read_text))
    assert report["rank"] == 1
    assert f"process {victim} ended without a word" in report["message"]
    assert not (folder / "summary.json").exists()

    checkpoint = max(folder.glob("checkpoints/*.h5"))
    time_max = from_bytes(checkpoint.read_bytes(), checkpoint).state["time"].item() + 0.0005
    done = command(1, "resume", folder, *CASE[:3], "--set", f"time_max={time_max}")
    assert done.returncode == 0, done.stderr
    assert doseki.load(folder).summary["status"] == "done"
    assert not failure.exists()


def test_physics_that_fails_is_reported_once_as_on_one_rank(command, tmp_path):
    file = tmp_path / "blow-up.toml"
    file.write_text(BLOW_UP)
    reports = []
    for ranks in (1, 2):
        folder = tmp_path / str(ranks)
        done = command(ranks, "run", file, "-o", folder, "--threads", 1, "--no-figures")
        assert done.returncode == 3, done.stderr
        assert done.stderr.count("doseki: at t = ") == 1
        assert doseki.load(folder).summary["status"] == "failed"
        reports.append(json.loads((folder / "failure.json").read_text()))
    one, two = reports
    assert one["kind"] == two["kind"]
    assert one["step"] == two["step"]
    # Several particles break in one step; which of them is found first depends on their order.
    for report in reports:
        assert report["particle"]["material"] == "basalt"
        assert report["neighbours"][0]["distance"] < 0.02
        assert report["largest_term"] in report["acceleration"]
        assert (tmp_path / "2" / "checkpoints" / two["good_state"]).is_file()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["run", "flum"], 'no scenario named "flum"; did you mean flume?'),
        (["run", "flume", "--set", "dq=1"], "--set dq"),
        (["run", "flume", "--ranks", "3"], "--ranks 3: mpiexec has started 2"),
    ],
)
def test_a_mistake_is_told_once(command, tmp_path, words, said):
    done = command(2, *words, "-o", tmp_path / "run")
    assert done.returncode == 2
    assert done.stderr.count(said) == 1
    assert done.stderr.count("doseki: ") == 1
    assert not (tmp_path / "run").exists()


def test_a_folder_that_is_taken_is_left_alone(command, tmp_path):
    (tmp_path / "keep").write_text("mine")
    done = command(2, "run", "collision", "-o", tmp_path)
    assert done.returncode == 2
    assert done.stderr.count("exists and is not empty") == 1
    assert [file.name for file in tmp_path.iterdir()] == ["keep"]
