"""Ctrl-C, SIGTERM and a file STOP end all runs that are compared, and nothing is compared then."""

from __future__ import annotations

import os
import signal

import pytest

from doseki.cli.main import main
from doseki.driver.active_run import ActiveRun
from doseki.running import runner
from doseki.scenario.load import load_scenario
from doseki.studies import compare

from .small_study import write_study

LONG = "time_max=0.4"


@pytest.fixture(autouse=True)
def hear():
    """Tests in the background may be deaf to Ctrl-C."""
    old = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, old)


@pytest.fixture
def interrupt(monkeypatch):
    """A function that lets a signal, or a file STOP, come in the first run, at a moment of it."""

    def at(moment, what):
        def now(folder):
            monkeypatch.undo()
            if what == "STOP":
                (folder / "STOP").touch()
            else:
                os.kill(os.getpid(), what)

        if moment == "steps":
            monkeypatch.setattr(ActiveRun, "write_checkpoint", lambda run: now(run.folder.path))
        else:
            reports = (("trust report", lambda run: now(run.directory)),)
            monkeypatch.setattr(runner, "JUDGEMENTS", reports)

    return at


def told(capsys, *arguments):
    """The exit code of a command, and what it printed."""
    with pytest.raises(SystemExit) as ended:
        main([str(each) for each in arguments])
    said = capsys.readouterr()
    return ended.value.code, said.out, said.err


@pytest.mark.parametrize(
    ("moment", "what", "by"),
    [
        ("steps", signal.SIGINT, "SIGINT"),
        ("steps", signal.SIGTERM, "SIGTERM"),
        ("steps", "STOP", "the file STOP"),
        ("reports", signal.SIGINT, "SIGINT"),
        ("reports", signal.SIGTERM, "SIGTERM"),
    ],
)
def test_what_stops_a_run_stops_trust(tmp_path, capsys, interrupt, moment, what, by):
    write_study(tmp_path)
    out = tmp_path / "out"
    interrupt(moment, what)
    code, table, error = told(
        capsys, "trust", tmp_path / "fall.toml", "--set", LONG, "--threads", 1, "-o", out
    )
    assert (code, table) == (130, "")
    assert error == f"doseki: {out / 'half'}: stopped by {by}; nothing is compared\n"
    assert [folder.name for folder in out.iterdir()] == ["half"]
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL


def test_a_signal_in_the_last_steps_stops_trust(tmp_path, capsys, interrupt):
    """That run is whole, but whoever sent it does not wait for the others."""
    write_study(tmp_path)
    interrupt("steps", signal.SIGINT)
    code, _, error = told(
        capsys, "trust", tmp_path / "fall.toml", "--set", "time_max=1e-6", "-o", tmp_path / "out"
    )
    assert code == 130
    assert "stopped by SIGINT" in error
    assert not (tmp_path / "out" / "base").exists()


def test_without_a_signal_all_runs_are_compared(tmp_path, capsys):
    write_study(tmp_path)
    code, table, _ = told(
        capsys, "trust", tmp_path / "fall.toml", "--threads", 1, "-o", tmp_path / "out"
    )
    assert code == 0
    assert "Moved most" in table
    assert len(list((tmp_path / "out").iterdir())) == 3


@pytest.mark.parametrize("what", [signal.SIGINT, "STOP"])
def test_what_stops_a_run_stops_compare(tmp_path, capsys, interrupt, monkeypatch, what):
    write_study(tmp_path)
    out = tmp_path / "out"
    fall = load_scenario(tmp_path / "fall.toml", [LONG])
    with monkeypatch.context() as patched:
        patched.setattr(compare, "load_scenario", lambda *_: fall)
        interrupt("steps", what)
        code, table, error = told(capsys, "compare", "flume", "--threads", 1, "--out", out)
    assert (code, table) == (130, "")
    assert f"{out / 'ueta2022'}: stopped by" in error
    assert [folder.name for folder in out.iterdir()] == ["ueta2022"]


@pytest.mark.parametrize("command", ["trust film --vary xi", "compare flume"])
def test_a_folder_with_something_in_it_is_left_alone(tmp_path, capsys, command):
    """Also that of a run, and of runs that were stopped: neither has a way to replace them."""
    (tmp_path / "letter.txt").touch()
    with pytest.raises(SystemExit) as ended:
        main([*command.split(), "-o", str(tmp_path)])
    assert ended.value.code == 2
    assert "exists and is not empty; give another folder\n" in capsys.readouterr().err
    assert [file.name for file in tmp_path.iterdir()] == ["letter.txt"]
