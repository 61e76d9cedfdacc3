"""Signals end a run in good order, Ctrl-C before it ends the command with one line."""

from __future__ import annotations

import fcntl
import json
import os
import signal
import subprocess
import sys
import termios
from pathlib import Path

import pytest

from doseki.cli.interrupts import WORDS
from doseki.driver.checkpoint import CheckpointFolder
from doseki.driver.schedule import StopRequests

from .channel import command, doseki_command, environment

ENDLESS = ("--threads", 1, "--set", "time_max=99", "--no-figures")
HEARD = (signal.SIGINT, signal.SIGHUP)  # which the tests themselves may be deaf to


def hear_signals():
    """What a child process calls: it does not ignore what its parents do."""
    for number in HEARD:
        signal.signal(number, signal.default_int_handler if number == 2 else signal.SIG_DFL)


def start_run(channel_file, folder, prepare=hear_signals, **options):
    """Start a run that does not end by itself; returns once it steps."""
    run = subprocess.Popen(
        command("run", channel_file, "-o", folder, *ENDLESS),
        env=environment(),
        preexec_fn=prepare,
        **{"stdout": subprocess.DEVNULL} | options,
    )
    while len(CheckpointFolder(folder / "checkpoints").files()) == 0:
        with pytest.raises(subprocess.TimeoutExpired):
            run.wait(0.1)
    return run


def assert_stopped(run, folder):
    assert run.wait(60) == 0
    assert json.loads((folder / "summary.json").read_text())["status"] == "stopped"
    assert len(CheckpointFolder(folder / "checkpoints").files()) >= 1


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_signals_stop_with_a_checkpoint_and_code_0(channel_file, tmp_path, number):
    run = start_run(channel_file, tmp_path / "run")
    run.send_signal(number)
    assert_stopped(run, tmp_path / "run")


def test_a_run_whose_terminal_is_closed_stops(channel_file, tmp_path):
    ours, terminal = os.openpty()

    def take_terminal():
        hear_signals()
        fcntl.ioctl(terminal, termios.TIOCSCTTY, 0)

    streams = {"stdin": terminal, "stdout": terminal, "stderr": terminal}
    run = start_run(
        channel_file, tmp_path / "run", take_terminal, start_new_session=True, **streams
    )
    os.close(terminal)
    os.close(ours)
    assert_stopped(run, tmp_path / "run")
    assert (tmp_path / "run/summary.txt").is_file()


def test_a_run_under_nohup_goes_on_without_its_terminal(tmp_path):
    stop, before = StopRequests(tmp_path), signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with stop.listening():
            os.kill(os.getpid(), signal.SIGHUP)
            assert not stop
            os.kill(os.getpid(), signal.SIGTERM)
            assert stop
    finally:
        signal.signal(signal.SIGHUP, before)


SETTLING = """\
dim = 2
dp = 0.01
time_max = 0.01
time_out = 0.01
scheme = "resolved"
speed_max = 2
gravity = [0, -9.8]
[body.floor]
shape = "box"
material = "basalt"
fixed = true
min = [0, -0.05]
max = [0.4, 0]
[body.load]
shape = "disc"
material = "basalt"
min = [0, 0]
max = [0.4, 0.2]
d = 0.05
count = 9
settle = true
"""


def run_interrupted(number, moment, file, folder, *options):
    """`doseki run`, which gets a signal at a moment."""
    script = [sys.executable, Path(__file__).parent / "interrupted.py", int(number), moment]
    return subprocess.run(
        [*map(str, script), "run", str(file), "-o", str(folder), *options],
        env=environment(),
        capture_output=True,
        text=True,
        preexec_fn=hear_signals,
        check=False,
    )


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
@pytest.mark.parametrize("moment", ["figures.plot:draw_run", "assess.trust.report:write_trust"])
def test_a_signal_after_the_last_step_costs_no_summary(tmp_path, number, moment):
    (tmp_path / "load.toml").write_text(SETTLING.replace("settle = true", ""))
    folder = tmp_path / "run"
    done = run_interrupted(number, moment, tmp_path / "load.toml", folder, "--threads", "1")
    assert done.returncode == 0, done.stderr
    assert WORDS[number] in done.stdout + done.stderr
    assert "status            done" in done.stdout
    assert (folder / "summary.txt").read_text().strip() in done.stdout


@pytest.mark.parametrize(
    "moment",
    [
        "import:1",
        "import:300",
        "import:900",
        "scenario.load:_completed",
        "scene.checks.particles:check_particles",
        "solver.settling:_fill",
    ],
)
def test_an_interrupt_before_the_run_is_one_line(tmp_path, moment):
    (tmp_path / "load.toml").write_text(SETTLING)
    done = run_interrupted(signal.SIGINT, moment, tmp_path / "load.toml", tmp_path / "run")
    assert (done.returncode, done.stderr) == (130, "doseki: interrupted\n")
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("moment", ["import:300", "scene.checks.particles:check_particles"])
def test_so_is_another_signal_that_ends_it(tmp_path, moment, number):
    (tmp_path / "load.toml").write_text(SETTLING)
    done = run_interrupted(number, moment, tmp_path / "load.toml", tmp_path / "run")
    assert (done.returncode, done.stderr) == (128 + number, f"doseki: {WORDS[number]}\n")


@pytest.mark.parametrize("name", ["PMI_RANK", "PMIX_RANK", "SLURM_PROCID"])
def test_a_rank_without_a_number_of_ranks_prints(monkeypatch, name):
    monkeypatch.setenv(name, "3")
    done = doseki_command("--version")
    assert done.returncode == 0
    assert done.stdout.startswith("doseki ")
