"""What a run may count on: affinity, quotas of control groups, the load of others."""

from __future__ import annotations

import math
import os
import subprocess
import sys

import pytest

from doseki.cli.main import main
from doseki.util import cores
from doseki.util.cores import SharedCores, int_of, quota, shared_cores

from ..run.channel import channel_text, environment


def groups(tmp_path, membership, **files):
    """A tree of control groups; keys are paths with __ for /."""
    (tmp_path / "membership").write_text(membership)
    for name, text in files.items():
        path = tmp_path / "groups" / name.replace("__", "/").replace("_dot_", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return quota(tmp_path / "groups", tmp_path / "membership")


def test_the_quota_is_the_least_of_the_groups_above(tmp_path):
    found = groups(
        tmp_path,
        "0::/a/b\n",
        a__cpu_dot_max="150000 100000\n",
        a__b__cpu_dot_max="max 100000\n",
        cpu_dot_max="400000 100000\n",
    )
    assert found == 1.5


def test_version_1_has_other_files(tmp_path):
    files = {"cpu__x__cpu_dot_cfs_quota_us": "250000", "cpu__x__cpu_dot_cfs_period_us": "100000"}
    assert groups(tmp_path, "3:cpu,cpuacct:/x\n2:memory:/y\n", **files) == 2.5


@pytest.mark.parametrize("text", ["max 100000", "", "-1 100000", "x y", "1 0", "1 2 3"])
def test_no_quota_where_none_is_said(tmp_path, text):
    assert groups(tmp_path, "0::/a\nnonsense\n", a__cpu_dot_max=text) == math.inf
    assert quota(tmp_path / "nothing", tmp_path / "none") == math.inf


def test_a_quota_limits_the_threads(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(64)))
    for limit, expected in ((math.inf, 64), (2.5, 2), (0.3, 1), (100, 64)):
        monkeypatch.setattr(cores, "quota", lambda limit=limit: limit)
        assert cores.allowed_cores() == expected


@pytest.mark.parametrize(
    ("threads", "of", "load", "limit", "said"),
    [
        (2, 2, 0.1, math.inf, None),
        (1, 2, 1.0, math.inf, None),
        (2, 2, 14.1, math.inf, r"2 threads, and others run here (a load of 14.1 on 2 cores)"),
        (8, 8, 0.0, 2.5, r"8 threads, and the quota of this process is the time of 2.5 processors"),
        (4, 2, 0.0, math.inf, r"4 threads, and it may use 2 cores"),
    ],
)
def test_what_is_said_of_the_cores(monkeypatch, threads, of, load, limit, said):
    doubt = SharedCores("", threads, of, load, limit)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(of)))
    monkeypatch.setattr(os, "getloadavg", lambda: (load, 0, 0))
    monkeypatch.setattr(cores, "quota", lambda: limit)
    found = shared_cores(threads)
    assert found == ([] if said is None else [doubt])
    assert said is None or said in str(doubt)


def test_numbers_of_threads_in_the_environment():
    texts = ("4", "4,2", "", None, "x", "0", "-1", "9" * 5000)
    assert [int_of(text) for text in texts] == [4, 4, None, None, None, None, None, None]


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({}, "2000"),
        ({"GOMP_SPINCOUNT": "7"}, "7"),
        ({"OMP_WAIT_POLICY": "passive"}, ""),
        ({"OMP_WAIT_POLICY": "active"}, ""),
    ],
)
def test_how_threads_wait_is_said_before_openmp_starts_and_the_user_is_obeyed(given, expected):
    """OpenMP reads it when it is loaded, which is when the core is."""
    program = """
import os
from doseki import compiled
before = "gomp" in open("/proc/self/maps").read()
compiled.load_core()
after = "gomp" in open("/proc/self/maps").read()
print(before, after, os.environ.get("GOMP_SPINCOUNT", ""))
"""
    clean = {
        k: v for k, v in environment().items() if k not in ("GOMP_SPINCOUNT", "OMP_WAIT_POLICY")
    }
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=clean | given,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == f"False True {expected}\n"


def test_run_and_resume_say_so(tmp_path, monkeypatch, capsys):
    scenario = tmp_path / "channel.toml"
    scenario.write_text(channel_text())
    monkeypatch.setattr(os, "getloadavg", lambda: (50.0, 50.0, 50.0))
    for words in (
        ["run", str(scenario), "-o", str(tmp_path / "run"), "--set", "time_max=0.002"],
        ["resume", str(tmp_path / "run"), "--set", "time_max=0.003"],
    ):
        with pytest.raises(SystemExit) as end:
            main([*words, "--threads", "1", "--no-figures"])
        assert not end.value.code
        said = capsys.readouterr().err.splitlines()
        assert len([line for line in said if "the cores are not this run's own" in line]) == 1
    for wrong in (["--set", "dp=0.02"], ["--from", "0.0001"], []):
        with pytest.raises(SystemExit) as end:
            main(["resume", str(tmp_path / "run"), *wrong])
        assert end.value.code == 2
        assert "the cores are not" not in capsys.readouterr().err
